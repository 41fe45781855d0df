#pragma once

#include <optional>
#include <string>

#include "core/estimator_config.h"
#include "core/rig_calibration.h"
#include "gnss/alignment/alignment.h"
#include "gnss/alignment/inertial_fit.h"

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
  /// What no start at or after this epoch needs.
  void ForgetOld(TimeNs newest_ns);
  /// Epochs before the first IMU sample, whatever the time offset.
  void ForgetUnreached();
  /// Of the heading [rad].
  [[nodiscard]] double YawStd(const InertialFit& fit) const;
  /// The time offset of the least cost over the grid of the prior, if below that of `best`, which is then
  /// the fit there; else 0.
  double SearchOffset(InertialFit* best) const;
  [[nodiscard]] Start MakeStart(const InertialFit& fit, double offset_s) const;

  GnssConfig config_;
  GnssReceiver receiver_;
  InertialFitter fitter_;
  InertialWindow window_;
  MeasurementCounts left_out_;
  std::string report_;
};

}  // namespace alidade
