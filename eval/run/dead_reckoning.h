#pragma once

#include <optional>
#include <vector>

#include "core/imu_buffer.h"
#include "core/imu_propagation.h"
#include "core/navigation_state.h"

namespace alidade {

/// An estimate carried on over the IMU alone, with its covariance. The samples it holds are bounded: the
/// oldest are integrated when there are many. How far that has gone changes no bit of the result.
class DeadReckoning {
 public:
  /// `noise`: of the IMU, scaled. Gravity in m/s^2.
  DeadReckoning(const ImuNoise& noise, double gravity_mps2, double max_gap_s);

  /// Starts at `estimate`. Samples added before stay, as far as they are needed.
  void Reset(const NavEstimate& estimate);
  /// Rising stamps, the last one before the estimate included.
  void AddImu(const ImuSample& sample);
  /// The state at `stamp_ns`, which lies among the newest samples; nothing when the samples do not reach from
  /// the estimate to there, or integrate to numbers that are not finite.
  [[nodiscard]] std::optional<NavEstimate> At(TimeNs stamp_ns);
  /// The state at the last sample that is integrated; where that is not finite, the one it started at.
  [[nodiscard]] NavEstimate Here() const { return Carried(stamp_ns_, since_start_).value_or(start_); }

 private:
  /// Integrates the samples up to `stamp_ns` and forgets them.
  void Advance(TimeNs stamp_ns);
  [[nodiscard]] std::optional<NavEstimate> Carried(TimeNs stamp_ns, const Preintegration& interval) const;

  ImuNoise noise_;
  Eigen::Vector3d gravity_W_;
  ImuBuffer imu_;
  NavEstimate start_;
  TimeNs stamp_ns_ = 0;
  Preintegration since_start_{ImuBias(), ImuNoise()};  ///< from start_ to stamp_ns_
  std::vector<ImuSample> interval_;
};

}  // namespace alidade
