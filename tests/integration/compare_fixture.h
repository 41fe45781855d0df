#pragma once

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {

/// Rows of a CSV file without the columns of measured times.
inline std::string WithoutTimes(const std::string& text) {
  std::istringstream lines(text);
  std::vector<bool> keep;
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    size_t column = 0;
    for (std::string field; std::getline(fields, field, ','); ++column) {
      if (result.empty() || keep.size() == column) {
        keep.push_back(field.find("_ms") == std::string::npos && !field.starts_with("realtime_factor"));
      }
      result += keep[column] ? field + "," : "";
    }
    result += "\n";
  }
  return result;
}

/// Two estimators on two seeds of a short simulation, compared by the program.
class CompareCommand : public testing::Test {
 protected:
  void SetUp() override {
    plan_ = folder_.Write("plan.yaml",
                          "set: {init.method: truth}\n"
                          "estimators:\n"
                          "  - " +
                              Source("configs/estimators/alidade_filter.yaml") +
                              "\n"
                              "  - " +
                              Source("configs/estimators/vins_mono_class.yaml") +
                              "\n"
                              "sequences:\n"
                              "  - {config: " +
                              Source("configs/datasets/figure8_short.yaml") +
                              ", name: short, set: {duration_s: 5, path_m: 6.5}, seeds: 1..2}\n"
                              "metrics: {rpe: [1, 2]}\n");
  }
  CommandResult Compare(const std::string& output, const std::string& more = "") const {
    return Alidade("compare --quiet --plan=" + plan_ + " --output=" + folder_.File(output) + " " + more);
  }
  test::TemporaryFolder folder_;
  std::string plan_;
};

}  // namespace alidade::test
