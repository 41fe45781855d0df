#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/estimator_config.h"
#include "core/preintegration.h"
#include "core/rig_calibration.h"
#include "gnss/alignment/alignment.h"

namespace alidade {

/// Initialisation from GNSS and IMU without a camera, directly in the ENU frame.
///
/// Least squares over attitude, velocity, position and biases at the first epoch of the window: the IMU,
/// integrated from there, must pass through the single-point positions and velocities of the others. Attitude
/// starts from the rotation between specific force, integrated in the first body frame, and change of
/// velocity less gravity (velocity matching as in Wu and Pan, "Velocity/position integration formula part I",
/// 2013; solved by SVD). At rest the heading is unobservable, so the start waits for motion.
class GnssInertialStart {
 public:
  GnssInertialStart(const EstimatorConfig& config, const RigCalibration& rig);

  /// Rising stamps; the IMU reaches beyond an epoch before the epoch comes.
  void AddImu(const ImuSample& sample);
  void AddEpoch(const GnssEpoch& epoch, const std::optional<SinglePointSolution>& solution);

  struct Start {
    NavEstimate estimate;     ///< in the ENU frame, at the last epoch
    GnssAlignment alignment;  ///< without turn or shift: anchor and clock
  };
  /// The start once the heading is known to gnss.align_max_yaw_std_rad; report() names what is missing.
  std::optional<Start> TryStart();
  [[nodiscard]] const std::string& report() const { return report_; }

 private:
  /// An epoch's single point.
  struct Fix {
    TimeNs stamp_ns = 0;
    Eigen::Vector3d position_E, velocity_E;
    Eigen::Matrix3d position_root, velocity_root;  ///< of information, ECEF axes
    Vector6d clock;
  };
  struct Fit;
  struct Equations;

  /// What no start at or after this epoch needs.
  void ForgetOld(TimeNs newest_ns);
  /// Epochs before the first IMU sample, whatever the time offset.
  void ForgetUnreached();
  [[nodiscard]] Fit Solve(double offset_s) const;
  /// The IMU between the epochs, integrated with the fit's biases; false when it does not reach them.
  bool Integrate(double offset_s, Fit* fit) const;
  [[nodiscard]] NavState FirstGuess(const Fit& fit) const;
  [[nodiscard]] Equations Linearize(const Fit& fit) const;

  GnssConfig config_;
  InitConfig init_;
  GnssReceiver receiver_;
  ImuNoise noise_;
  Eigen::Vector3d gravity_W_;
  std::deque<ImuSample> imu_;
  std::deque<Fix> fixes_;
  std::optional<EnuFrame> enu_;
  MeasurementCounts left_out_;
  std::string report_;
};

}  // namespace alidade
