#include "eval/peers/peer_summary.h"

#include "core/format.h"

namespace alidade {

std::string SummaryText(const PeerSequence& sequence, const PeerRun& run,
                        const std::optional<TimeNs>& aligned_ns) {
  constexpr double kGapS = 0.5;
  const auto& points = run.trajectory.points;
  if (points.empty()) {
    return "no pose\n";
  }
  double covered_s = 0;
  for (size_t i = 1; i < points.size(); ++i) {
    const double step_s = SecondsBetween(points[i - 1].stamp_ns, points[i].stamp_ns);
    covered_s += step_s <= kGapS ? step_s : 0;
  }
  const TimeNs begin_ns = sequence.frames_ns.front();
  const double length_s = SecondsBetween(begin_ns, sequence.frames_ns.back());
  const std::string aligned = aligned_ns
                                  ? Format("aligned after %.2f s", SecondsBetween(begin_ns, *aligned_ns))
                                  : std::string("not aligned");
  return Format("%zu poses, the first after %.2f s; ", points.size(),
                SecondsBetween(begin_ns, points.front().stamp_ns)) +
         aligned + Format("; %.1f %% of the time\n", length_s > 0 ? 100 * covered_s / length_s : 0);
}

}  // namespace alidade
