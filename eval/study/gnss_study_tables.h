#pragma once

#include <string>
#include <vector>

#include "eval/study/gnss_study.h"

namespace alidade {

/// One seed of an estimator on a sequence.
struct GnssStudyRun {
  unsigned seed = 0;
  GnssRunFigures figures;
  GnssRunFigures odometry;  ///< over the same time, by the plan's estimator without GNSS
  double single_point_m = GnssRunFigures::kNone;
};

struct GnssStudyRow {
  std::string sequence;
  std::string estimator;
  GnssScenario scenario;
  std::vector<GnssStudyRun> runs;
};

/// Markdown: figures of the runs, and a table each for outages and clock jumps if there are any. An outage
/// with remaining satellites is compared with an outage of the same time without satellites, if there is one.
/// A row without runs is omitted. Ratios are those of means, to the same estimator on the first sequence.
[[nodiscard]] std::string GnssStudyTables(const std::vector<GnssStudyRow>& rows);

}  // namespace alidade
