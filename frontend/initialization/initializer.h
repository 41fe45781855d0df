#pragma once

#include <memory>
#include <string>

#include "core/estimator_config.h"
#include "core/navigation_state.h"
#include "core/rig_calibration.h"
#include "core/status.h"
#include "core/track_frame.h"
#include "frontend/initialization/initializer_window.h"

namespace alidade {

/// Largest relative deviation of the scale with which a start in motion is accepted, by the length of the
/// search in windows (init.dynamic_window_s): `first` up to `windows_of_first`, `last` from `windows_to_last`
/// on, log-linear between. The covariance states a rough scale as such, and the back end goes on with the
/// data that the initialiser would have waited for. Deviations above `first` are worth a wait of half a
/// window.
struct ScaleDemand {
  double first = 0.05;
  double windows_of_first = 1;
  double last = 0.12;
  double windows_to_last = 1.5;

  /// For a back end that cannot mend a rough scale well.
  [[nodiscard]] static ScaleDemand Sharp() { return {0.01, 2.5, 0.12, 3.1}; }
};

/// Finds the first state from IMU and tracks alone; shared by both back ends.
///
/// Static (static_initializer.h): at rest by IMU spread and image motion; gravity gives roll and pitch, the
/// gyroscope's mean its bias. Dynamic (dynamic_initializer.h): gyroscope bias from epipolar geometry,
/// velocity and gravity in closed form, maximum likelihood over the window; accepted once the scale is known
/// as well as ScaleDemand asks. Auto: static at rest, else dynamic; a rest that is too
/// short yet is waited for. World: z up, yaw 0 and position 0 at the returned state. Attempts in motion are
/// made four times a second of data; between them AddFrame repeats the last reason. The caller gives up after
/// init.max_wait_s. imu.noise_scale and imu.random_walk_scale are applied here: pass the rig as read.
class Initializer {
 public:
  Initializer(const EstimatorConfig& config, const RigCalibration& rig, const ScaleDemand& demand = {});
  ~Initializer();
  Initializer(const Initializer&) = delete;
  Initializer& operator=(const Initializer&) = delete;

  void AddImu(const ImuSample& sample);
  /// The state at this frame, stamped with its IMU time (stamp + time offset), with its covariance (canonical
  /// chart), or kDiverged with the reason why there is none yet ("moving: gyro spread 0.21 rad/s exceeds
  /// 0.03", "parallax 4.1 px of 5.0", ...).
  Result<NavEstimate> AddFrame(const TrackFrame& frame);

  /// "static" or "dynamic", and what was found, once AddFrame has succeeded.
  [[nodiscard]] const std::string& method() const;
  [[nodiscard]] const std::string& report() const;

  /// Empty after a static start.
  [[nodiscard]] const InitializerWindow& window() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace alidade
