// Every way a configuration can be wrong that we have met or can think of: the fault is a Status of the right
// code, and its message names the place and what was expected. None of them may crash or be read as something
// plausible.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>

#include "eval/config/config_yaml.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

struct ConfigCase {
  const char* story;
  std::string yaml;
  std::vector<std::string> said;
};

std::ostream& operator<<(std::ostream& stream, const ConfigCase& c) {
  return stream << c.story;
}

class BadConfig : public testing::TestWithParam<ConfigCase> {};

TEST_P(BadConfig, IsAConfigErrorThatNamesThePlace) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write("estimator.yaml", GetParam().yaml);
  const Result<EstimatorConfig> config = LoadEstimatorConfig(path, {});
  ASSERT_FALSE(config.ok());
  EXPECT_EQ(config.code(), StatusCode::kConfig);
  for (const std::string& said : GetParam().said) {
    EXPECT_THAT(config.message(), HasSubstr(said));
  }
}

const ConfigCase kConfigCases[] = {
    {"empty", "", {"estimator.yaml", "is empty"}},
    {"a list", "- filter\n", {"estimator.yaml:1:1", "found the list [filter]", "keys and values"}},
    {"broken", "filter:\n  window: [1\n", {"estimator.yaml:", "not valid YAML"}},
    {"a comma alone", ",", {"estimator.yaml:1:1", "','"}},
    {"two documents", "name: a\n---\nname: b\n", {"estimator.yaml:3:1", "second document"}},
    {"unknown key",
     "filter:\n  windw: 20\n",
     {"estimator.yaml:2:3", "filter.windw", "unknown key", "'filter.window'"}},
    {"key of another group",
     "filter:\n  max_features: 20\n",
     {":2:3", "did you mean 'frontend.max_features'?"}},
    {"key without its group", "window: 20\n", {":1:1", "window", "did you mean 'filter.window'?"}},
    {"unknown group", "fliter:\n  window: 20\n", {":1:1", "fliter", "'filter'"}},
    {"duplicate key", "filter:\n  window: 20\n  window: 30\n", {"estimator.yaml:3:3", "window", "duplicate"}},
    {"duplicate group",
     "filter:\n  window: 20\nfilter:\n  window: 30\n",
     {"estimator.yaml:3:1", "duplicate"}},
    {"octal", "filter:\n  window: 010\n", {":2:11", "filter.window", "'010'", "octal"}},
    {"octal real", "imu:\n  noise_scale: 010\n", {":2:16", "'010'", "octal"}},
    {"hexadecimal", "filter:\n  window: 0x10\n", {":2:11", "'0x10'", "an integer"}},
    {"not a number", "vision:\n  pixel_noise_px: .nan\n", {":2:19", "'.nan'", "finite"}},
    {"infinite", "vision:\n  pixel_noise_px: -.inf\n", {":2:19", "'-.inf'", "finite"}},
    {"yes", "gnss:\n  enabled: yes\n", {":2:12", "gnss.enabled", "'yes'", "true or false"}},
    {"capital True", "gnss:\n  enabled: True\n", {"'True'", "true or false"}},
    {"quoted number", "filter:\n  window: \"20\"\n", {":2:11", "'20'", "an integer"}},
    {"real for an integer", "filter:\n  window: 20.0\n", {"'20.0'", "an integer"}},
    {"list for a number",
     "filter:\n  window: [20, [3, x]]\n",
     {"filter.window: found the list [20, [3, x]], expected an integer"}},
    {"long list for a number",
     "filter:\n  window: [1000000, 2000000, 3000000, 4000000, 5000000]\n",
     {"filter.window: found the list [1000000, 2000000, 3000000, 4000000, 500..., expected an integer"}},
    {"number for a group", "filter: 20\n", {":1:1", "filter", "'20'", "a group of keys"}},
    {"empty group", "filter:\n", {":1:1", "filter", "nothing", "a group of keys"}},
    {"group for a key", "name:\n  window: 3\n", {"name: found the group {window: 3}, expected a text"}},
    {"nothing for a number", "filter:\n  window:\n", {"filter.window", "nothing", "an integer"}},
    {"too small", "filter:\n  window: 2\n", {":2:11", "'2'", "[3, 200]"}},
    {"too large", "vision:\n  pixel_noise_px: 1e3\n", {"'1e3'", "[0.01, 100] px"}},
    {"integer beyond 64 bits", "filter:\n  window: 99999999999999999999\n", {"an integer"}},
    {"misspelt choice",
     "filter:\n  landmark: pose_only_muti\n",
     {":2:13", "did you mean 'pose_only_multi'?"}},
    {"wrong case of a choice",
     "backend: Filter\n",
     {":1:10", "'Filter'", "filter, smoother", "did you mean 'filter'?"}},
    {"merge key", "filter:\n  <<: {window: 20}\n", {":2:3", "filter.<<", "unknown key"}},
    {"tab", "filter:\n\twindow: 20\n", {"estimator.yaml:", "not valid YAML"}},
    {"base missing", "base: nowhere.yaml\n", {":1:7", "nowhere.yaml", "relative to this file"}},
    {"base is itself", "base: estimator.yaml\n", {":1:7", "no cycle"}},
    {"base in a group", "filter:\n  base: estimator.yaml\n", {":2:3", "filter.base", "unknown key"}},
    {"keys that contradict",
     "filter:\n  window: 5\n  min_observations: 9\n",
     {"estimator.yaml", "filter.min_observations"}},
};
INSTANTIATE_TEST_SUITE_P(Yaml, BadConfig, testing::ValuesIn(kConfigCases));

struct SettingCase {
  const char* setting;
  std::vector<std::string> said;
};

std::ostream& operator<<(std::ostream& stream, const SettingCase& c) {
  return stream << c.setting;
}

class BadSetting : public testing::TestWithParam<SettingCase> {};

TEST_P(BadSetting, IsAConfigErrorThatNamesTheSetting) {
  EstimatorConfig config;
  const Status applied =
      ApplySettings({GetParam().setting}, [&](ConfigVisitor& visitor) { config.Describe(visitor); });
  EXPECT_EQ(applied.code(), StatusCode::kConfig);
  EXPECT_THAT(applied.message(), HasSubstr(GetParam().setting));
  for (const std::string& said : GetParam().said) {
    EXPECT_THAT(applied.message(), HasSubstr(said));
  }
}

const SettingCase kSettingCases[] = {
    {"filter.window", {"KEY=VALUE"}},
    {"=3", {"KEY=VALUE"}},
    {"filter.windw=3", {"unknown key", "filter.window"}},
    {"filter=3", {"group of keys"}},
    {"filter..window=3", {"unknown key"}},
    {"filter.window.x=3", {"unknown key"}},
    {"filter.window=", {"an integer"}},
    {"filter.window=3 4", {"an integer"}},
    {"filter.window=1000", {"[3, 200]"}},
    {"filter.window=010", {"octal"}},
    {"filter.window=[3", {"not a list"}},
    {"filter.window=[3],", {"not a list", "value:1:4"}},
    {"gnss.enabled=1", {"true or false"}},
    {"base=other.yaml", {"unknown key"}},
};
INSTANTIATE_TEST_SUITE_P(Flag, BadSetting, testing::ValuesIn(kSettingCases));

}  // namespace
}  // namespace alidade
