#include "eval/comparison/aggregate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numbers.h"
#include "eval/comparison/distinct.h"
#include "eval/comparison/nees_over_time.h"
#include "eval/metrics/nees.h"

namespace alidade {
namespace {

std::pair<double, double> BandOrNan(int dof, int runs) {
  return runs > 0 ? NeesBand(dof, runs) : std::pair<double, double>(kNan, kNan);
}

void CountStatus(const CellResult& cell, AggregateRow* row) {
  ++row->cells;
  if (cell.status == "ok") {
    ++row->ok;
  } else if (cell.status == "diverged") {
    ++row->diverged;
  } else if (cell.status == "not_initialized") {
    ++row->not_initialized;
  } else {
    ++row->failed;
  }
}

AggregateRow AggregateCells(const std::vector<const CellResult*>& cells, const std::vector<Figure>& figures) {
  AggregateRow row;
  row.estimator = cells.front()->estimator;
  row.sequence = cells.front()->sequence;
  for (const CellResult* cell : cells) {
    CountStatus(*cell, &row);
    // A cell that failed early may have no back end yet.
    row.backend = row.backend.empty() ? cell->backend : row.backend;
    row.smoothed = row.smoothed || cell->smoothed;
  }
  for (const Figure& figure : figures) {
    std::vector<double> values;
    for (const CellResult* cell : cells) {
      if (cell->status == "ok" || figure.of_all_runs) {
        values.push_back(figure.value(*cell));
      }
    }
    row.figures.push_back(ComputeStatistic(values));
  }
  row.nees_pose_band = BandOrNan(6, row.ok);
  row.nees_ori_band = BandOrNan(3, row.ok);
  row.nees_pos_band = BandOrNan(3, row.ok);
  row.nees_inside_share = AverageNees(cells).share_inside;
  if (const std::optional<size_t> nees = FindFigure(figures, "nees_pose")) {
    row.nees_verdict = NeesVerdict(row.figures[*nees].mean, row.nees_pose_band);
  }
  row.best.assign(figures.size(), false);
  return row;
}

/// An estimate that uses later data is not ranked among those that do not.
bool IsRival(const AggregateRow& row, int most_ok) {
  return row.ok == most_ok && !row.smoothed;
}

int MostOk(const AggregateRow* begin, const AggregateRow* end) {
  int most_ok = 1;
  for (const AggregateRow* row = begin; row != end; ++row) {
    most_ok = row->smoothed ? most_ok : std::max(most_ok, row->ok);
  }
  return most_ok;
}

/// Marks the best of the rows [begin, end), which are one sequence.
void MarkBest(const std::vector<Figure>& figures, AggregateRow* begin, AggregateRow* end) {
  const int most_ok = MostOk(begin, end);
  for (size_t i = 0; i < figures.size(); ++i) {
    const auto badness = [&](const AggregateRow& row) {
      const bool rival = IsRival(row, figures[i].of_all_runs ? row.ok : most_ok);
      return rival ? Badness(figures[i], row.figures[i].mean) : kNan;
    };
    double least = std::numeric_limits<double>::infinity();
    int rivals = 0;
    for (const AggregateRow* row = begin; row != end; ++row) {
      least = std::fmin(least, badness(*row));
      rivals += std::isnan(badness(*row)) ? 0 : 1;
    }
    for (AggregateRow* row = begin; row != end && rivals > 1; ++row) {
      row->best[i] = badness(*row) == least;
    }
  }
}

/// Ratios of the mean RMSEs of the rows [begin, end), which are one sequence, to the lowest of them.
void RelateToBest(const std::vector<Figure>& figures, AggregateRow* begin, AggregateRow* end) {
  const int most_ok = MostOk(begin, end);
  for (const auto& [key, ratio] : {std::pair("rmse_pos_m", &AggregateRow::rmse_pos_to_best),
                                   std::pair("rmse_ori_deg", &AggregateRow::rmse_ori_to_best)}) {
    const std::optional<size_t> figure = FindFigure(figures, key);
    double least = kNan;
    for (const AggregateRow* row = begin; row != end && figure; ++row) {
      least = IsRival(*row, most_ok) ? std::fmin(least, row->figures[*figure].mean) : least;
    }
    for (AggregateRow* row = begin; row != end && figure; ++row) {
      row->*ratio = row->figures[*figure].mean / least;
    }
  }
}

/// Ratios of mean RMSEs to those of the same label on the baseline.
void RelateToBaseline(const std::string& baseline, const std::vector<Figure>& figures,
                      std::vector<AggregateRow>* rows) {
  const std::optional<size_t> pos = FindFigure(figures, "rmse_pos_m");
  const std::optional<size_t> ori = FindFigure(figures, "rmse_ori_deg");
  if (baseline.empty() || !pos || !ori) {
    return;
  }
  for (AggregateRow& row : *rows) {
    for (const AggregateRow& clean : *rows) {
      if (clean.label == row.label && clean.sequence == baseline) {
        row.rmse_pos_ratio = row.figures[*pos].mean / clean.figures[*pos].mean;
        row.rmse_ori_ratio = row.figures[*ori].mean / clean.figures[*ori].mean;
      }
    }
  }
}

}  // namespace

Statistic ComputeStatistic(const std::vector<double>& values) {
  Statistic statistic;
  double sum = 0;
  for (const double value : values) {
    if (!std::isnan(value)) {
      sum += value;
      ++statistic.count;
      statistic.largest = std::isnan(statistic.largest) ? value : std::max(statistic.largest, value);
    }
  }
  statistic.mean = statistic.count > 0 ? sum / statistic.count : kNan;
  double squares = 0;
  for (const double value : values) {
    if (!std::isnan(value)) {
      squares += (value - statistic.mean) * (value - statistic.mean);
    }
  }
  const double count = statistic.count;
  statistic.standard_error = count > 1 ? std::sqrt(squares / (count - 1) / count) : kNan;
  return statistic;
}

std::vector<AggregateRow> Aggregate(const Comparison& comparison, const std::vector<Figure>& figures) {
  std::vector<AggregateRow> rows;
  for (const CellGroup& group : GroupCells(comparison)) {
    rows.push_back(AggregateCells(group.cells, figures));
    rows.back().label = group.label;
    if (const auto named = comparison.groups.find(group.sequence); named != comparison.groups.end()) {
      rows.back().group = named->second;
    }
  }
  for (size_t first = 0, end = 0; first < rows.size(); first = end) {
    while (end < rows.size() && rows[end].sequence == rows[first].sequence) {
      ++end;
    }
    MarkBest(figures, rows.data() + first, rows.data() + end);
    RelateToBest(figures, rows.data() + first, rows.data() + end);
  }
  RelateToBaseline(comparison.baseline, figures, &rows);
  return rows;
}

std::vector<std::string> ListSequences(const std::vector<AggregateRow>& rows) {
  return Distinct(rows, [](const AggregateRow& row) { return row.sequence; });
}

std::vector<std::string> ListLabels(const std::vector<AggregateRow>& rows) {
  return Distinct(rows, [](const AggregateRow& row) { return row.label; });
}

}  // namespace alidade
