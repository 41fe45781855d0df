#include "eval/simulation/simulator_config.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "eval/config/config_writer.h"
#include "eval/config/config_yaml.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

TEST(SimulatorConfigTest, EveryShippedConfigurationIsValid) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(ALIDADE_SOURCE_DIR "/configs/datasets")) {
    if (entry.is_directory()) {
      continue;
    }
    // Those that stand on a recording are refused until it is named.
    const std::string stem = entry.path().stem();
    std::vector<std::string> settings;
    if (stem == "hybrid" || stem == "rendered" || stem == "rendered_hard") {
      settings = {"hybrid_dataset=somewhere"};
    } else if (stem == "recorded" || stem == "gnss_recorded") {
      settings = {"trajectory_file=" + testing::TempDir()};
    }
    const Result<SimulatorConfig> config = LoadSimulatorConfig(entry.path().string(), settings);
    EXPECT_TRUE(config.ok()) << config.message();
    EXPECT_EQ(config.ok() ? config->name : "", stem);
    ++count;
  }
  EXPECT_GE(count, 4);
}

TEST(SimulatorConfigTest, TheHybridIsRefusedWithoutASequence) {
  const Result<SimulatorConfig> config =
      LoadSimulatorConfig(ALIDADE_SOURCE_DIR "/configs/datasets/hybrid.yaml", {});
  ASSERT_FALSE(config.ok());
  EXPECT_EQ(config.code(), StatusCode::kConfig);
  EXPECT_NE(config.message().find("hybrid_dataset=FOLDER"), std::string::npos) << config.message();
}

TEST(SimulatorConfigTest, WhatIsWrittenReadsBack) {
  SimulatorConfig config;
  config.trajectory = SimTrajectory::kWander;
  config.hybrid_dataset = "/somewhere/else";
  config.room_margin_m << 1, 2, 3;
  config.misalignment_std_rad = 0.001;
  const std::string yaml =
      ConfigToYaml([&](ConfigVisitor& visitor) { config.Describe(visitor); }, /*with_docs=*/true);
  const test::TemporaryFolder folder;
  SimulatorConfig again;
  const Status status = ReadConfigFile(folder.Write("config.yaml", yaml),
                                       [&](ConfigVisitor& visitor) { again.Describe(visitor); });
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(ConfigToYaml([&](ConfigVisitor& visitor) { again.Describe(visitor); }, true), yaml);
}

TEST(SimulatorConfigTest, PathsInAFileAreRelativeToIt) {
  const test::TemporaryFolder folder;
  const std::string file =
      folder.Write("sub/config.yaml", "trajectory: file\ntrajectory_file: ../flight.csv\n");
  EXPECT_EQ(LoadSimulatorConfig(file, {})->trajectory_file, folder.File("flight.csv"));
  EXPECT_EQ(LoadSimulatorConfig(file, {})->hybrid_dataset, kNoPath);
  EXPECT_EQ(LoadSimulatorConfig(file, {"trajectory_file=here.csv"})->trajectory_file, "here.csv");
  EXPECT_EQ(LoadSimulatorConfig(file, {"trajectory_file=/abs/there.csv"})->trajectory_file, "/abs/there.csv");
  const Result<SimulatorConfig> wrong = LoadSimulatorConfig(file, {"room_margin=1"});
  EXPECT_EQ(wrong.code(), StatusCode::kConfig);
  EXPECT_NE(wrong.message().find("room_margin_m"), std::string::npos) << wrong.message();
}

}  // namespace
}  // namespace alidade
