#include "eval/run/implied_imu.h"

#include <cmath>

#include "core/imu_gap.h"
#include "core/lie.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double ImpliedImu::Between(const End& before, const NavEstimate& now, int which) const {
  const double dt_s = SecondsBetween(before.stamp_ns, now.stamp_ns);
  const Vector3d angle = so3::Log(before.nav.R_WB.transpose() * now.nav.R_WB);
  if (which < 3) {
    return angle[which] / dt_s + now.bias.gyro[which];
  }
  const Matrix3d R_m = before.nav.R_WB * so3::Exp(0.5 * angle);
  const Vector3d force = R_m.transpose() * ((now.nav.v_WB - before.nav.v_WB) / dt_s - gravity_);
  return force[which - 3] + now.bias.accel[which - 3];
}

void ImpliedImu::Add(const NavEstimate& estimate) {
  const Matrix3d& R = estimate.nav.R_WB;
  const Vector3d angle = estimate.covariance.diagonal().head<3>();
  const Vector3d velocity = (R.transpose() * estimate.covariance.block<3, 3>(6, 6) * R).diagonal();
  for (int which = 0; which < 6; ++which) {
    Axis& axis = axes_[static_cast<std::size_t>(which)];
    const double variance = which < 3 ? angle[which] : velocity[which - 3];
    if (axis.end) {
      const double dt_s = SecondsBetween(axis.end->stamp_ns, estimate.stamp_ns);
      if (!(dt_s > 0)) {
        continue;
      }
      const double floor = which < 3 ? imu_gap::kMinGyroRadps : imu_gap::kMinAccelMps2;
      const bool known = std::abs(variance - axis.end->variance) <= floor * floor * dt_s * dt_s;
      if (!known && dt_s <= kLongestS) {
        continue;
      }
      if (known && dt_s <= kLongestS) {
        axis.mean = Between(*axis.end, estimate, which);
        axis.known_ns = estimate.stamp_ns;
      }
    }
    axis.end = End{estimate.stamp_ns, estimate.nav, variance};
  }
}

std::optional<double> ImpliedImu::Mean(int which, TimeNs stamp_ns) const {
  const Axis& axis = axes_[static_cast<std::size_t>(which)];
  if (!axis.known_ns || SecondsBetween(*axis.known_ns, stamp_ns) > kLongestS) {
    return std::nullopt;
  }
  return axis.mean;
}

}  // namespace alidade
