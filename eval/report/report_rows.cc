#include "eval/report/report_rows.h"

#include "eval/comparison/efficiency.h"
#include "eval/report/report_json.h"

namespace alidade {

Json FigureJson(const Figure& figure) {
  const char* ideal = figure.ideal == Ideal::kLow      ? "low"
                      : figure.ideal == Ideal::kTarget ? "target"
                                                       : "none";
  return {{"key", figure.key},
          {"label", figure.label},
          {"unit", figure.unit},
          {"ideal", ideal},
          {"target", figure.target},
          {"decimals", figure.decimals},
          {"all_runs", figure.of_all_runs}};
}

Json AggregateJson(const AggregateRow& row) {
  Json means = Json::array();
  Json errors = Json::array();
  Json best = Json::array();
  for (size_t i = 0; i < row.figures.size(); ++i) {
    means.push_back(RoundedJson(row.figures[i].mean, 6));
    errors.push_back(RoundedJson(row.figures[i].standard_error, 3));
    best.push_back(row.best[i] ? 1 : 0);
  }
  return {{"estimator", row.label},
          {"backend", row.backend},
          {"mode", ModeWord(row.smoothed)},
          {"sequence", row.sequence},
          {"cells", row.cells},
          {"ok", row.ok},
          {"diverged", row.diverged},
          {"not_initialized", row.not_initialized},
          {"failed", row.failed},
          {"nees_verdict", row.nees_verdict},
          {"nees_inside", RoundedJson(row.nees_inside_share, 4)},
          {"group", row.group},
          {"rmse_to_best", RoundedJson({row.rmse_pos_to_best, row.rmse_ori_to_best}, 4)},
          {"means", means},
          {"errors", errors},
          {"best", best}};
}

Json EfficiencyJson(const Comparison& comparison) {
  Json list = Json::array();
  for (const Efficiency& entry : ComputeEfficiency(comparison)) {
    Json ratios = Json::array();
    for (const Ratio& ratio : {entry.achieved, entry.smoothed, entry.filtered}) {
      ratios.push_back(RoundedJson(ratio.ori, 4));
      ratios.push_back(RoundedJson(ratio.pos, 4));
    }
    list.push_back({{"estimator", entry.label},
                    {"sequence", entry.sequence},
                    {"pairs", entry.pairs},
                    {"ratios", ratios}});
  }
  return list;
}

Json FrontendJson(const Comparison& comparison) {
  Json list = Json::array();
  for (const FrontendSummary& front : comparison.frontends) {
    list.push_back({{"sequence", front.sequence},
                    {"seed", front.seed},
                    {"images", front.images},
                    {"features", RoundedJson(front.features_per_frame, 4)},
                    {"mean_length", RoundedJson(front.mean_length, 4)},
                    {"median_length", RoundedJson(front.median_length, 4)},
                    {"lost", RoundedJson(100 * front.lost_share, 4)},
                    {"rejected", RoundedJson(100 * front.rejected_share, 4)},
                    {"thinned", RoundedJson(100 * front.thinned_share, 4)},
                    {"mean_ms", RoundedJson(front.mean_ms, 4)},
                    {"p95_ms", RoundedJson(front.p95_ms, 4)}});
  }
  return list;
}

}  // namespace alidade
