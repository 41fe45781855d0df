#include "eval/calibrate/gyro_path.h"

#include <algorithm>

#include "core/check.h"
#include "core/gyro_rotation.h"
#include "core/lie.h"
#include "core/time.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

GyroPath::GyroPath(const std::vector<ImuSample>& imu, const Vector3d& bias, double gyro_sign) {
  CHECK_GE(imu.size(), 2U);
  times_s_.reserve(imu.size());
  points_.reserve(imu.size());
  Point point;
  for (const ImuSample& sample : imu) {
    const double time_s = SecondsBetween(imu.front().stamp_ns, sample.stamp_ns);
    const Vector3d rate = gyro_sign * sample.gyro - bias;
    if (!points_.empty()) {
      const double dt_s = time_s - times_s_.back();
      const Matrix3d before = point.R_0t;
      const Vector3d turn = TurnOverStep(point.rate_B, rate, dt_s);
      point.R_0t = before * so3::Exp(turn);
      point.integral += before * so3::LeftJacobian(turn) * dt_s;
    }
    point.rate_B = rate;
    times_s_.push_back(time_s);
    points_.push_back(point);
  }
}

GyroPath::Point GyroPath::At(double t_s) const {
  t_s = std::clamp(t_s, times_s_.front(), times_s_.back());
  const auto next = std::upper_bound(times_s_.begin(), times_s_.end() - 1, t_s);
  const auto k = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, next - times_s_.begin() - 1));
  const Point& from = points_[k];
  const Point& to = points_[k + 1];
  const double dt_s = t_s - times_s_[k];
  const double share = dt_s / (times_s_[k + 1] - times_s_[k]);
  Point point;
  point.rate_B = from.rate_B + share * (to.rate_B - from.rate_B);
  const Vector3d turn = TurnOverStep(from.rate_B, point.rate_B, dt_s);
  point.R_0t = from.R_0t * so3::Exp(turn);
  point.integral = from.integral + from.R_0t * so3::LeftJacobian(turn) * dt_s;
  return point;
}

Matrix3d GyroPath::BiasJacobian(const Point& i, const Point& j) {
  return -j.R_0t.transpose() * (j.integral - i.integral);
}

}  // namespace alidade
