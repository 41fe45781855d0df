#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/preintegration.h"
#include "smoother/truth/arrow_system.h"
#include "smoother/truth/truth_start.h"

namespace alidade {

/// How the IMU is taken.
struct TruthImu {
  ImuNoise noise;
  Eigen::Vector3d gravity_W = Eigen::Vector3d::Zero();
};

/// What the IMU's readings are multiplied by, one factor an axis: 1 + these [-].
struct TruthImuScale {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();

  [[nodiscard]] ImuSample Applied(const ImuSample& sample) const {
    return {sample.stamp_ns, sample.gyro + gyro.cwiseProduct(sample.gyro),
            sample.accel + accel.cwiseProduct(sample.accel)};
  }
};

// Columns of ArrowSystem's constants: TruthConstantsError, then the relative change of the factors (3 of the
// gyroscope, 3 of the accelerometer).
inline constexpr int kScaleColumn = kTruthConstants;
inline constexpr int kScales = 6;
static_assert(kScaleColumn + kScales == ArrowSystem::kBorder);

/// A term between two successive states, whitened.
struct TruthLink {
  Vector15d residual;
  Matrix15d of_first, of_second;
  ArrowSystem::LinkBorderRows of_constants;
};

/// The IMU between two samples, the factors applied. Empty: its covariance is singular or a number is not
/// finite.
[[nodiscard]] std::optional<TruthLink> LinearizeLink(const ImuSample& from, const ImuSample& to,
                                                     const TruthState& first, const TruthState& second,
                                                     const TruthImu& imu);

/// A recorded pose against the state before it (the factors of the IMU over the fraction of a step between
/// them count as known): rows (orientation, position) [rad, m], not whitened.
struct TruthPoseTerm {
  Vector6d residual;
  ArrowSystem::PoseRows of_state;
  ArrowSystem::BorderRows of_constants;
};

/// `stamp_ns`: of the pose in IMU time, from.stamp_ns <= stamp_ns < to.stamp_ns.
[[nodiscard]] TruthPoseTerm LinearizePose(const Pose& T_TM, TimeNs stamp_ns, const ImuSample& from,
                                          const ImuSample& to, const TruthState& state,
                                          const TruthConstants& constants, const TruthImu& imu);

/// A state moved by an error in the canonical chart (phi, dp, dv, dbg, dba).
[[nodiscard]] TruthState Retract(const TruthState& state, const Vector15d& error);

}  // namespace alidade
