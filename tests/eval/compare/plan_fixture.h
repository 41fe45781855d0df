#pragma once

#include <gtest/gtest.h>

#include <string>

#include "eval/compare/plan.h"
#include "eval/compare/plan_parser.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {

/// A folder with the files that plans name: estimators, a simulation, a dataset `seq` and a trajectory.
class PlanTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_.Write("estimators/a.yaml", "name: a\n");
    folder_.Write("estimators/b.yaml", "name: b\n");
    folder_.Write("sim.yaml", "name: s\n");
    folder_.Write("data/seq/mav0/x", "");
    folder_.Write("other.tum", "");
  }
  Result<Plan> Read(const std::string& text, const std::string& data_root = "") {
    return ReadPlan(folder_.Write("plan.yaml", text), data_root);
  }
  test::TemporaryFolder folder_;
};

inline constexpr char kMinimalPlan[] = "estimators: [estimators/a.yaml]\nsequences:\n  - config: sim.yaml\n";

}  // namespace alidade::test
