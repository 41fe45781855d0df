#pragma once

#include <cmath>
#include <deque>
#include <optional>
#include <vector>

#include "core/estimator_config.h"
#include "core/preintegration.h"
#include "core/rig_calibration.h"
#include "core/robust.h"
#include "gnss/base/geodesy.h"

namespace alidade {

/// A single point with velocity, weighted.
struct InertialPoint {
  TimeNs stamp_ns = 0;
  Eigen::Vector3d position_E, velocity_E;
  Eigen::Matrix3d position_root, velocity_root;  ///< of information, ECEF axes
  Vector6d clock;                                ///< a ClockState's mean
};

/// State at the first point.
struct InertialFit {
  bool ok = false;
  double cost = INFINITY;
  TimeNs first_ns = 0;  ///< IMU time of the first point
  NavState nav;
  ImuBias bias;
  Matrix15d covariance = Matrix15d::Zero();
  std::vector<Preintegration> intervals;    ///< from the first point to each later one
  std::vector<Eigen::Vector3d> gyro_radps;  ///< as measured at each point, the first included
};

/// What a start is found from.
struct InertialWindow {
  std::deque<ImuSample> imu;
  std::deque<InertialPoint> points;
  std::optional<EnuFrame> enu;  ///< as soon as there was a point
};

/// The least squares of GnssInertialStart over a window.
class InertialFitter {
 public:
  InertialFitter(const EstimatorConfig& config, const RigCalibration& rig);

  /// With the stamps of the points, one or more, moved by `offset_s`. Not ok: there is one point alone, the
  /// IMU does not reach them all, or they do not determine the state.
  [[nodiscard]] InertialFit Solve(const InertialWindow& window, double offset_s) const;
  /// The state at the last point; `chain`: its derivative by the one at the first.
  [[nodiscard]] NavState LastState(const InertialFit& fit, Matrix15d* chain) const;

 private:
  struct Equations;

  /// The IMU between the points, integrated with the fit's biases; false when it does not reach them.
  bool Integrate(const InertialWindow& window, double offset_s, InertialFit* fit) const;
  /// Attitude by velocity matching; velocity and position of the first point.
  [[nodiscard]] NavState FirstGuess(const InertialWindow& window, const InertialFit& fit) const;
  [[nodiscard]] Equations Linearize(const InertialWindow& window, const InertialFit& fit) const;

  InitConfig init_;
  ObservationKernel kernel_;
  Eigen::Vector3d p_BA_;
  ImuNoise noise_;
  Eigen::Vector3d gravity_W_;
};

}  // namespace alidade
