// The plans of configs/plans.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "core/estimator_config.h"
#include "eval/compare/plan.h"
#include "eval/compare/plan_parser.h"
#include "eval/config/config_yaml.h"
#include "eval/simulation/simulator_config.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// The shipped plans of published data read without any of it, and name what they would need.
TEST(PublishedPlans, NameTheDataTheyNeed) {
  const test::TemporaryFolder folder;
  for (const char* name : {"euroc", "tumvi", "gvins", "arena_gnss"}) {
    const std::string path = std::string(ALIDADE_SOURCE_DIR) + "/configs/plans/" + name + ".yaml";
    EXPECT_EQ(ReadPlan(path, "").code(), StatusCode::kConfig) << name;
    const Result<Plan> none = ReadPlan(path, folder.path());
    EXPECT_EQ(none.code(), StatusCode::kInput) << name << ": " << none.message();
    EXPECT_THAT(none.message(), HasSubstr("is present; the first, ")) << name;
  }
  folder.Write("V1_02_medium/mav0/x", "");
  const Result<Plan> one =
      ReadPlan(std::string(ALIDADE_SOURCE_DIR) + "/configs/plans/euroc.yaml", folder.path());
  ASSERT_TRUE(one.ok()) << one.message();
  EXPECT_EQ(one->sequences.size(), 1u);
  EXPECT_EQ(one->absent.size(), 10u);
  EXPECT_EQ(one->references.size(), 55u);
}

// GIVEN the shipped plan of regimes THEN every regime is valid, belongs to one of two halves of about equal
// size, and gives its estimators its pixel noise.
TEST(RegimePlan, IsValidAndGivenToTheEstimators) {
  const Result<Plan> plan = ReadPlan(std::string(ALIDADE_SOURCE_DIR) + "/configs/plans/regimes.yaml", "");
  ASSERT_TRUE(plan.ok()) << plan.message();
  EXPECT_GE(plan->sequences.size(), 24u);
  std::map<std::string, std::size_t> halves;
  for (const PlanSequence& sequence : plan->sequences) {
    ++halves[sequence.group];
    EXPECT_THAT(sequence.seeds, ElementsAre(501, 502, 503, 504, 505, 506, 507, 508)) << sequence.name;
    const Result<SimulatorConfig> simulation = LoadSimulatorConfig(sequence.config, sequence.settings);
    ASSERT_TRUE(simulation.ok()) << sequence.name << ": " << simulation.message();
    EXPECT_GE(simulation->duration_s, 60) << sequence.name;
    EXPECT_GT(simulation->max_range_m, simulation->landmark_max_distance_m) << sequence.name;
    EstimatorConfig estimator;
    const auto describe = [&estimator](ConfigVisitor& visitor) { estimator.Describe(visitor); };
    ASSERT_TRUE(ApplySettings(sequence.estimator_settings, describe).ok()) << sequence.name;
    EXPECT_EQ(estimator.vision.pixel_noise_px, simulation->pixel_noise_px) << sequence.name;
  }
  ASSERT_EQ(halves.size(), 2u);
  EXPECT_LE(std::max(halves.begin()->second, halves.rbegin()->second), 17u);
}

}  // namespace
}  // namespace alidade
