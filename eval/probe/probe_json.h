#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/imu_sample.h"
#include "core/navigation_state.h"

namespace alidade::probe {

using Json = nlohmann::ordered_json;

/// What is wrong with one case; becomes its {"error": ...}. Caught in Probe, never leaves it.
struct CaseError {
  std::string message;
};

/// Member `key` of an object. Throws CaseError naming what is missing.
const Json& Member(const Json& object, const std::string& key);
/// A finite number.
double Number(const Json& value, const std::string& name);
/// An array of exactly `size` finite numbers.
Eigen::VectorXd Vector(const Json& value, const std::string& name, int size);
/// A unit quaternion w x y z as a rotation; its norm may be off by 1e-6.
Eigen::Matrix3d Rotation(const Json& value, const std::string& name);
/// An integer in [0, size).
int Index(const Json& value, const std::string& name, int size);
/// The array `views` of {q_wxyz, p}: at least two poses T_GC.
std::vector<Pose> Views(const Json& object);
/// The array `obs` of [u, v], one a view.
std::vector<Eigen::Vector2d> Observations(const Json& object, size_t count);
/// {sg, sa, swg, swa}: non-negative densities.
ImuNoise Noise(const Json& object);
/// The array `imu` of {t [ns], w, a}: at least two samples in time order.
std::vector<ImuSample> ImuSamples(const Json& object);

Json ToJson(const Eigen::Ref<const Eigen::MatrixXd>& matrix);        ///< array of rows
Json VectorToJson(const Eigen::Ref<const Eigen::VectorXd>& vector);  ///< flat array
Json QuaternionToJson(const Eigen::Matrix3d& rotation);              ///< w x y z, w >= 0

}  // namespace alidade::probe
