#pragma once

#include <optional>
#include <vector>

#include "core/rig_calibration.h"
#include "eval/peers/peer_gnss.h"
#include "eval/peers/vins_feature.h"
#include "eval/peers/vins_settings.h"
#include "eval/trajectory/trajectory.h"

namespace alidade::gvins {

/// Of its GNSS; the defaults are its published ones for its own sensor.
struct GnssSettings {
  bool enabled = true;
  double elevation_deg = 30;
  double max_pseudorange_std_m = 2;
  double max_doppler_std_hz = 2;
  int min_tracked_epochs = 20;
  double drift_step_mps = 0.1;  ///< deviation between frames of the receiver's clock drift
};

/// GVINS' solver: one object a process, since its settings are globals and it relies on its memory being zero
/// before its constructor runs.
class Solver {
 public:
  /// Also delivers ephemerides and ionosphere of `gnss`, which is used if its settings enable it.
  Solver(const RigCalibration& rig, const VinsSettings& settings, const GnssSettings& gnss_settings,
         const PeerGnss& gnss);

  /// `gpst_s` and `local_s`: an instant in gnss_comm's seconds and in the clock of IMU and camera.
  void SetClock(double gpst_s, double local_s);
  /// gnss_comm's seconds of an epoch.
  [[nodiscard]] static double GpstOf(const PeerGnss::Epoch& epoch);

  /// An IMU sample `step_s` after the one before.
  void AddImu(double step_s, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel);
  /// The epoch of the next image.
  void AddEpoch(const PeerGnss::Epoch& epoch);
  /// The features of the image at `time_s` of the camera's clock, to which the IMU has been delivered.
  void AddImage(const std::vector<VinsFeature>& features, double time_s);

  /// Initialised and not lost.
  [[nodiscard]] bool running() const;
  [[nodiscard]] double time_offset_s() const;
  /// State of the newest image in its own world W; no stamp and no covariance.
  [[nodiscard]] TrajectoryPoint Newest() const;
  /// From W to ECEF, once aligned.
  [[nodiscard]] std::optional<Pose> T_EW() const;

 private:
  const PeerGnss& gnss_;
  bool uses_gnss_;
  double gpst_less_local_s_ = 0;

  void DeliverNavigation();
};

}  // namespace alidade::gvins
