#include "eval/study/gnss_study_tables.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "eval/comparison/aggregate.h"
#include "eval/metrics/nees.h"

// The tables of the GNSS study.

namespace alidade {
namespace {

using Member = double GnssRunFigures::*;

Statistic Over(const GnssStudyRow& row, Member figure,
               GnssRunFigures GnssStudyRun::*whose = &GnssStudyRun::figures) {
  std::vector<double> values;
  for (const GnssStudyRun& run : row.runs) {
    values.push_back((run.*whose).*figure);
  }
  return ComputeStatistic(values);
}

double MeanSinglePoint(const GnssStudyRow& row) {
  std::vector<double> values;
  for (const GnssStudyRun& run : row.runs) {
    values.push_back(run.single_point_m);
  }
  return ComputeStatistic(values).mean;
}

/// A number, or a dash for what does not apply.
std::string Cell(double value, int decimals) {
  return std::isnan(value) ? "–" : Format("%.*f", decimals, value);
}

/// Errors meanwhile of the runs that `others` has too, by the same seeds, beside theirs.
struct Beside {
  std::vector<double> mine;
  std::vector<double> others;

  void Add(const GnssRunFigures& run, const GnssRunFigures& other) {
    mine.push_back(run.outage_rmse_m);
    others.push_back(other.outage_rmse_m);
  }
  /// The others' mean and how many of mine are at most 1.1 of theirs: two cells.
  [[nodiscard]] std::string Cells() const {
    constexpr double kMargin = 1.1;
    int count = 0;
    for (std::size_t i = 0; i < mine.size(); ++i) {
      count += mine[i] <= kMargin * others[i] ? 1 : 0;
    }
    return mine.empty() ? "– | –"
                        : Cell(ComputeStatistic(others).mean, 3) + Format(" | %d of %zu", count, mine.size());
  }
};

Beside Odometry(const GnssStudyRow& row) {
  Beside beside;
  for (const GnssStudyRun& run : row.runs) {
    beside.Add(run.figures, run.odometry);
  }
  return beside;
}

/// The same estimator in the same outage, with no satellite left.
Beside NoneLeft(const std::vector<GnssStudyRow>& rows, const GnssStudyRow& row) {
  Beside beside;
  for (const GnssStudyRow& other : rows) {
    if (other.estimator != row.estimator || other.scenario.outage_satellites > 0 ||
        row.scenario.outage_satellites == 0 || other.scenario.outage_start_s != row.scenario.outage_start_s ||
        other.scenario.outage_end_s != row.scenario.outage_end_s) {
      continue;
    }
    for (const GnssStudyRun& run : row.runs) {
      const auto same = std::find_if(other.runs.begin(), other.runs.end(),
                                     [&](const GnssStudyRun& r) { return r.seed == run.seed; });
      if (same != other.runs.end()) {
        beside.Add(run.figures, same->figures);
      }
    }
    return beside;
  }
  return beside;
}

double RatioToFirst(const std::vector<GnssStudyRow>& rows, const GnssStudyRow& row) {
  for (const GnssStudyRow& first : rows) {
    if (first.sequence == rows.front().sequence && first.estimator == row.estimator) {
      return Over(row, &GnssRunFigures::rmse_m).mean / Over(first, &GnssRunFigures::rmse_m).mean;
    }
  }
  return GnssRunFigures::kNone;
}

std::string Overview(const std::vector<GnssStudyRow>& rows) {
  std::string table =
      "| sequence | estimator | runs aligned | after [s], mean, worst | RMSE [m] | worst [m] | to the first "
      "sequence | single points [m] | last third to first | NEES position | its band |\n"
      "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const GnssStudyRow& row : rows) {
    if (row.runs.empty()) {
      continue;
    }
    const Statistic after = Over(row, &GnssRunFigures::aligned_after_s);
    const Statistic rmse = Over(row, &GnssRunFigures::rmse_m);
    const auto [low, high] = NeesBand(3, rmse.count);
    table += Format(
        "| %s | `%s` | %d of %zu | %s, %s | %s ± %s | %s | %s | %s | %s | %s | %.2f to %.2f |\n",
        row.sequence.c_str(), row.estimator.c_str(), after.count, row.runs.size(),
        Cell(after.mean, 1).c_str(), Cell(after.largest, 1).c_str(), Cell(rmse.mean, 3).c_str(),
        Cell(rmse.standard_error, 3).c_str(), Cell(rmse.largest, 3).c_str(),
        Cell(RatioToFirst(rows, row), 2).c_str(), Cell(MeanSinglePoint(row), 2).c_str(),
        Cell(Over(row, &GnssRunFigures::late_m).mean / Over(row, &GnssRunFigures::early_m).mean, 2).c_str(),
        Cell(Over(row, &GnssRunFigures::nees_pos).mean, 2).c_str(), low, high);
  }
  return table;
}

std::string Outages(const std::vector<GnssStudyRow>& rows) {
  std::string table;
  for (const GnssStudyRow& row : rows) {
    if (row.runs.empty() || !row.scenario.HasOutage()) {
      continue;
    }
    const Statistic covered = Over(row, &GnssRunFigures::return_covered);
    const Statistic later = Over(row, &GnssRunFigures::after_2_s_m);
    const auto mean = [&](Member figure, GnssRunFigures GnssStudyRun::*whose) {
      return Cell(Over(row, figure, whose).mean, 3);
    };
    const auto ours = &GnssStudyRun::figures;
    const auto alone = &GnssStudyRun::odometry;
    table += Format("| %s | `%s` | %s | %s | %s | %s | %s | %.0f of %d | %s | %s |\n", row.sequence.c_str(),
                    row.estimator.c_str(), mean(&GnssRunFigures::outage_rmse_m, ours).c_str(),
                    Odometry(row).Cells().c_str(), NoneLeft(rows, row).Cells().c_str(),
                    mean(&GnssRunFigures::return_error_m, ours).c_str(),
                    mean(&GnssRunFigures::return_error_m, alone).c_str(), covered.mean * covered.count,
                    covered.count, Cell(later.mean, 3).c_str(), Cell(later.largest, 3).c_str());
  }
  return table.empty()
             ? table
             : "\n| sequence | estimator | RMSE meanwhile [m] | VIO alone [m] | at most 1.1 of it | no "
               "satellite [m] | at most 1.1 of it | error at its end [m] | VIO alone [m] | within 3 sigma | "
               "2 s later [m] | worst [m] |\n"
               "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n" +
                   table;
}

std::string Jumps(const std::vector<GnssStudyRow>& rows) {
  std::string table;
  for (const GnssStudyRow& row : rows) {
    if (row.scenario.clock_jump_s >= 0) {
      const Statistic step = Over(row, &GnssRunFigures::jump_step_m);
      table += Format("| %s | `%s` | %s | %s |\n", row.sequence.c_str(), row.estimator.c_str(),
                      Cell(step.mean, 3).c_str(), Cell(step.largest, 3).c_str());
    }
  }
  return table.empty()
             ? table
             : "\n| sequence | estimator | step of the position at the jump, mean [m] | worst [m] |\n"
               "|---|---|---:|---:|\n" +
                   table;
}

}  // namespace

std::string GnssStudyTables(const std::vector<GnssStudyRow>& rows) {
  return Overview(rows) + Outages(rows) + Jumps(rows);
}

}  // namespace alidade
