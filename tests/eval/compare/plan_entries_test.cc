#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/eval/compare/plan_fixture.h"

// Entries of a plan that lie outside of it: programs, bags, links, and what is missing.

namespace alidade {
namespace {

using test::PlanTest;
using testing::ElementsAre;
using testing::HasSubstr;

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
