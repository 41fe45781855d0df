#include "eval/peers/peer_summary.h"

#include "core/format.h"
#include "eval/metrics/completion.h"

namespace alidade {

std::string SummaryText(const PeerSequence& sequence, const PeerRun& run,
                        const std::optional<TimeNs>& aligned_ns) {
  const auto& points = run.trajectory.points;
  if (points.empty()) {
    return "no pose\n";
  }
  const TimeNs begin_ns = sequence.frames_ns.front();
  const std::optional<double> completion =
      Completion(RowStamps(run.trajectory), begin_ns, sequence.frames_ns.back());
  const std::string aligned = aligned_ns
                                  ? Format("aligned after %.2f s", SecondsBetween(begin_ns, *aligned_ns))
                                  : std::string("not aligned");
  return Format("%zu poses, the first after %.2f s; ", points.size(),
                SecondsBetween(begin_ns, points.front().stamp_ns)) +
         aligned + Format("; %.1f %% of the time\n", 100 * completion.value_or(0));
}

}  // namespace alidade
