#include "eval/identify/rest_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/random.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/identify/rest_report.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr double kRate_hz = 100;
const ImuNoise kSheet{3e-4, 1e-3, 3e-5, 2e-4};

/// An IMU at rest as the simulator makes it (eval/simulation/sim_imu.h).
std::vector<ImuSample> AtRest(double duration_s, unsigned seed) {
  RandomStream white(seed, "white"), walk(seed, "walk");
  std::vector<ImuSample> imu;
  Eigen::Vector3d gyro_bias = 0.01 * walk.Normal3(), accel_bias = 0.1 * walk.Normal3();
  for (int k = 0; k < static_cast<int>(duration_s * kRate_hz); ++k) {
    gyro_bias += kSheet.gyro_random_walk_radps2_sqrthz / std::sqrt(kRate_hz) * walk.Normal3();
    accel_bias += kSheet.accel_random_walk_mps3_sqrthz / std::sqrt(kRate_hz) * walk.Normal3();
    ImuSample sample;
    sample.stamp_ns = 1'000'000'000 + SecondsToNs(k / kRate_hz);
    sample.gyro = gyro_bias + kSheet.gyro_noise_density_radps_sqrthz * std::sqrt(kRate_hz) * white.Normal3();
    sample.accel = Eigen::Vector3d(0, 0, 9.81) + accel_bias +
                   kSheet.accel_noise_density_mps2_sqrthz * std::sqrt(kRate_hz) * white.Normal3();
    imu.push_back(sample);
  }
  return imu;
}

TEST(RestNoise, GivenAnHourAtRestThenTheSheetIsFoundWithinTenPercent) {
  for (const unsigned seed : {11u, 12u, 13u}) {
    const Result<RestNoise> noise = IdentifyAtRest(AtRest(3600, seed), InitConfig());
    ASSERT_TRUE(noise.ok()) << noise.message();
    const ImuNoise& sheet = noise->sheet;
    EXPECT_NEAR(sheet.gyro_noise_density_radps_sqrthz / kSheet.gyro_noise_density_radps_sqrthz, 1, 0.1);
    EXPECT_NEAR(sheet.accel_noise_density_mps2_sqrthz / kSheet.accel_noise_density_mps2_sqrthz, 1, 0.1);
    EXPECT_NEAR(sheet.gyro_random_walk_radps2_sqrthz / kSheet.gyro_random_walk_radps2_sqrthz, 1, 0.1);
    EXPECT_NEAR(sheet.accel_random_walk_mps3_sqrthz / kSheet.accel_random_walk_mps3_sqrthz, 1, 0.1);
    EXPECT_GT(noise->span.duration_s(), 3599);
    EXPECT_TRUE(noise->remarks.empty()) << noise->remarks.front();
  }
}

TEST(RestNoise, GivenMotionBetweenTwoRestsThenTheLongerRestIsUsedAndNamed) {
  std::vector<ImuSample> imu = AtRest(200, 21);
  for (std::size_t k = 5000; k < 7000; ++k) {
    imu[k].gyro += Eigen::Vector3d(0, 0, 0.5 * std::sin(0.05 * static_cast<double>(k)));
  }
  const Result<RestNoise> noise = IdentifyAtRest(imu, InitConfig());
  ASSERT_TRUE(noise.ok()) << noise.message();
  EXPECT_GE(noise->span.start_ns, imu[7000].stamp_ns);
  EXPECT_LE(noise->span.start_ns, imu[7200].stamp_ns);
  EXPECT_EQ(noise->span.end_ns, imu.back().stamp_ns);
  EXPECT_THAT(noise->remarks, Contains(HasSubstr("not at rest throughout")));
  EXPECT_NEAR(noise->sheet.gyro_noise_density_radps_sqrthz, 3e-4, 3e-5);
}

TEST(RestNoise, GivenGapsAndJitterThenTheyAreCountedAndTheNoiseStands) {
  std::vector<ImuSample> imu = AtRest(300, 31);
  RandomStream random(31, "stamps");
  std::vector<ImuSample> kept;
  for (std::size_t k = 0; k < imu.size(); ++k) {
    imu[k].stamp_ns += SecondsToNs(0.001 * random.Uniform(-1, 1));
    if (k % 1000 != 500 && k % 1000 != 501) {
      kept.push_back(imu[k]);
    }
  }
  const Result<RestNoise> noise = IdentifyAtRest(kept, InitConfig());
  ASSERT_TRUE(noise.ok()) << noise.message();
  EXPECT_EQ(noise->span.gaps, 30u);
  EXPECT_EQ(noise->span.filled, 60u);
  EXPECT_EQ(noise->span.samples(), imu.size());
  EXPECT_NEAR(noise->span.period_s, 1 / kRate_hz, 1e-6);
  EXPECT_NEAR(noise->span.jitter_rms_s, 0.001 * std::sqrt(2.0 / 3), 1e-4);
  EXPECT_NEAR(noise->sheet.accel_noise_density_mps2_sqrthz, 1e-3, 1e-4);
}

TEST(RestNoise, GivenALongSilenceThenTheSpanEndsThere) {
  std::vector<ImuSample> imu = AtRest(100, 41);
  imu.erase(imu.begin() + 3000, imu.begin() + 4000);
  const Result<RestNoise> noise = IdentifyAtRest(imu, InitConfig());
  ASSERT_TRUE(noise.ok()) << noise.message();
  EXPECT_EQ(noise->span.start_ns, imu[3000].stamp_ns);
  EXPECT_EQ(noise->span.samples(), 6000u);
}

TEST(RestNoise, GivenMotionOnlyThenTheErrorNamesIt) {
  std::vector<ImuSample> imu = AtRest(60, 51);
  for (std::size_t k = 0; k < imu.size(); ++k) {
    imu[k].gyro += Eigen::Vector3d(0.5 * std::sin(0.1 * static_cast<double>(k)), 0, 0);
  }
  const Result<RestNoise> noise = IdentifyAtRest(imu, InitConfig());
  EXPECT_EQ(noise.code(), StatusCode::kInput);
  EXPECT_THAT(noise.message(), HasSubstr("longest span at rest"));
}

TEST(RestNoise, GivenAnAxisThatDoesNotChangeThenTheErrorNamesIt) {
  std::vector<ImuSample> imu = AtRest(60, 61);
  for (ImuSample& sample : imu) {
    sample.gyro.y() = 0;
  }
  const Result<RestNoise> noise = IdentifyAtRest(imu, InitConfig());
  EXPECT_EQ(noise.code(), StatusCode::kInput);
  EXPECT_THAT(noise.message(), HasSubstr("gyro y"));
}

TEST(RestReport, WritesSheetJsonCurvesAndPlot) {
  const Result<RestNoise> noise = IdentifyAtRest(AtRest(120, 71), InitConfig());
  ASSERT_TRUE(noise.ok()) << noise.message();
  TemporaryFolder folder;
  ASSERT_TRUE(WriteRestNoise(*noise, "seq", folder.path()).ok());
  const Result<ImuSensor> sheet = ReadImuSensor(folder.File("mav0/imu0/sensor.yaml"));
  ASSERT_TRUE(sheet.ok()) << sheet.message();
  EXPECT_EQ(sheet->noise.gyro_noise_density_radps_sqrthz, noise->sheet.gyro_noise_density_radps_sqrthz);
  EXPECT_EQ(sheet->rate_hz, kRate_hz);
  const nlohmann::json json = nlohmann::json::parse(ReadFile(folder.File("identify.json")));
  EXPECT_EQ(json["mode"], "rest");
  EXPECT_EQ(json["axes"].size(), 6u);
  EXPECT_NEAR(json["axes"][3]["white_noise_density"]["value"].get<double>(), 1e-3, 1e-4);
  EXPECT_THAT(ReadFile(folder.File("allan.csv")),
              HasSubstr("axis,tau_s,deviation,low_95,high_95,dof,fit\ngyro x,"));
  EXPECT_THAT(ReadFile(folder.File("allan.svg")), HasSubstr("averaging time"));
  EXPECT_THAT(RestNoiseTable(*noise), HasSubstr("note: 120 s at rest"));
}

}  // namespace
}  // namespace alidade::test
