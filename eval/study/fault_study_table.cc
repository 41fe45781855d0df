#include "eval/study/fault_study_table.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "eval/comparison/aggregate.h"

namespace alidade {
namespace {

/// "mean, worst", and the count of the runs in which it happened if those are not all.
std::string Times(const FaultStudyRow& row, double FaultFigures::*figure) {
  std::vector<double> times;
  std::size_t applies = 0;
  for (const FaultFigures& run : row.runs) {
    applies += std::isnan(run.*figure) ? 0 : 1;
    if (std::isfinite(run.*figure)) {
      times.push_back(run.*figure);
    }
  }
  if (times.empty()) {
    return applies == 0 ? "–" : "never";
  }
  const Statistic over_runs = ComputeStatistic(times);
  const std::string text = Format("%.2f, %.2f", over_runs.mean, over_runs.largest);
  return times.size() == applies ? text : text + Format(" (%zu of %zu)", times.size(), applies);
}

bool IsBesideClean(const FaultStudyRow& row) {
  return std::all_of(row.runs.begin(), row.runs.end(),
                     [](const FaultFigures& run) { return run.beside_clean; });
}

}  // namespace

std::string FaultStudyTable(const std::vector<FaultStudyRow>& rows) {
  std::string table =
      "Mean and worst over the runs [s]; in brackets: runs in which it happened.\n\n"
      "| sequence | estimator | runs | reported after the start | ok after the end | pose within 3 sigma | "
      "position as without the fault | longest silent failure |\n"
      "|---|---|---:|---:|---:|---:|---:|---:|\n";
  bool all_beside_clean = true;
  for (const FaultStudyRow& row : rows) {
    if (row.runs.empty()) {
      continue;
    }
    const bool beside_clean = IsBesideClean(row);
    all_beside_clean = all_beside_clean && beside_clean;
    table += Format(
        "| %s | `%s` | %zu | %s | %s | %s | %s%s | %s |\n", row.sequence.c_str(), row.estimator.c_str(),
        row.runs.size(), Times(row, &FaultFigures::reported_after_s).c_str(),
        Times(row, &FaultFigures::ok_after_s).c_str(), Times(row, &FaultFigures::covered_after_s).c_str(),
        Times(row, &FaultFigures::accurate_after_s).c_str(), beside_clean ? "" : " \\*",
        Times(row, &FaultFigures::silent_s).c_str());
  }
  return table + (all_beside_clean ? ""
                                   : "\n\\* position within 3 sigma where a run without the fault is "
                                     "missing\n");
}

}  // namespace alidade
