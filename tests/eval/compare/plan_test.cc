#include "eval/compare/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "eval/compare/plan_parser.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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

constexpr char kMinimal[] = "estimators: [estimators/a.yaml]\nsequences:\n  - config: sim.yaml\n";

TEST_F(PlanTest, ReadsEveryKey) {
  const Result<Plan> plan = Read(
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
      "  - {source: the paper, estimator: a, sequence: sim, figures: {ate_pos_m: 0.1}}\n",
      folder_.File("data"));
  ASSERT_TRUE(plan.ok()) << plan.message();
  EXPECT_EQ(plan->title, "Both");
  EXPECT_THAT(plan->settings, ElementsAre("init.method=truth"));
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
  EXPECT_THAT(plan->pair_figures, ElementsAre("ate_pos_m"));
  EXPECT_TRUE(plan->pair_across);
  EXPECT_EQ(plan->baseline, "loud");
  ASSERT_EQ(plan->sequences.size(), 3u);
  EXPECT_THAT(plan->sequences[2].estimator_settings, ElementsAre("vision.pixel_noise_px=2"));
  EXPECT_EQ(plan->sequences[0].name, "seq");
  EXPECT_THAT(plan->sequences[0].seeds, ElementsAre(4, 2));
  EXPECT_EQ(plan->sequences[1].name, "loud");
  EXPECT_THAT(plan->sequences[1].seeds, ElementsAre(1, 2, 3));
  EXPECT_THAT(plan->sequences[1].settings,
              ElementsAre("pixel_noise_px=2", "hybrid_dataset=" + folder_.File("data") + "/seq"));
  EXPECT_THAT(plan->sequences[2].seeds, ElementsAre(9));
  EXPECT_TRUE(plan->audit);
  EXPECT_EQ(plan->metrics.alignment, TrajectoryAlignment::kSe3);
  EXPECT_EQ(plan->MetricsOf(plan->estimators[0], plan->sequences[0]).alignment, TrajectoryAlignment::kSe3);
  EXPECT_EQ(plan->MetricsOf(plan->estimators[0], plan->sequences[0]).align_share, 0.5);
  EXPECT_EQ(plan->MetricsOf(plan->estimators[2], plan->sequences[0]).alignment, TrajectoryAlignment::kPos);
  EXPECT_EQ(plan->MetricsOf(plan->estimators[2], plan->sequences[0]).align_share, 0.05);
  EXPECT_EQ(plan->sequences[2].group, "one half");
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
    const Result<Plan> plan = Read(kMinimal + data + metrics, folder_.File("data"));
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
  const Result<Plan> plan = Read(kMinimal);
  ASSERT_TRUE(plan.ok()) << plan.message();
  EXPECT_EQ(plan->title, "plan");
  EXPECT_THAT(plan->sequences[0].seeds, ElementsAre(1));
}

TEST_F(PlanTest, NamesPlaceAndExpectationOfEveryFault) {
  const std::string sequences = "sequences: [{config: sim.yaml}]\n";
  const std::string estimators = "estimators: [estimators/a.yaml]\n";
  const std::vector<std::pair<std::string, std::string>> faults = {
      {"", "empty"},
      {"- a\n", "expected keys and values"},
      {"estimators: [\n", "not valid YAML"},
      {estimators, "sequences: missing"},
      {sequences, "estimators: missing"},
      {sequences + "estimators: []\n", "at least one entry"},
      {sequences + estimators + "metrix: {}\n",
       "plan.yaml:3:1: metrix: unknown key in a plan; did you mean 'metrics'"},
      {sequences + estimators + "title: x\ntitle: y\n", "duplicate"},
      {sequences + "estimators: [estimators/none.yaml]\n", "a file that exists"},
      {sequences + "estimators: [{name: x}]\n", "one of `config`, `trajectories` and `command`"},
      {sequences + "estimators: [{config: estimators/a.yaml, name: a/b}]\n", "letters, digits"},
      {sequences + "estimators: [{config: estimators/a.yaml, name: ..}]\n", "letters, digits"},
      {sequences + "estimators: [estimators/a.yaml, {config: estimators/b.yaml, name: a}]\n", "is taken"},
      {sequences + "estimators: [{name: o, trajectories: {sin: other.tum}}]\n",
       "no such sequence; did you mean 'sim'"},
      {sequences + "estimators:\n  - {name: o, trajectories: {sim: other.tum}, mode: online}\n",
       "plan.yaml:3:53: mode: found 'online', expected causal or smoothed"},
      {sequences + "estimators: [{name: o, trajectories: {sim: other.tum}, frame: [body]}]\n",
       "body or camera"},
      {sequences + "estimators: [{config: estimators/a.yaml, mode: causal}]\n",
       "mode: found 'causal', expected `trajectories` or `command` beside it"},
      {estimators + "sequences: [{config: sim.yaml, path: data/seq}]\n", "either `path`"},
      {estimators + "sequences: [{path: data/seq, set: {a: 1}}]\n", "`set` only with `config`"},
      {estimators + "sequences: [{path: '${data}/seq'}]\n", "--data=FOLDER"},
      {estimators + "sequences: [{config: sim.yaml, anchor_at_first: perhaps}]\n", "anchor_at_first: found"},
      {estimators + "sequences: [{config: sim.yaml, group: [a]}]\n", "group: found"},
      {estimators + "sequences: [{config: sim.yaml, seeds: 3..1}]\n", "FIRST <= LAST"},
      {estimators + "sequences: [{config: sim.yaml, seeds: [1, 1]}]\n", "every seed once"},
      {estimators + "sequences: [{config: sim.yaml, seeds: -1}]\n", "from 0 to"},
      {estimators + "sequences: [{config: sim.yaml, seeds: 1.5}]\n", "whole number"},
      {estimators + "sequences: [{config: sim.yaml, seeds: 0..4000000000}]\n", "at most 1000"},
      {estimators + "sequences: [{config: sim.yaml, seeds: [010]}]\n", "whole number"},
      {sequences + estimators + "metrics: {align: yaw}\n", "posyaw"},
      {sequences + estimators + "metrics: {rpe: [0]}\n", "rpe: found"},
      {sequences + estimators + "metrics: {max_dt: .nan}\n", "max_dt: found"},
      {sequences + estimators + "metrics: {association: tum}\n", "alidade, evo or rpg"},
      {sequences + estimators + "metrics: {association: evo, interpolate: true}\n",
       "which alone interpolates"},
      {sequences + estimators + "metrics: {interpolate: maybe}\n", "interpolate: found"},
      {sequences + estimators + "pairs: {figures: [rmse_pos]}\n", "did you mean 'rmse_pos_m'"},
      {sequences + estimators + "pairs: {figures: [backend_ms]}\n", "not a time"},
      {sequences + "estimators: [{config: estimators/a.yaml, sequences: [sin]}]\n",
       "no such sequence; did you mean 'sim'"},
      {sequences + estimators + "baseline: sin\n", "no such sequence; did you mean 'sim'"},
      {sequences + estimators + "reference: [{source: x}]\n", "missing in reference"}};
  for (const auto& [text, expected] : faults) {
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

TEST_F(PlanTest, AnExternalProgramIsACommandOrFiles) {
  const Result<Plan> plan = Read(
      "estimators:\n"
      "  - {name: theirs, command: 'run {dataset} {output}', result: out.txt, timeout: 60, frame: camera, "
      "mode: causal}\n"
      "sequences:\n  - config: sim.yaml\n");
  ASSERT_TRUE(plan.ok()) << plan.message();
  const PlanEstimator& theirs = plan->estimators.at(0);
  EXPECT_TRUE(theirs.external());
  EXPECT_EQ(theirs.command.text, "run {dataset} {output}");
  EXPECT_EQ(theirs.command.result, "out.txt");
  EXPECT_EQ(theirs.command.timeout_s, 60);
  EXPECT_TRUE(theirs.camera_frame);
  EXPECT_FALSE(theirs.smoothed);
  for (const char* wrong : {"{name: x, command: a, config: estimators/a.yaml}", "{command: a}",
                            "{name: x, command: a, frame: lens}", "{name: x, command: a, set: {b: 1}}",
                            "{config: estimators/a.yaml, program: other.tum}"}) {
    const Result<Plan> refused =
        Read(std::string("estimators:\n  - ") + wrong + "\nsequences:\n  - config: sim.yaml\n");
    EXPECT_EQ(refused.code(), StatusCode::kConfig) << wrong;
  }
}

TEST_F(PlanTest, AnEstimatorWhoseProgramIsMissingIsListedAsAbsent) {
  const std::string there = "  - {name: there, program: other.tum, command: '{program} {dataset}'}\n";
  const std::string missing = "  - {name: gone, program: build/gone, command: '{program} {dataset}'}\n";
  const std::string rest = "sequences:\n  - config: sim.yaml\n";
  const Result<Plan> plan = Read("estimators:\n" + missing + there + rest);
  ASSERT_TRUE(plan.ok()) << plan.message();
  ASSERT_EQ(plan->estimators.size(), 1u);
  EXPECT_EQ(plan->estimators[0].command.program, folder_.File("other.tum"));
  EXPECT_THAT(plan->absent_programs, ElementsAre(testing::Pair("gone", folder_.File("build/gone"))));
  const Result<Plan> none = Read("estimators:\n" + missing + rest);
  EXPECT_EQ(none.code(), StatusCode::kInput);
  EXPECT_THAT(none.message(), HasSubstr("the program of the first, gone, was expected as"));
}

TEST_F(PlanTest, ABagMayBringItsTopicsAndCalibration) {
  const std::string head =
      "estimators: [estimators/a.yaml]\nskip_missing: true\nsequences:\n  - config: sim.yaml\n";
  const std::string keys = "topics: imu=/imu/data, calibration: ['${data}/a.yaml', b.yaml], camera: cam1";
  folder_.Write("data/walk.bag", "");
  const Result<Plan> plan =
      Read(head + "  - {path: '${data}/walk.bag', " + keys + "}\n", folder_.File("data"));
  ASSERT_TRUE(plan.ok()) << plan.message();
  const PlanSequence& sequence = plan->sequences.at(1);
  EXPECT_EQ(sequence.name, "walk");
  EXPECT_EQ(sequence.dataset.topics, "imu=/imu/data");
  EXPECT_EQ(sequence.dataset.camera, "cam1");
  EXPECT_EQ(sequence.dataset.calibration,
            (std::vector<std::string>{folder_.File("data/a.yaml"), folder_.File("b.yaml")}));
  const Result<Plan> of_folder =
      Read(head + "  - {path: '${data}/seq', " + keys + "}\n", folder_.File("data"));
  EXPECT_EQ(of_folder.code(), StatusCode::kConfig);
  EXPECT_THAT(of_folder.message(), HasSubstr("`path` of a bag"));
}

TEST_F(PlanTest, AFolderMayHaveItsLinksFollowed) {
  const std::string head = "estimators: [estimators/a.yaml]\nskip_missing: true\nsequences:\n";
  const std::string simulation = "  - {config: sim.yaml, seeds: 1}\n";
  const auto read = [&](const std::string& entry) {
    return Read(head + simulation + "  - {" + entry + ", name: linked}\n", folder_.File("data"));
  };
  for (const bool follow : {true, false}) {
    const Result<Plan> plan =
        read("path: '${data}/seq', follow_links: " + std::string(follow ? "true" : "false"));
    ASSERT_TRUE(plan.ok()) << plan.message();
    EXPECT_EQ(plan->sequences.at(1).dataset.follow_links, follow);
  }
  EXPECT_FALSE(read("path: '${data}/seq'")->sequences.at(1).dataset.follow_links);
  folder_.Write("data/walk.bag", "");
  for (const char* other : {"path: '${data}/walk.bag'", "config: sim.yaml"}) {
    const Result<Plan> plan = read(std::string(other) + ", follow_links: true");
    EXPECT_EQ(plan.code(), StatusCode::kConfig) << other;
    EXPECT_THAT(plan.message(), HasSubstr("`follow_links` only with the `path` of a folder"));
  }
}

TEST_F(PlanTest, WhatIsMissingIsLeftOutOnlyWhenThePlanAllowsIt) {
  const std::string rest =
      "estimators: [estimators/a.yaml]\nsequences:\n  - path: ${data}/seq\n  - {path: '${data}/gone', name: "
      "far}\n";
  EXPECT_EQ(Read(rest, folder_.File("data")).code(), StatusCode::kConfig);
  // Wherever the key stands.
  const Result<Plan> plan = Read(rest + "skip_missing: true\n", folder_.File("data"));
  ASSERT_TRUE(plan.ok()) << plan.message();
  ASSERT_EQ(plan->sequences.size(), 1u);
  ASSERT_EQ(plan->absent.size(), 1u);
  EXPECT_EQ(plan->absent[0].first, "far");
  EXPECT_EQ(plan->absent[0].second, folder_.File("data/gone"));
  const Result<Plan> none = Read(rest + "skip_missing: true\n", folder_.File("nowhere"));
  EXPECT_EQ(none.code(), StatusCode::kInput);
  EXPECT_THAT(none.message(), HasSubstr("none of its 2 sequences is present"));
}

}  // namespace
}  // namespace alidade
