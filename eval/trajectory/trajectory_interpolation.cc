#include "eval/trajectory/trajectory_interpolation.h"

#include <algorithm>

namespace alidade {
namespace {

constexpr double kMaxGapS = 0.1;

}  // namespace

std::size_t FirstAtOrAfter(const std::vector<TrajectoryPoint>& points, TimeNs stamp_ns) {
  const auto found =
      std::lower_bound(points.begin(), points.end(), stamp_ns,
                       [](const TrajectoryPoint& point, TimeNs stamp) { return point.stamp_ns < stamp; });
  return static_cast<std::size_t>(found - points.begin());
}

TrajectoryPoint Interpolate(const TrajectoryPoint& before, const TrajectoryPoint& after, TimeNs stamp_ns) {
  const double fraction =
      SecondsBetween(before.stamp_ns, stamp_ns) / SecondsBetween(before.stamp_ns, after.stamp_ns);
  TrajectoryPoint point = before;
  point.stamp_ns = stamp_ns;
  point.nav.p_WB += fraction * (after.nav.p_WB - before.nav.p_WB);
  point.nav.v_WB += fraction * (after.nav.v_WB - before.nav.v_WB);
  point.bias.gyro += fraction * (after.bias.gyro - before.bias.gyro);
  point.bias.accel += fraction * (after.bias.accel - before.bias.accel);
  const Eigen::Vector3d turn = so3::Log(before.nav.R_WB.transpose() * after.nav.R_WB);
  point.nav.R_WB = before.nav.R_WB * so3::Exp(fraction * turn);
  return point;
}

Result<TrajectoryPoint> InterpolateTruth(const Trajectory& truth, TimeNs stamp_ns) {
  const std::vector<TrajectoryPoint>& points = truth.points;
  const std::size_t after = FirstAtOrAfter(points, stamp_ns);
  if (after < points.size() && points[after].stamp_ns == stamp_ns) {
    return points[after];
  }
  if (after == 0 || after == points.size()) {
    return Status::Input("truth does not cover " + FormatSeconds(stamp_ns) + " s" +
                         (points.empty() ? std::string(": it is empty")
                                         : ": it spans " + FormatSeconds(points.front().stamp_ns) + " s to " +
                                               FormatSeconds(points.back().stamp_ns) + " s"));
  }
  if (SecondsBetween(points[after - 1].stamp_ns, points[after].stamp_ns) > kMaxGapS) {
    return Status::Input("truth has a gap around " + FormatSeconds(stamp_ns) + " s");
  }
  return Interpolate(points[after - 1], points[after], stamp_ns);
}

}  // namespace alidade
