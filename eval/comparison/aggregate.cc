#include "eval/comparison/aggregate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "core/numbers.h"
#include "eval/comparison/distinct.h"
#include "eval/comparison/nees_over_time.h"
#include "eval/files/output_file.h"
#include "eval/metrics/nees.h"

namespace alidade {
namespace {

/// Share of a Gaussian inside +-3 standard deviations.
constexpr double kGaussianInside3Sigma = 0.9973002039367398;

bool HasTrajectory(const CellResult& cell) {
  return cell.frames > 0 && cell.status != "failed";
}

const RpeResult* FindRpe(const CellResult& cell, double distance_m) {
  for (const RpeResult& rpe : cell.rpe) {
    if (rpe.distance_m == distance_m && rpe.count > 0) {
      return &rpe;
    }
  }
  return nullptr;
}

using Value = std::function<double(const CellResult&)>;

Value OfTrajectory(std::optional<double> CellResult::*field) {
  return
      [field](const CellResult& cell) { return HasTrajectory(cell) ? (cell.*field).value_or(kNan) : kNan; };
}

void AppendRpeFigures(const Comparison& comparison, std::vector<Figure>* figures) {
  std::set<double> distances;
  for (const CellResult& cell : comparison.cells) {
    for (const RpeResult& rpe : cell.rpe) {
      distances.insert(rpe.distance_m);
    }
  }
  for (const double distance : distances) {
    const std::string name = ShortestDouble(distance) + "m";
    const std::string spaced = ShortestDouble(distance) + " m";
    figures->push_back({"rpe_" + name + "_pos_m", "RPE " + spaced + " pos.", "m", Ideal::kLow, 0, 3,
                        [distance](const CellResult& cell) {
                          const RpeResult* rpe = HasTrajectory(cell) ? FindRpe(cell, distance) : nullptr;
                          return rpe == nullptr ? kNan : rpe->pos_rmse_m;
                        }});
    figures->push_back({"rpe_" + name + "_ori_deg", "RPE " + spaced + " ori.", "deg", Ideal::kLow, 0, 3,
                        [distance](const CellResult& cell) {
                          const RpeResult* rpe = HasTrajectory(cell) ? FindRpe(cell, distance) : nullptr;
                          return rpe == nullptr ? kNan : rpe->ori_rmse_deg;
                        }});
  }
}

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
    // A cell that failed early may not know its back end.
    row.backend = row.backend.empty() ? cell->backend : row.backend;
  }
  for (const Figure& figure : figures) {
    std::vector<double> values;
    for (const CellResult* cell : cells) {
      if (cell->status == "ok") {
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

/// An estimate that knows the future is a bound and no rival.
bool IsBound(const AggregateRow& row) {
  return row.backend == "batch";
}
bool IsRival(const AggregateRow& row, int most_ok) {
  return row.ok == most_ok && !IsBound(row);
}

int MostOk(const AggregateRow* begin, const AggregateRow* end) {
  int most_ok = 1;
  for (const AggregateRow* row = begin; row != end; ++row) {
    most_ok = IsBound(*row) ? most_ok : std::max(most_ok, row->ok);
  }
  return most_ok;
}

/// Marks the best of the rows [begin, end), which are one sequence.
void MarkBest(const std::vector<Figure>& figures, AggregateRow* begin, AggregateRow* end) {
  const int most_ok = MostOk(begin, end);
  for (size_t i = 0; i < figures.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    int rivals = 0;
    for (const AggregateRow* row = begin; row != end; ++row) {
      const double badness = Badness(figures[i], row->figures[i].mean);
      if (IsRival(*row, most_ok) && !std::isnan(badness)) {
        least = std::min(least, badness);
        ++rivals;
      }
    }
    for (AggregateRow* row = begin; row != end && rivals > 1; ++row) {
      row->best[i] = IsRival(*row, most_ok) && Badness(figures[i], row->figures[i].mean) == least;
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

std::vector<Figure> ListFigures(const Comparison& comparison) {
  std::vector<Figure> figures = {
      {"rmse_pos_m", "RMSE pos.", "m", Ideal::kLow, 0, 3, OfTrajectory(&CellResult::rmse_pos_m)},
      {"rmse_ori_deg", "RMSE ori.", "deg", Ideal::kLow, 0, 3, OfTrajectory(&CellResult::rmse_ori_deg)},
      {"ate_pos_m", "ATE pos.", "m", Ideal::kLow, 0, 3, OfTrajectory(&CellResult::ate_pos_m)},
      {"ate_ori_deg", "ATE ori.", "deg", Ideal::kLow, 0, 3, OfTrajectory(&CellResult::ate_ori_deg)}};
  AppendRpeFigures(comparison, &figures);
  const std::vector<Figure> rest = {
      {"nees_pose", "NEES pose", "", Ideal::kTarget, 6, 2, OfTrajectory(&CellResult::nees_pose)},
      {"nees_ori", "NEES ori.", "", Ideal::kTarget, 3, 2, OfTrajectory(&CellResult::nees_ori)},
      {"nees_pos", "NEES pos.", "", Ideal::kTarget, 3, 2, OfTrajectory(&CellResult::nees_pos)},
      {"coverage_3sigma", "inside 3\u03c3", "", Ideal::kTarget, kGaussianInside3Sigma, 3,
       OfTrajectory(&CellResult::coverage_3sigma)},
      {"frontend_ms", "front end", "ms", Ideal::kNone, 0, 2, OfTrajectory(&CellResult::frontend_ms)},
      {"backend_ms", "back end", "ms", Ideal::kLow, 0, 2, OfTrajectory(&CellResult::backend_ms)},
      {"backend_ms_p95", "back end p95", "ms", Ideal::kLow, 0, 2, OfTrajectory(&CellResult::backend_ms_p95)},
      {"features_per_frame", "features", "1/frame", Ideal::kNone, 0, 1,
       OfTrajectory(&CellResult::features_per_frame)},
      {"gated_share", "gated", "", Ideal::kNone, 0, 3, OfTrajectory(&CellResult::gated_share)},
      {"silent_s", "silent failure", "s", Ideal::kLow, 0, 1, OfTrajectory(&CellResult::silent_s)},
      {"alarm_inside_share", "alarms inside 3\u03c3", "", Ideal::kLow, 0, 3,
       OfTrajectory(&CellResult::alarm_inside_share)}};
  figures.insert(figures.end(), rest.begin(), rest.end());
  const auto known = [&comparison](std::optional<double> CellResult::*member) {
    return std::any_of(comparison.cells.begin(), comparison.cells.end(),
                       [member](const CellResult& cell) { return (cell.*member).has_value(); });
  };
  for (const auto& [key, label, member] :
       {std::tuple("nees_vel", "NEES vel.", &CellResult::nees_vel),
        std::tuple("nees_gyro_bias", "NEES gyro bias", &CellResult::nees_gyro_bias),
        std::tuple("nees_accel_bias", "NEES accel. bias", &CellResult::nees_accel_bias)}) {
    if (known(member)) {
      figures.push_back({key, label, "", Ideal::kTarget, 3, 2, OfTrajectory(member)});
    }
  }
  const auto plain = [](std::optional<double> CellResult::*member) {
    return [member](const CellResult& cell) { return (cell.*member).value_or(kNan); };
  };
  if (known(&CellResult::calibration_rotation_deg)) {
    figures.push_back({"calibration_rotation_deg", "camera rotation", "deg", Ideal::kLow, 0, 3,
                       plain(&CellResult::calibration_rotation_deg)});
    figures.push_back({"calibration_translation_m", "camera position", "m", Ideal::kLow, 0, 4,
                       plain(&CellResult::calibration_translation_m)});
    figures.push_back({"calibration_time_ms", "time offset", "ms", Ideal::kLow, 0, 3,
                       plain(&CellResult::calibration_time_ms)});
  }
  if (std::any_of(comparison.cells.begin(), comparison.cells.end(),
                  [](const CellResult& cell) { return cell.restarts > 0; })) {
    figures.push_back({"restarts", "restarts", "", Ideal::kLow, 0, 1,
                       [](const CellResult& cell) { return static_cast<double>(cell.restarts); }});
  }
  return figures;
}

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

double Badness(const Figure& figure, double value) {
  switch (figure.ideal) {
    case Ideal::kNone:
      return kNan;
    case Ideal::kLow:
      return value;
    case Ideal::kTarget:
      // Shares lie near one: distance. NEES spans decades, and half the ideal is as bad as twice: ratio.
      return figure.target < 1 ? std::abs(value - figure.target) : std::abs(std::log(value / figure.target));
  }
  return kNan;
}

std::optional<size_t> FindFigure(const std::vector<Figure>& figures, const std::string& key) {
  for (size_t i = 0; i < figures.size(); ++i) {
    if (figures[i].key == key) {
      return i;
    }
  }
  return std::nullopt;
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
