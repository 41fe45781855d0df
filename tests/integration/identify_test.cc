#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

std::string Simulate(const TemporaryFolder& folder, const std::string& settings) {
  std::string sequence = folder.File("seq");
  const CommandResult made = Alidade("simulate --config=" + Source("configs/datasets/figure8_short.yaml") +
                                     " --set=" + settings + " --output=" + sequence + " --quiet");
  EXPECT_EQ(made.code, 0) << made.output;
  return sequence;
}

TEST(Identify, GivenARecordingThatBeginsAtRestThenTheRestIsUsedAndASheetWritten) {
  TemporaryFolder folder;
  const std::string sequence = Simulate(folder, "duration_s=34,path_m=5.2,rest_s=30");
  // The IMU alone is enough.
  std::filesystem::remove_all(sequence + "/mav0/cam0");
  const CommandResult found = Alidade("identify --dataset=" + sequence + " --output=" + folder.File("out"));
  ASSERT_EQ(found.code, 0) << found.output;
  EXPECT_THAT(found.output, HasSubstr("not at rest throughout"));
  const nlohmann::json json = nlohmann::json::parse(ReadFile(folder.File("out/identify.json")));
  EXPECT_NEAR(json["sheet"]["gyroscope_noise_density"].get<double>(), 3e-4, 3e-5);
  EXPECT_NEAR(json["sheet"]["accelerometer_noise_density"].get<double>(), 1e-3, 1e-4);
  for (const char* file : {"allan.csv", "allan.svg", "mav0/imu0/sensor.yaml"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.File("out/") + file)) << file;
  }

  EXPECT_EQ(Alidade("identify --dataset=" + sequence + " --output=" + folder.File("out")).code, 6);
}

TEST(Identify, GivenMotionAloneThenRestIsRefusedAndMotionIdentified) {
  TemporaryFolder folder;
  const std::string sequence = Simulate(folder, "duration_s=8,path_m=10.5,max_features=60");
  const CommandResult refused =
      Alidade("identify --dataset=" + sequence + " --output=" + folder.File("rest"));
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.output, HasSubstr("--motion"));

  const std::string words = "identify --motion --set=init.method=truth,filter.window=8 --dataset=" + sequence;
  const CommandResult one = Alidade(words + " --output=" + folder.File("one"));
  ASSERT_EQ(one.code, 0) << one.output;
  const nlohmann::json json = nlohmann::json::parse(ReadFile(folder.File("one/identify.json")));
  EXPECT_EQ(json["mode"], "motion");
  EXPECT_NEAR(json["noises"][4]["value"].get<double>(), 1, 0.1);
  const CommandResult two = Alidade(words + " --jobs=2 --quiet --output=" + folder.File("two"));
  ASSERT_EQ(two.code, 0) << two.output;
  EXPECT_EQ(ComparableFiles(folder.File("one")), ComparableFiles(folder.File("two")));
}

}  // namespace
}  // namespace alidade::test
