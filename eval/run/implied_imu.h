#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "core/navigation_state.h"

namespace alidade {

/// What the inertial sensor measured between two estimates, as the change of attitude and velocity implies
/// it:
///
///   gyroscope      Log(R_0^T R_1) / dt + bg
///   accelerometer  R_m^T ((v_1 - v_0) / dt - g) + ba,   R_m half way between R_0 and R_1
///
/// Means over the interval [rad/s, m/s^2] in the body frame, for an axis that does not measure itself
/// (ImuAxisWatch). A mean is taken as known when the variance of the angle or velocity along the axis differs
/// between both ends by at most (floor dt)^2, floor 0.2 rad/s and 1 m/s^2 (core/imu_gap.h): an estimate that
/// nothing has corrected since the other one only repeats what stood for the axis.
class ImpliedImu {
 public:
  /// An interval is no longer than this, and a mean counts for as long after it.
  static constexpr double kLongestS = 1;

  /// gravity: magnitude [m/s^2].
  explicit ImpliedImu(double gravity_mps2) : gravity_(0, 0, -gravity_mps2) {}

  /// The next estimate, after the others.
  void Add(const NavEstimate& estimate);
  /// The next estimate does not continue those before: another start, another frame of reference.
  void Forget() { axes_ = {}; }

  /// Of the newest interval whose mean is known, ended at most kLongestS before; axis 0 to 2.
  [[nodiscard]] std::optional<double> Gyro(int axis, TimeNs stamp_ns) const { return Mean(axis, stamp_ns); }
  [[nodiscard]] std::optional<double> Accel(int axis, TimeNs stamp_ns) const {
    return Mean(3 + axis, stamp_ns);
  }

 private:
  struct End {
    TimeNs stamp_ns = 0;
    NavState nav;
    double variance = 0;  ///< of angle or velocity along the axis [rad^2, m^2/s^2]
  };
  struct Axis {
    std::optional<End> end;  ///< of the newest interval
    double mean = 0;
    std::optional<TimeNs> known_ns;  ///< the end of the interval of `mean`
  };
  [[nodiscard]] std::optional<double> Mean(int which, TimeNs stamp_ns) const;
  [[nodiscard]] double Between(const End& before, const NavEstimate& now, int which) const;

  Eigen::Vector3d gravity_;
  std::array<Axis, 6> axes_{};  ///< gyroscope x y z, accelerometer x y z
};

}  // namespace alidade
