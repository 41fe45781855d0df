#include "eval/report/report_data.h"

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/numbers.h"
#include "eval/comparison/aggregate.h"
#include "eval/comparison/cell_group.h"
#include "eval/comparison/nees_over_time.h"
#include "eval/comparison/paired.h"
#include "eval/metrics/nees.h"
#include "eval/report/heat_map.h"
#include "eval/report/report_json.h"
#include "eval/report/report_rows.h"
#include "eval/report/report_series.h"

namespace alidade {
namespace {

Json FigureValues(const std::vector<Figure>& figures, const CellResult& cell) {
  Json values = Json::array();
  for (const Figure& figure : figures) {
    values.push_back(RoundedJson(figure.value(cell), 6));
  }
  return values;
}

/// Cells whose sky the page holds: of each estimator's first seed, since it is the same for all; of a large
/// comparison one a sequence, for its size.
std::set<const CellResult*> CellsWithSky(const Comparison& comparison,
                                         const std::vector<std::string>& labels) {
  constexpr size_t kMostSkies = 12;
  std::map<std::pair<std::string, std::string>, const CellResult*> by_estimator, by_sequence;
  for (size_t i = 0; i < labels.size(); ++i) {
    const CellResult& cell = comparison.cells[i];
    if (!cell.sky.empty()) {
      const CellResult*& kept = by_estimator[{cell.sequence, labels[i]}];
      kept = kept == nullptr || cell.seed < kept->seed ? &cell : kept;
      by_sequence.try_emplace({cell.sequence, ""}, &cell);
    }
  }
  std::set<const CellResult*> cells;
  for (const auto& [name, cell] : by_estimator.size() > kMostSkies ? by_sequence : by_estimator) {
    cells.insert(cell);
  }
  return cells;
}

Json InnovationJson(const InnovationSummary& of) {
  const std::pair<double, double> band = of.band.value_or(std::pair(kNan, kNan));
  return RoundedJson({of.ratio.value_or(kNan), of.inside.value_or(kNan), band.first, band.second}, 4);
}

/// What the tables and box plots need of a run.
Json CellData(const std::string& label, const std::vector<Figure>& figures, const CellResult& cell) {
  Json rpe = Json::array();
  for (const RpeResult& result : cell.rpe) {
    rpe.push_back({{"d", result.distance_m},
                   {"n", result.count},
                   {"q", RoundedJson(BoxQuantiles(result.pos_errors_m), 4)}});
  }
  Json sensors = Json::object();
  for (const auto& [key, innovations] : cell.sensor_innovations) {
    sensors[key] = InnovationJson(innovations);
  }
  return {{"estimator", label},
          {"mode", ModeWord(cell.smoothed)},
          {"sequence", cell.sequence},
          {"seed", cell.seed},
          {"status", cell.status},
          {"message", cell.message},
          {"digest", cell.input_digest},
          {"frames", cell.frames},
          {"duration", RoundedJson(cell.duration_s.value_or(kNan), 6)},
          {"path", RoundedJson(cell.path_m.value_or(kNan), 6)},
          {"align", cell.align},
          {"figures", FigureValues(figures, cell)},
          {"stages", RoundedJson({cell.frontend_ms.value_or(kNan), cell.propagate_ms.value_or(kNan),
                                  cell.update_ms.value_or(kNan), cell.backend_ms.value_or(kNan)},
                                 4)},
          {"nis", InnovationJson(cell.innovations)},
          {"sensor_nis", sensors},
          {"rpe", rpe}};
}

/// Of each pair: [sequence, figure, first, second (indices), pairs, lost, difference, half of its interval,
/// verdict on the first: -1 better or lower, 1 worse or higher, 0 no difference; p-value; that by Holm];
/// sequence -1 is all of them. Pairs that are too few for a verdict are left out.
Json PairData(const Comparison& comparison, const std::vector<Figure>& figures,
              const std::vector<AggregateRow>& rows) {
  const std::vector<std::string> sequences = ListSequences(rows);
  const std::vector<std::string> labels = ListLabels(rows);
  const auto place = [](const std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
  };
  Json list = Json::array();
  std::vector<PairedDifference> pairs = ComparePairs(comparison, figures);
  if (!comparison.pair_across && sequences.size() > 1) {  // for the column of means
    const std::vector<PairedDifference> across = PoolSequences(pairs, figures);
    pairs.insert(pairs.end(), across.begin(), across.end());
  }
  for (const PairedDifference& pair : pairs) {
    const PairedT& test = pair.difference;
    if (pair.verdict == PairVerdict::kTooFew) {
      continue;
    }
    const int verdict = pair.verdict == PairVerdict::kNoDifference ? 0 : test.mean < 0 ? -1 : 1;
    list.push_back({place(sequences, pair.sequence), pair.figure, place(labels, pair.first),
                    place(labels, pair.second), test.count, pair.only_first + pair.only_second + pair.neither,
                    RoundedJson(test.mean, 4), RoundedJson(0.5 * (test.high - test.low), 3), verdict,
                    RoundedJson(test.p_value, 2), RoundedJson(pair.holm_p_value, 2)});
  }
  return list;
}

Json NeesData(const Comparison& comparison, int most) {
  Json list = Json::array();
  for (const NeesCurve& curve : AverageNees(comparison)) {
    const NeesOverTime& average = curve.average;
    if (average.runs.empty() || *std::max_element(average.runs.begin(), average.runs.end()) < 2) {
      continue;  // the run's own series has it
    }
    std::vector<double> times;
    Json mean = Json::array();
    const size_t step = average.mean.size() / static_cast<size_t>(most) + 1;
    for (size_t i = 0; i < average.mean.size(); i += step) {
      times.push_back(average.time_s[i]);
      mean.push_back(RoundedJson(average.mean[i], 3));
    }
    list.push_back({{"estimator", curve.label},
                    {"sequence", curve.sequence},
                    {"t", PackedJson(times, 1e-3)},
                    {"nees", mean},
                    {"inside", RoundedJson(average.share_inside, 4)}});
  }
  return list;
}

/// 95 % bands of the mean pose NEES of 1, 2, ... runs.
Json NeesBands(int most_runs) {
  Json bands = Json::array();
  for (int runs = 1; runs <= most_runs; ++runs) {
    const auto [low, high] = NeesBand(6, runs);
    bands.push_back({RoundedJson(low, 5), RoundedJson(high, 5)});
  }
  return bands;
}

/// All but what the plots alone need.
Json TablesData(const Comparison& comparison, const std::vector<Figure>& figures,
                const std::vector<AggregateRow>& rows) {
  Json data = {{"title", comparison.title},
               {"command", comparison.command},
               {"version", comparison.provenance.version},
               {"date", comparison.provenance.date},
               {"machine",
                {{"cpu", comparison.provenance.machine.cpu}, {"cores", comparison.provenance.machine.cores}}},
               {"shown_note", comparison.shown_note},
               {"not_run", comparison.notes},
               {"truth_covariance", comparison.SequencesWithTruthCovariance()},
               {"sequences", ListSequences(rows)},
               {"estimators", ListLabels(rows)}};
  data["sensors"] = Json::array({{{"key", ToString(Sensor::kGnss)}, {"name", "GNSS"}}});
  ForEachSensorEntry([&](auto entry, Sensor) {
    data["sensors"].push_back({{"key", entry.kKey}, {"name", entry.kPluralName}});
  });
  data["figures"] = Json::array();
  for (const Figure& figure : figures) {
    data["figures"].push_back(FigureJson(figure));
  }
  data["aggregate"] = Json::array();
  for (const AggregateRow& row : rows) {
    data["aggregate"].push_back(AggregateJson(row));
  }
  data["pairs"] = PairData(comparison, figures, rows);
  data["efficiency"] = EfficiencyJson(comparison);
  data["frontends"] = FrontendJson(comparison);
  data["references"] = Json::array();
  for (const ReferenceFigure& reference : comparison.references) {
    data["references"].push_back({{"source", reference.source},
                                  {"estimator", reference.estimator},
                                  {"sequence", reference.sequence},
                                  {"figures", reference.figures}});
  }
  data["cells"] = Json::array();
  const std::vector<std::string> labels = LabelsOf(comparison);
  for (size_t i = 0; i < labels.size(); ++i) {
    if (comparison.cells[i].shown) {
      data["cells"].push_back(CellData(labels[i], figures, comparison.cells[i]));
    }
  }
  return data;
}

}  // namespace

std::string ReportJson(const Comparison& comparison) {
  const std::vector<Figure> figures = ListFigures(comparison);
  return TablesData(comparison, figures, Aggregate(comparison, figures))
             .dump(1, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

std::string ReportData(const Comparison& comparison) {
  const std::vector<Figure> figures = ListFigures(comparison);
  const std::vector<AggregateRow> rows = Aggregate(comparison, figures);
  const bool audited = std::any_of(comparison.cells.begin(), comparison.cells.end(),
                                   [](const CellResult& cell) { return !cell.series.rank.empty(); });
  const auto shown = std::count_if(comparison.cells.begin(), comparison.cells.end(),
                                   [](const CellResult& c) { return c.shown; });
  const int most = PointsPerSeries(static_cast<size_t>(shown), audited);
  Json data = TablesData(comparison, figures, rows);
  data["points"] = most;
  data["maps"] = HeatMapsJson(MakeHeatMaps(rows, figures));
  int most_runs = 1;
  for (const AggregateRow& row : rows) {
    most_runs = std::max(most_runs, row.cells);
  }
  data["nees_bands"] = NeesBands(most_runs);
  data["nees_over_time"] = NeesData(comparison, most);
  const std::set<const CellResult*> with_sky = CellsWithSky(comparison, LabelsOf(comparison));
  size_t place = 0;
  for (const CellResult& cell : comparison.cells) {
    if (cell.shown) {
      Json& entry = data["cells"][place++];
      entry["series"] = SeriesJson(cell.series, most);
      entry["sky"] = with_sky.count(&cell) > 0 ? SkyJson(cell.sky) : Json(Json::array());
    }
  }
  std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  // '<' stands only inside strings, where its escape means the same.
  for (size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

}  // namespace alidade
