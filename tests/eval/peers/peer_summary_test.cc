#include "eval/peers/peer_summary.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

TEST(SummaryText, HoldsStartAlignmentAndCoverage) {
  PeerSequence sequence;
  sequence.frames_ns = {kSecondNs, 11 * kSecondNs};
  PeerRun run;
  EXPECT_EQ(SummaryText(sequence, run, std::nullopt), "no pose\n");
  // 3.0 to 4.0 s in steps of 0.25 s, then nothing until 8 s.
  for (const TimeNs ms : {3000, 3250, 3500, 3750, 4000, 8000}) {
    run.trajectory.points.emplace_back().stamp_ns = ms * 1'000'000;
  }
  EXPECT_EQ(SummaryText(sequence, run, std::nullopt),
            "6 poses, the first after 2.00 s; not aligned; 10.0 % of the time\n");
  EXPECT_EQ(SummaryText(sequence, run, 4 * kSecondNs),
            "6 poses, the first after 2.00 s; aligned after 3.00 s; 10.0 % of the time\n");
}

}  // namespace
}  // namespace alidade
