#include "eval/metrics/completion.h"

#include <algorithm>

namespace alidade {

std::vector<TimeNs> RowStamps(const Trajectory& trajectory) {
  std::vector<TimeNs> stamps_ns;
  stamps_ns.reserve(trajectory.points.size());
  for (const TrajectoryPoint& point : trajectory.points) {
    stamps_ns.push_back(point.stamp_ns);
  }
  return stamps_ns;
}

double CoveredSeconds(const std::vector<TimeNs>& stamps_ns, TimeNs begin_ns, TimeNs end_ns) {
  TimeNs covered_ns = 0;
  for (size_t i = 1; i < stamps_ns.size(); ++i) {
    if (SecondsBetween(stamps_ns[i - 1], stamps_ns[i]) <= kLongestRowStepS) {
      const TimeNs from_ns = std::max(stamps_ns[i - 1], begin_ns);
      const TimeNs to_ns = std::min(stamps_ns[i], end_ns);
      covered_ns += std::max<TimeNs>(0, to_ns - from_ns);
    }
  }
  return SecondsBetween(0, covered_ns);
}

double CoveredSeconds(const std::vector<TimeNs>& stamps_ns) {
  return stamps_ns.empty() ? 0 : CoveredSeconds(stamps_ns, stamps_ns.front(), stamps_ns.back());
}

std::optional<double> Completion(const std::vector<TimeNs>& stamps_ns, TimeNs first_frame_ns,
                                 TimeNs last_frame_ns) {
  if (last_frame_ns <= first_frame_ns) {
    return std::nullopt;
  }
  return CoveredSeconds(stamps_ns, first_frame_ns, last_frame_ns) /
         SecondsBetween(first_frame_ns, last_frame_ns);
}

}  // namespace alidade
