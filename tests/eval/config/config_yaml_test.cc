#include "eval/config/config_yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "eval/config/config_writer.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
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

TEST(BaseYaml, IsTheTextOfTheSchema) {
  const std::string path = std::string(ALIDADE_SOURCE_DIR) + "/configs/base.yaml";
  if (std::getenv("ALIDADE_REGENERATE") != nullptr) {
    ASSERT_TRUE(WriteFileAtomically(path, BaseYaml()).ok());
  }
  const Result<std::string> text = ReadWholeFile(path);
  ASSERT_TRUE(text.ok()) << text.message();
  EXPECT_EQ(*text, BaseYaml())
      << "configs/base.yaml is out of date; run:  ALIDADE_REGENERATE=1 "
         "build/alidade_eval_config_tests --gtest_filter=BaseYaml.IsTheTextOfTheSchema";
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

/// A struct with one key of each kind.
struct Every {
  double real = 0.1;
  int integer = 3;
  bool boolean = false;
  std::string text = "plain";
  Eigen::Vector3d vector = Eigen::Vector3d(1, 2, 3);
  Backend choice = Backend::kFilter;

  void Describe(ConfigVisitor& visitor) {
    visitor.Text({"text", "-", "a text"}, &text);
    visitor.Section("outer", "a group", [&] {
      visitor.Section("inner", "a group in it", [&] {
        visitor.Real({"real", "m", "a real"}, &real, -1e9, 1e9);
      });
      visitor.Integer({"integer", "-", "an integer"}, &integer, -5, 5);
    });
    visitor.Boolean({"boolean", "-", "a switch"}, &boolean);
    visitor.Vector3({"vector", "m", "three numbers"}, &vector, -10, 10);
    visitor.Enumeration({"choice", "-", "one of two"}, &choice,
                        {{"filter", Backend::kFilter}, {"smoother", Backend::kSmoother}});
  }
};

TEST(ConfigYaml, WhenPrintedAndReadBackThenEveryValueIsEqual) {
  const test::TemporaryFolder folder;
  for (const char* text : {"plain", "null", "true", "1e5", "with: colon", "# no comment", " blank ",
                           "quote\" \\ end", "two\nlines", "[list]", "\xC3\xA4", "-", "~"}) {
    for (const bool with_docs : {false, true}) {
      Every written;
      written.real = 1.0 / 3.0;
      written.integer = -5;
      written.boolean = true;
      written.text = text;
      written.vector = Eigen::Vector3d(-0.1, 1e-7, 9.9);
      written.choice = Backend::kSmoother;
      const std::string yaml =
          ConfigToYaml([&](ConfigVisitor& visitor) { written.Describe(visitor); }, with_docs);
      Every read;
      const Status status = ReadConfigFile(folder.Write("a.yaml", yaml),
                                           [&](ConfigVisitor& visitor) { read.Describe(visitor); });
      ASSERT_TRUE(status.ok()) << status.message() << "\n" << yaml;
      EXPECT_EQ(read.real, written.real);
      EXPECT_EQ(read.integer, written.integer);
      EXPECT_EQ(read.boolean, written.boolean);
      EXPECT_EQ(read.text, written.text);
      EXPECT_EQ(read.vector, written.vector);
      EXPECT_EQ(read.choice, written.choice);
    }
  }
}

TEST(ConfigYaml, GivenDocsThenEveryKeyHasUnitRangeAndReason) {
  Every every;
  const std::string yaml = ConfigToYaml([&](ConfigVisitor& visitor) { every.Describe(visitor); }, true);
  EXPECT_THAT(yaml, HasSubstr("    real: 0.1  # m, [-1e+09, 1e+09]; a real\n"));
  EXPECT_THAT(yaml, HasSubstr("vector: [1, 2, 3]  # m, each [-10, 10]; three numbers\n"));
  EXPECT_THAT(yaml, HasSubstr("choice: filter  # -, filter | smoother; one of two\n"));
}

TEST(ConfigYaml, GivenBasesThenTheNearerFileWinsAndSettingsWinOverFiles) {
  const test::TemporaryFolder folder;
  folder.Write("shared/base.yaml", "name: base\nfilter:\n  window: 11\n  min_observations: 5\n");
  folder.Write("shared/middle.yaml", "base: base.yaml\nfilter:\n  window: 12\n  base_inflation: 3\n");
  const std::string path = folder.Write("top/top.yaml", "base: ../shared/middle.yaml\nname: top\n");
  const Result<EstimatorConfig> config =
      LoadEstimatorConfig(path, {"filter.base_inflation=+4.5", "gnss.enabled=false"});
  ASSERT_TRUE(config.ok()) << config.message();
  EXPECT_EQ(config->name, "top");
  EXPECT_EQ(config->filter.window, 12);
  EXPECT_EQ(config->filter.min_observations, 5);
  EXPECT_EQ(config->filter.base_inflation, 4.5);
}

TEST(ConfigYaml, GivenAFaultInABaseThenThatFileIsNamed) {
  const test::TemporaryFolder folder;
  folder.Write("base.yaml", "filter:\n  window: many\n");
  const Result<EstimatorConfig> config =
      LoadEstimatorConfig(folder.Write("top.yaml", "base: base.yaml\n"), {});
  EXPECT_THAT(config.message(),
              HasSubstr("base.yaml:2:11: filter.window: found 'many', expected an integer"));
}

TEST(ConfigYaml, GivenSettingsInOneFlagThenCommasInBracketsDoNotSplit) {
  EXPECT_THAT(SplitSettings("a.b=1,vector=[1,2,3],c=x"),
              testing::ElementsAre("a.b=1", "vector=[1,2,3]", "c=x"));
  EXPECT_THAT(SplitSettings(""), testing::IsEmpty());
  Every every;
  const Status status = ApplySettings(SplitSettings("vector=[4, 5,6],outer.inner.real=-.5,text=true"),
                                      [&](ConfigVisitor& visitor) { every.Describe(visitor); });
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(every.vector, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(every.real, -0.5);
  EXPECT_EQ(every.text, "true");
}

TEST(ConfigYaml, GivenAKeyTwiceInSettingsThenDifferentValuesAreRefusedAndBothNamed) {
  EXPECT_TRUE(CheckSettingsAgree({"a.b=1", "a.c=2", "a.b=1", "vector=[1,2]"}).ok());
  const Status status = CheckSettingsAgree({"a.b=1", "a.c=2", "a.b=3"});
  EXPECT_EQ(status.code(), StatusCode::kConfig);
  EXPECT_EQ(status.message(), "setting 'a.b': found '1' and '3', expected one value");
}

}  // namespace
}  // namespace alidade
