#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tests/eval/compare/plan_fixture.h"

namespace alidade {
namespace {

using test::PlanTest;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr char kEveryKey[] =
    "title: Both\n"
    "set: {init.method: truth}\n"
    "estimators:\n"
    "  - estimators/a.yaml\n"
    "  - {config: estimators/b.yaml, name: b2, set: {filter.window: 10, x.v: [1, 2, 3]}, "
    "sequences: [loud]}\n"
    "  - {name: other, trajectories: {seq: other.tum}, align: pos, align_share: 0.05, mode: smoothed}\n"
    "sequences:\n"
    "  - {path: '${data}/seq', seeds: [4, 2]}\n"
    "  - {config: sim.yaml, name: loud, seeds: 1..3, set: {pixel_noise_px: 2, hybrid_dataset: "
    "'${data}/seq'}}\n"
    "  - {config: sim.yaml, seeds: 9, estimator_set: {vision.pixel_noise_px: 2}, group: one half, "
    "anchor_at_first: true}\n"
    "audit: true\n"
    "metrics: {align: se3, align_share: 0.5, rpe: [5, 10], max_dt: 0.02, interpolate: true, max_gap: 0.2}\n"
    "pairs: {figures: [ate_pos_m], across_sequences: true}\n"
    "baseline: loud\n"
    "reference:\n"
    "  - {source: the paper, estimator: a, sequence: sim, figures: {ate_pos_m: 0.1}}\n";

TEST_F(PlanTest, ReadsEveryKeyOfAnEstimator) {
  const Result<Plan> plan = Read(kEveryKey, folder_.File("data"));
  ASSERT_TRUE(plan.ok()) << plan.message();
  ASSERT_EQ(plan->estimators.size(), 3u);
  EXPECT_EQ(plan->estimators[0].name, "a");
  EXPECT_EQ(plan->estimators[0].config, folder_.File("estimators/a.yaml"));
  EXPECT_THAT(plan->estimators[1].settings, ElementsAre("filter.window=10", "x.v=[1, 2, 3]"));
  EXPECT_TRUE(plan->estimators[0].RunsOn("sim"));
  EXPECT_TRUE(plan->estimators[1].RunsOn("loud"));
  EXPECT_FALSE(plan->estimators[1].RunsOn("sim"));
  EXPECT_TRUE(plan->estimators[2].external());
  EXPECT_FALSE(plan->estimators[2].RunsOn("sim"));
  EXPECT_TRUE(plan->estimators[2].smoothed);
  EXPECT_FALSE(plan->estimators[1].smoothed);
  EXPECT_EQ(plan->estimators[2].trajectories.at("seq"), folder_.File("other.tum"));
}

TEST_F(PlanTest, ReadsEveryKeyOfASequence) {
  const Result<Plan> plan = Read(kEveryKey, folder_.File("data"));
  ASSERT_TRUE(plan.ok()) << plan.message();
  ASSERT_EQ(plan->sequences.size(), 3u);
  EXPECT_THAT(plan->sequences[2].estimator_settings, ElementsAre("vision.pixel_noise_px=2"));
  EXPECT_EQ(plan->sequences[0].name, "seq");
  EXPECT_THAT(plan->sequences[0].seeds, ElementsAre(4, 2));
  EXPECT_EQ(plan->sequences[1].name, "loud");
  EXPECT_THAT(plan->sequences[1].seeds, ElementsAre(1, 2, 3));
  EXPECT_THAT(plan->sequences[1].settings,
              ElementsAre("pixel_noise_px=2", "hybrid_dataset=" + folder_.File("data") + "/seq"));
  EXPECT_THAT(plan->sequences[2].seeds, ElementsAre(9));
  EXPECT_EQ(plan->sequences[2].group, "one half");
}

TEST_F(PlanTest, ReadsEveryKeyOfThePlanAndItsMetrics) {
  const Result<Plan> plan = Read(kEveryKey, folder_.File("data"));
  ASSERT_TRUE(plan.ok()) << plan.message();
  EXPECT_EQ(plan->title, "Both");
  EXPECT_THAT(plan->settings, ElementsAre("init.method=truth"));
  EXPECT_THAT(plan->pair_figures, ElementsAre("ate_pos_m"));
  EXPECT_TRUE(plan->pair_across);
  EXPECT_EQ(plan->baseline, "loud");
  EXPECT_TRUE(plan->audit);
  EXPECT_EQ(plan->metrics.alignment, TrajectoryAlignment::kSe3);
  EXPECT_EQ(plan->MetricsOf(plan->estimators[0], plan->sequences[0]).alignment, TrajectoryAlignment::kSe3);
  EXPECT_EQ(plan->MetricsOf(plan->estimators[0], plan->sequences[0]).align_share, 0.5);
  EXPECT_EQ(plan->MetricsOf(plan->estimators[2], plan->sequences[0]).alignment, TrajectoryAlignment::kPos);
  EXPECT_EQ(plan->MetricsOf(plan->estimators[2], plan->sequences[0]).align_share, 0.05);
  EXPECT_TRUE(plan->MetricsOf(plan->estimators[0], plan->sequences[2]).anchor_at_first);
  EXPECT_FALSE(plan->MetricsOf(plan->estimators[0], plan->sequences[0]).anchor_at_first);
  EXPECT_THAT(plan->metrics.rpe_distances_m, ElementsAre(5, 10));
  EXPECT_EQ(plan->metrics.association.max_dt_s, 0.02);
  EXPECT_EQ(plan->interpolate, true);
  EXPECT_EQ(plan->metrics.association.max_gap_s, 0.2);
  ASSERT_EQ(plan->references.size(), 1u);
  EXPECT_EQ(plan->references[0].figures.at("ate_pos_m"), 0.1);
}

// GIVEN nothing else THEN the truth of a simulation is interpolated at the frames, which need not fall on its
// rows.
TEST_F(PlanTest, TheTruthOfASimulationIsInterpolated) {
  const std::string data = "  - {path: '${data}/seq'}\n";
  const auto interpolates = [&](const std::string& metrics, size_t sequence) {
    const Result<Plan> plan = Read(test::kMinimalPlan + data + metrics, folder_.File("data"));
    EXPECT_TRUE(plan.ok()) << plan.message();
    return plan->MetricsOf(plan->estimators[0], plan->sequences[sequence]).association.interpolate;
  };
  EXPECT_TRUE(interpolates("", 0));
  EXPECT_FALSE(interpolates("", 1));
  EXPECT_FALSE(interpolates("metrics: {interpolate: false}\n", 0));
  EXPECT_FALSE(interpolates("metrics: {association: evo}\n", 0));
  EXPECT_TRUE(interpolates("metrics: {interpolate: true}\n", 1));
}

TEST_F(PlanTest, FillsTitleAndSeedWhenTheyAreLeftOut) {
  const Result<Plan> plan = Read(test::kMinimalPlan);
  ASSERT_TRUE(plan.ok()) << plan.message();
  EXPECT_EQ(plan->title, "plan");
  EXPECT_THAT(plan->sequences[0].seeds, ElementsAre(1));
}

const std::string kSequences = "sequences: [{config: sim.yaml}]\n";
const std::string kEstimators = "estimators: [estimators/a.yaml]\n";

struct PlanFault {
  std::string text;
  std::string expected;  ///< in the message
};
const std::vector<PlanFault> kFaults = {
    {"", "empty"},
    {"- a\n", "expected keys and values"},
    {"estimators: [\n", "not valid YAML"},
    {kEstimators, "sequences: missing"},
    {kSequences, "estimators: missing"},
    {kSequences + "estimators: []\n", "at least one entry"},
    {kSequences + kEstimators + "metrix: {}\n",
     "plan.yaml:3:1: metrix: unknown key in a plan; did you mean 'metrics'"},
    {kSequences + kEstimators + "title: x\ntitle: y\n", "duplicate"},
    {kSequences + "estimators: [estimators/none.yaml]\n", "a file that exists"},
    {kSequences + "estimators: [{name: x}]\n", "one of `config`, `trajectories` and `command`"},
    {kSequences + "estimators: [{config: estimators/a.yaml, name: a/b}]\n", "letters, digits"},
    {kSequences + "estimators: [{config: estimators/a.yaml, name: ..}]\n", "letters, digits"},
    {kSequences + "estimators: [estimators/a.yaml, {config: estimators/b.yaml, name: a}]\n", "is taken"},
    {kSequences + "estimators: [{name: o, trajectories: {sin: other.tum}}]\n",
     "no such sequence; did you mean 'sim'"},
    {kSequences + "estimators:\n  - {name: o, trajectories: {sim: other.tum}, mode: online}\n",
     "plan.yaml:3:53: mode: found 'online', expected causal or smoothed"},
    {kSequences + "estimators: [{name: o, trajectories: {sim: other.tum}, frame: [body]}]\n",
     "body or camera"},
    {kSequences + "estimators: [{config: estimators/a.yaml, mode: causal}]\n",
     "mode: found 'causal', expected `trajectories` or `command` beside it"},
    {kEstimators + "sequences: [{config: sim.yaml, path: data/seq}]\n", "either `path`"},
    {kEstimators + "sequences: [{path: data/seq, set: {a: 1}}]\n", "`set` only with `config`"},
    {kEstimators + "sequences: [{path: '${data}/seq'}]\n", "--data=FOLDER"},
    {kEstimators + "sequences: [{config: sim.yaml, anchor_at_first: perhaps}]\n", "anchor_at_first: found"},
    {kEstimators + "sequences: [{config: sim.yaml, group: [a]}]\n", "group: found"},
    {kEstimators + "sequences: [{config: sim.yaml, seeds: 3..1}]\n", "FIRST <= LAST"},
    {kEstimators + "sequences: [{config: sim.yaml, seeds: [1, 1]}]\n", "every seed once"},
    {kEstimators + "sequences: [{config: sim.yaml, seeds: -1}]\n", "from 0 to"},
    {kEstimators + "sequences: [{config: sim.yaml, seeds: 1.5}]\n", "whole number"},
    {kEstimators + "sequences: [{config: sim.yaml, seeds: 0..4000000000}]\n", "at most 1000"},
    {kEstimators + "sequences: [{config: sim.yaml, seeds: [010]}]\n", "whole number"},
    {kSequences + kEstimators + "metrics: {align: yaw}\n", "posyaw"},
    {kSequences + kEstimators + "metrics: {rpe: [0]}\n", "rpe: found"},
    {kSequences + kEstimators + "metrics: {max_dt: .nan}\n", "max_dt: found"},
    {kSequences + kEstimators + "metrics: {association: tum}\n", "alidade, evo or rpg"},
    {kSequences + kEstimators + "metrics: {association: evo, interpolate: true}\n",
     "which alone interpolates"},
    {kSequences + kEstimators + "metrics: {interpolate: maybe}\n", "interpolate: found"},
    {kSequences + kEstimators + "pairs: {figures: [rmse_pos]}\n", "did you mean 'rmse_pos_m'"},
    {kSequences + kEstimators + "pairs: {figures: [backend_ms]}\n", "not a time"},
    {kSequences + "estimators: [{config: estimators/a.yaml, sequences: [sin]}]\n",
     "no such sequence; did you mean 'sim'"},
    {kSequences + kEstimators + "baseline: sin\n", "no such sequence; did you mean 'sim'"},
    {kSequences + kEstimators + "reference: [{source: x}]\n", "missing in reference"}};

TEST_F(PlanTest, NamesPlaceAndExpectationOfEveryFault) {
  for (const auto& [text, expected] : kFaults) {
    const Result<Plan> plan = Read(text);
    EXPECT_EQ(plan.code(), StatusCode::kConfig) << text;
    EXPECT_THAT(plan.message(), HasSubstr(expected)) << text;
    EXPECT_THAT(plan.message(), HasSubstr("plan.yaml")) << text;
  }
}

// GIVEN a plan in a folder of its sequence WHEN it is read from there THEN the name is that of the folder to
// which ".." leads: as a name, ".." would be the folder of all cells.
TEST_F(PlanTest, ANameThatFollowsFromAPathIsTheNameOfAFolder) {
  folder_.Write("data/seq/plans/plan.yaml",
                "estimators: [../../../estimators/a.yaml]\nsequences: [{path: ..}]\n");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder_.File("data/seq/plans"));
  const Result<Plan> plan = ReadPlan("plan.yaml", "");
  std::filesystem::current_path(before);
  ASSERT_TRUE(plan.ok()) << plan.message();
  EXPECT_EQ(plan->sequences[0].name, "seq");

  folder_.Write("data/my walk/mav0/x", "");
  folder_.Write("estimators/a b.yaml", "name: a\n");
  const std::string estimators = "estimators: [estimators/a.yaml]\n";
  EXPECT_EQ(Read(estimators + "sequences: [{path: data/seq/}]\n")->sequences[0].name, "seq");
  const Result<Plan> spaced = Read(estimators + "sequences:\n  - {path: data/my walk}\n");
  EXPECT_EQ(spaced.code(), StatusCode::kConfig);
  EXPECT_THAT(spaced.message(),
              HasSubstr("plan.yaml:3:5: sequences: found the group {path: data/my walk}, expected a "
                        "`name` beside it: 'my walk', which follows from the path"));
  EXPECT_TRUE(Read(estimators + "sequences: [{path: data/my walk, name: walk}]\n").ok());
  EXPECT_THAT(Read("estimators: [estimators/a b.yaml]\nsequences: [{config: sim.yaml}]\n").message(),
              HasSubstr("plan.yaml:1:14: estimators: found 'estimators/a b.yaml', expected a `name`"));
}

TEST_F(PlanTest, MissingFileIsAConfigurationFault) {
  EXPECT_EQ(ReadPlan(folder_.File("none.yaml"), "").code(), StatusCode::kConfig);
}

}  // namespace
}  // namespace alidade
