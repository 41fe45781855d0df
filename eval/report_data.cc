#include "eval/report_data.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "eval/aggregate.h"
#include "eval/efficiency.h"
#include "eval/nees_over_time.h"
#include "eval/paired.h"

namespace alidade {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// A number that JSON can hold, rounded to significant digits; null where it is not finite.
Json Rounded(double value, int digits) {
  if (!std::isfinite(value)) {
    return nullptr;
  }
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), "%.*g", digits, value);
  const double rounded = std::strtod(buffer, nullptr);
  // An integer prints without ".0".
  return std::abs(rounded) < 1e15 && rounded == std::floor(rounded) ? Json(static_cast<long long>(rounded))
                                                                    : Json(rounded);
}

Json Packed(const std::vector<double>& values, double finest) {
  const PackedColumn column = PackColumn(values, finest);
  Json deltas = Json::array();
  for (const auto& [finite, delta] : column.deltas) {
    deltas.push_back(finite ? Json(delta) : Json(nullptr));
  }
  return {{"q", column.quantum}, {"d", deltas}};
}

/// Every k-th row and the last one, so that no more than `most` remain. Picking rows evenly keeps means and
/// spreads.
std::vector<size_t> KeptRows(size_t rows, int most) {
  std::vector<size_t> kept;
  const size_t step = std::max<size_t>(1, (rows + static_cast<size_t>(most) - 1) / static_cast<size_t>(most));
  for (size_t i = 0; i < rows; i += step) {
    kept.push_back(i);
  }
  if (rows > 0 && kept.back() + 1 != rows) {
    kept.push_back(rows - 1);
  }
  return kept;
}

/// Components of the kept rows of a series of vectors, scaled; empty when the series is absent.
template <typename Vectors>
Json PackComponents(const Vectors& vectors, const std::vector<size_t>& kept, int first, double scale,
                    double finest) {
  Json components = Json::array();
  if (kept.empty() || vectors.size() <= kept.back()) {
    return components;
  }
  for (int axis = first; axis < first + 3; ++axis) {
    std::vector<double> values;
    for (const size_t i : kept) {
      values.push_back(vectors[i](axis) * scale);
    }
    components.push_back(Packed(values, finest));
  }
  return components;
}

Json RoundKept(const std::vector<double>& values, const std::vector<size_t>& kept, int digits) {
  Json list = Json::array();
  for (const size_t i : kept) {
    list.push_back(i < values.size() ? Rounded(values[i], digits) : Json(nullptr));
  }
  return list;
}

/// Five-number summary (5, 25, 50, 75, 95 %) of the finite values; empty without any.
Json Quantiles(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
               values.end());
  std::sort(values.begin(), values.end());
  Json quantiles = Json::array();
  for (const double share : {0.05, 0.25, 0.5, 0.75, 0.95}) {
    if (!values.empty()) {
      const double place = share * static_cast<double>(values.size() - 1);
      const size_t below = static_cast<size_t>(place);
      const size_t above = std::min(below + 1, values.size() - 1);
      const double part = place - static_cast<double>(below);
      quantiles.push_back(Rounded(values[below] + part * (values[above] - values[below]), 4));
    }
  }
  return quantiles;
}

/// Rounded leaks, empty when the run was not audited. Below the floor there is rounding alone, whose digits
/// would only lengthen the axis.
Json LeakData(std::vector<double> leaks, const std::vector<size_t>& kept) {
  constexpr double kFloor = 1e-12;
  for (double& leak : leaks) {
    leak = std::isfinite(leak) ? std::max(leak, kFloor) : leak;
  }
  return leaks.empty() ? Json(Json::array()) : RoundKept(leaks, kept, 3);
}

Json SeriesData(const CellSeries& series, int most) {
  const std::vector<size_t> kept = KeptRows(series.time_s.size(), most);
  std::vector<double> times;
  for (const size_t i : kept) {
    times.push_back(series.time_s[i]);
  }
  return {{"t", Packed(times, 1e-3)},
          {"truth", PackComponents(series.truth_position, kept, 0, 1.0, 1e-3)},
          {"est", PackComponents(series.position, kept, 0, 1.0, 1e-3)},
          {"ori", PackComponents(series.error, kept, 0, kDegrees, 1e-3)},
          {"ori_sigma", PackComponents(series.sigma, kept, 0, kDegrees, 1e-3)},
          {"pos", PackComponents(series.error, kept, 3, 1.0, 1e-3)},
          {"pos_sigma", PackComponents(series.sigma, kept, 3, 1.0, 1e-3)},
          {"nees", RoundKept(series.nees_pose, kept, 3)},
          {"ms", RoundKept(series.backend_ms, kept, 3)},
          {"ms_quantiles", Quantiles(series.backend_ms)},
          {"features", RoundKept(series.features_used, kept, 4)},
          {"rank", series.rank.empty() ? Json(Json::array()) : RoundKept(series.rank, kept, 2)},
          {"yaw_leak", LeakData(series.yaw_leak, kept)},
          {"position_leak", LeakData(series.position_leak, kept)}};
}

Json FigureValues(const std::vector<Figure>& figures, const CellResult& cell) {
  Json values = Json::array();
  for (const Figure& figure : figures) {
    values.push_back(Rounded(figure.value(cell), 6));
  }
  return values;
}

bool IsFirstSeed(const Comparison& comparison, const CellResult& cell) {
  return std::none_of(comparison.cells.begin(), comparison.cells.end(), [&](const CellResult& other) {
    return other.sequence == cell.sequence && other.estimator == cell.estimator && other.seed < cell.seed;
  });
}

/// Directions as points of the disc that has the zenith in its middle: x east, y north, 90 the horizon.
Json SkyData(const std::vector<SkyTrack>& tracks) {
  Json list = Json::array();
  for (const SkyTrack& track : tracks) {
    Json t = Json::array(), x = Json::array(), y = Json::array(), r = Json::array();
    for (size_t i = 0; i < track.time_s.size(); ++i) {
      const double azimuth = track.azimuth_deg[i] / kDegrees;
      const double down = 90 - track.elevation_deg[i];
      t.push_back(Rounded(track.time_s[i], 5));
      x.push_back(Rounded(down * std::sin(azimuth), 4));
      y.push_back(Rounded(down * std::cos(azimuth), 4));
      r.push_back(Rounded(track.residual_m[i], 4));
    }
    list.push_back({{"s", track.satellite},
                    {"t", t},
                    {"x", x},
                    {"y", y},
                    {"r", r},
                    {"used", Rounded(track.used_share, 4)},
                    {"rms", Rounded(track.rms_m, 4)}});
  }
  return list;
}

Json CellData(const Comparison& comparison, const std::vector<Figure>& figures, const CellResult& cell,
              int most) {
  Json rpe = Json::array();
  for (const RpeResult& result : cell.rpe) {
    rpe.push_back({{"d", result.distance_m}, {"n", result.count}, {"q", Quantiles(result.pos_errors_m)}});
  }
  return {{"estimator", LabelOf(comparison, cell)},
          {"sequence", cell.sequence},
          {"seed", cell.seed},
          {"status", cell.status},
          {"message", cell.message},
          {"digest", cell.input_digest},
          {"frames", cell.frames},
          {"duration", Rounded(cell.duration_s, 6)},
          {"path", Rounded(cell.path_m, 6)},
          {"align", cell.align},
          {"figures", FigureValues(figures, cell)},
          {"rpe", rpe},
          {"series", SeriesData(cell.series, most)},
          // Of one seed: the sky is the same for all.
          {"sky", IsFirstSeed(comparison, cell) ? SkyData(cell.sky) : Json(Json::array())}};
}

Json FigureData(const Figure& figure) {
  const char* ideal = figure.ideal == Ideal::kLow      ? "low"
                      : figure.ideal == Ideal::kTarget ? "target"
                                                       : "none";
  return {{"key", figure.key}, {"label", figure.label},   {"unit", figure.unit},
          {"ideal", ideal},    {"target", figure.target}, {"decimals", figure.decimals}};
}

Json AggregateData(const AggregateRow& row) {
  Json means = Json::array();
  Json errors = Json::array();
  Json best = Json::array();
  for (size_t i = 0; i < row.figures.size(); ++i) {
    means.push_back(Rounded(row.figures[i].mean, 6));
    errors.push_back(Rounded(row.figures[i].standard_error, 3));
    best.push_back(row.best[i] ? 1 : 0);
  }
  return {{"estimator", row.label},
          {"backend", row.backend},
          {"sequence", row.sequence},
          {"cells", row.cells},
          {"ok", row.ok},
          {"diverged", row.diverged},
          {"not_initialized", row.not_initialized},
          {"failed", row.failed},
          {"nees_verdict", row.nees_verdict},
          {"nees_inside", Rounded(row.nees_inside_share, 4)},
          {"means", means},
          {"errors", errors},
          {"best", best}};
}

/// Of each pair: [sequence, figure, first, second (indices), pairs, lost, difference, half of its interval,
/// verdict on the first: -1 better or lower, 1 worse or higher, 0 no difference, null too few]; sequence -1
/// is all of them.
Json PairData(const Comparison& comparison, const std::vector<Figure>& figures,
              const std::vector<AggregateRow>& rows) {
  const std::vector<std::string> sequences = ListSequences(rows);
  const std::vector<std::string> labels = ListLabels(rows);
  const auto place = [](const std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
  };
  Json list = Json::array();
  for (const PairedDifference& pair : ComparePairs(comparison, figures)) {
    const PairedT& test = pair.difference;
    if (pair.verdict == PairVerdict::kTooFew) {
      continue;
    }
    const int verdict = pair.verdict == PairVerdict::kNoDifference ? 0 : test.mean < 0 ? -1 : 1;
    list.push_back({place(sequences, pair.sequence), pair.figure, place(labels, pair.first),
                    place(labels, pair.second), test.count, pair.only_first + pair.only_second + pair.neither,
                    Rounded(test.mean, 4), Rounded(0.5 * (test.high - test.low), 3), verdict});
  }
  return list;
}

/// `ratios`: bound over achieved, orientation and position each, as the page's headings.
Json EfficiencyData(const Comparison& comparison) {
  Json list = Json::array();
  for (const Efficiency& entry : ComputeEfficiency(comparison)) {
    Json ratios = Json::array();
    for (const Ratio& ratio : {entry.achieved, entry.smoothed, entry.filtered}) {
      ratios.push_back(Rounded(ratio.ori, 4));
      ratios.push_back(Rounded(ratio.pos, 4));
    }
    list.push_back({{"estimator", entry.label},
                    {"sequence", entry.sequence},
                    {"pairs", entry.pairs},
                    {"ratios", ratios}});
  }
  return list;
}

Json FrontendData(const Comparison& comparison) {
  Json list = Json::array();
  for (const FrontendSummary& front : comparison.frontends) {
    list.push_back({{"sequence", front.sequence},
                    {"seed", front.seed},
                    {"images", front.images},
                    {"features", Rounded(front.features_per_frame, 4)},
                    {"mean_length", Rounded(front.mean_length, 4)},
                    {"median_length", Rounded(front.median_length, 4)},
                    {"lost", Rounded(100 * front.lost_share, 4)},
                    {"rejected", Rounded(100 * front.rejected_share, 4)},
                    {"thinned", Rounded(100 * front.thinned_share, 4)},
                    {"mean_ms", Rounded(front.mean_ms, 4)},
                    {"p95_ms", Rounded(front.p95_ms, 4)}});
  }
  return list;
}

Json NeesData(const Comparison& comparison, int most) {
  Json list = Json::array();
  for (const NeesCurve& curve : AverageNees(comparison)) {
    const NeesOverTime& average = curve.average;
    if (average.runs.empty() || *std::max_element(average.runs.begin(), average.runs.end()) < 2) {
      continue;  // the run's own series says it
    }
    std::vector<double> times;
    Json mean = Json::array();
    for (const size_t i : KeptRows(average.mean.size(), most)) {
      times.push_back(average.time_s[i]);
      mean.push_back(Rounded(average.mean[i], 3));
    }
    list.push_back({{"estimator", curve.label},
                    {"sequence", curve.sequence},
                    {"t", Packed(times, 1e-3)},
                    {"nees", mean},
                    {"inside", Rounded(average.share_inside, 4)}});
  }
  return list;
}

/// 95 % bands of the mean pose NEES of 1, 2, ... runs.
Json NeesBands(int most_runs) {
  Json bands = Json::array();
  for (int runs = 1; runs <= most_runs; ++runs) {
    const auto [low, high] = NeesBand(6, runs);
    bands.push_back({Rounded(low, 5), Rounded(high, 5)});
  }
  return bands;
}

}  // namespace

int PointsPerSeries(size_t cells, bool audited) {
  // A point of one cell is 22 numbers: measured at 65 to 80 characters; an audit adds up to 22.
  const double budget = 4.3e6 / ((audited ? 102.0 : 80.0) * static_cast<double>(std::max<size_t>(1, cells)));
  return static_cast<int>(std::clamp(budget, 60.0, 1000.0));
}

PackedColumn PackColumn(const std::vector<double>& values, double finest) {
  double largest = 0;
  for (const double value : values) {
    largest = std::isfinite(value) ? std::max(largest, std::abs(value)) : largest;
  }
  PackedColumn column;
  column.quantum = finest;
  if (largest > 0) {
    const double fine = std::pow(10.0, std::floor(std::log10(largest / 2000)));
    const double coarse = std::pow(10.0, std::ceil(std::log10(largest / 1e15)));
    column.quantum = std::max(std::min(finest, fine), coarse);
  }
  long long last = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) {
      column.deltas.emplace_back(false, 0);
      continue;
    }
    const long long now = std::llround(value / column.quantum);
    column.deltas.emplace_back(true, now - last);
    last = now;
  }
  return column;
}

std::string ReportData(const Comparison& comparison) {
  const std::vector<Figure> figures = ListFigures(comparison);
  const std::vector<AggregateRow> rows = Aggregate(comparison, figures);
  const bool audited = std::any_of(comparison.cells.begin(), comparison.cells.end(),
                                   [](const CellResult& cell) { return !cell.series.rank.empty(); });
  const int most = PointsPerSeries(comparison.cells.size(), audited);
  Json data = {{"title", comparison.title},
               {"command", comparison.command},
               {"points", most},
               {"sequences", ListSequences(rows)},
               {"estimators", ListLabels(rows)}};
  data["figures"] = Json::array();
  for (const Figure& figure : figures) {
    data["figures"].push_back(FigureData(figure));
  }
  data["aggregate"] = Json::array();
  int most_runs = 1;
  for (const AggregateRow& row : rows) {
    data["aggregate"].push_back(AggregateData(row));
    most_runs = std::max(most_runs, row.cells);
  }
  data["nees_bands"] = NeesBands(most_runs);
  data["nees_over_time"] = NeesData(comparison, most);
  data["pairs"] = PairData(comparison, figures, rows);
  data["efficiency"] = EfficiencyData(comparison);
  data["frontends"] = FrontendData(comparison);
  data["references"] = Json::array();
  for (const ReferenceFigure& reference : comparison.references) {
    data["references"].push_back({{"source", reference.source},
                                  {"estimator", reference.estimator},
                                  {"sequence", reference.sequence},
                                  {"figures", reference.figures}});
  }
  data["cells"] = Json::array();
  for (const CellResult& cell : comparison.cells) {
    data["cells"].push_back(CellData(comparison, figures, cell, most));
  }
  std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  // '<' stands only inside strings, where its escape means the same.
  for (size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

}  // namespace alidade
