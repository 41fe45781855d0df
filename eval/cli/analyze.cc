#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/format.h"
#include "core/numbers.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/split_words.h"
#include "eval/cli/support.h"
#include "eval/config/config_yaml.h"
#include "eval/study/reuse_study.h"

namespace alidade::cli {
namespace {

/// "5,10,25" -> numbers.
Result<std::vector<int>> Windows() {
  std::vector<int> windows;
  for (const std::string& word : SplitWords(FLAGS_windows)) {
    char* end = nullptr;
    const long value = std::strtol(word.c_str(), &end, 10);
    if (*end != '\0' || value < 3 || value > 200) {
      return Status::Usage("analyze: --windows: found '" + word + "', expected numbers from 3 to 200");
    }
    windows.push_back(static_cast<int>(value));
  }
  if (windows.empty()) {
    return Status::Usage("analyze: --windows: found none, expected numbers from 3 to 200");
  }
  return windows;
}

/// One row a policy, one column a window.
using Table = std::vector<std::vector<ReusePrediction>>;

void PrintTable(const char* title, const std::vector<int>& windows, const Table& table,
                double (*figure)(const ReusePrediction&)) {
  std::printf("\n%s\n\n| policy |", title);
  for (const int window : windows) {
    std::printf(" %d clones |", window);
  }
  std::printf("\n|---|%s\n",
              [&] {
                std::string rule;
                for (size_t i = 0; i < windows.size(); ++i) {
                  rule += "---:|";
                }
                return rule;
              }()
                  .c_str());
  for (size_t row = 0; row < table.size(); ++row) {
    std::printf("| %s: %s |", ReusePolicies()[row].name.c_str(), ReusePolicies()[row].what.c_str());
    for (const ReusePrediction& prediction : table[row]) {
      std::printf(" %.3f |", figure(prediction));
    }
    std::printf("\n");
  }
}

void PrintJson(const std::vector<int>& windows, const Table& table) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (size_t row = 0; row < table.size(); ++row) {
    for (size_t column = 0; column < windows.size(); ++column) {
      const ReusePrediction& prediction = table[row][column];
      rows.push_back({{"policy", ReusePolicies()[row].name},
                      {"window", windows[column]},
                      {"nees_ratio", prediction.nees_ratio},
                      {"rmse_pos_m", prediction.position_m},
                      {"rmse_ori_deg", prediction.orientation_rad * kDegreesPerRadian}});
    }
  }
  std::printf("%s\n", rows.dump(2).c_str());
}

Result<Table> Predict(const SimulatorConfig& simulation, const EstimatorConfig& estimator,
                      const std::vector<int>& windows) {
  Table table;
  ProgressLine progress("analyses");
  const size_t total = ReusePolicies().size() * windows.size();
  for (const ReusePolicy& policy : ReusePolicies()) {
    table.emplace_back();
    for (const int window : windows) {
      const Result<ReusePrediction> prediction =
          PredictConsistency(simulation, estimator, policy, window, FLAGS_seed);
      if (!prediction.ok()) {
        return Status(prediction.code(), "policy " + policy.name + ", window " + std::to_string(window) +
                                             ": " + prediction.message());
      }
      table.back().push_back(*prediction);
      progress.Update((table.size() - 1) * windows.size() + table.back().size(), total);
    }
  }
  return table;
}

}  // namespace

int RunAnalyze(const std::vector<std::string>&) {
  const Result<std::vector<int>> windows = Windows();
  if (!windows.ok()) {
    return Report(windows.status());
  }
  const Result<SimulatorConfig> simulation = LoadSimulatorConfig(FLAGS_config, SplitSettings(FLAGS_set));
  if (!simulation.ok()) {
    return Report(simulation.status());
  }
  const Result<EstimatorConfig> estimator = LoadEstimatorConfig(FLAGS_estimator, {});
  if (!estimator.ok()) {
    return Report(estimator.status());
  }
  const Result<Table> table = Predict(*simulation, *estimator, *windows);
  if (!table.ok()) {
    return Report(table.status());
  }
  if (FLAGS_json) {
    PrintJson(*windows, *table);
    return kExitDone;
  }
  PrintTable("Predicted pose NEES over its ideal", *windows, *table,
             [](const ReusePrediction& p) { return p.nees_ratio; });
  PrintTable("Predicted RMSE of position [m]", *windows, *table,
             [](const ReusePrediction& p) { return p.position_m; });
  PrintTable("Predicted RMSE of orientation [deg]", *windows, *table,
             [](const ReusePrediction& p) { return p.orientation_rad * kDegreesPerRadian; });
  return kExitDone;
}

}  // namespace alidade::cli
