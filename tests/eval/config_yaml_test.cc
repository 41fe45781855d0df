#include "eval/config_yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "eval/input_file.h"
#include "eval/output_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

constexpr char kBaseHead[] =
    "# Every key of an estimator with its default: `# unit, range; reason`. Other files start with\n"
    "# `base: base.yaml` and name only what differs. Generated from the code; a test keeps both equal.\n";

std::string BaseYaml() {
  EstimatorConfig config;
  return kBaseHead + ConfigToYaml([&config](ConfigVisitor& visitor) { config.Describe(visitor); }, true);
}

TEST(BaseYaml, IsWhatTheCodeSays) {
  const std::string path = std::string(ALIDADE_SOURCE_DIR) + "/configs/base.yaml";
  if (std::getenv("ALIDADE_REGENERATE") != nullptr) {
    ASSERT_TRUE(WriteFileAtomically(path, BaseYaml()).ok());
  }
  const Result<std::string> text = ReadWholeFile(path);
  ASSERT_TRUE(text.ok()) << text.message();
  EXPECT_EQ(*text, BaseYaml()) << "configs/base.yaml is out of date; run:  ALIDADE_REGENERATE=1 "
                                  "build/alidade_eval_tests --gtest_filter=BaseYaml.IsWhatTheCodeSays";
}

TEST(BaseYaml, WhenReadBackThenItIsTheDefaults) {
  const Result<EstimatorConfig> config =
      LoadEstimatorConfig(std::string(ALIDADE_SOURCE_DIR) + "/configs/base.yaml", {});
  ASSERT_TRUE(config.ok()) << config.message();
  EstimatorConfig read = *config;
  EstimatorConfig fresh;
  EXPECT_EQ(ConfigToYaml([&](ConfigVisitor& visitor) { read.Describe(visitor); }, false),
            ConfigToYaml([&](ConfigVisitor& visitor) { fresh.Describe(visitor); }, false));
}

TEST(Presets, EveryOneLoadsAndBearsItsFileName) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(ALIDADE_SOURCE_DIR) + "/configs/estimators")) {
    const Result<EstimatorConfig> config = LoadEstimatorConfig(entry.path().string(), {});
    ASSERT_TRUE(config.ok()) << config.message();
    EXPECT_EQ(config->name, entry.path().stem().string());
    ++count;
  }
  EXPECT_GE(count, 14);
}

}  // namespace
}  // namespace alidade
