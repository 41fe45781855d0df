#include "eval/identify/motion_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "eval/dataset/sensor_yaml.h"
#include "eval/identify/motion_report.h"
#include "tests/support/read_file.h"
#include "tests/support/scenario.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

const IdentifiedNoise& Find(const MotionNoise& noise, NoiseSource source) {
  for (const IdentifiedNoise& one : noise.noises) {
    if (one.source == source) {
      return one;
    }
  }
  ADD_FAILURE() << NameOf(source) << " is missing";
  return noise.noises.front();
}

/// Twenty seconds of the figure-8, given to a filter whose noises are wrong by a factor of two or three.
class ShortMotion : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    SimulatorConfig simulation;
    simulation.duration_s = 20;
    simulation.path_m = 26.2;
    simulation.max_features = 80;
    const Dataset dataset = SimulateOrDie(simulation, 3);
    truth_ = simulation.imu_noise;
    EstimatorConfig config;
    config.init.method = InitMethod::kTruth;
    config.filter.window = 10;
    config.vision.pixel_noise_px = 2;
    MeasurementLog log{dataset.rig, dataset.imu, dataset.frames};
    log.rig.imu_noise.gyro_noise_density_radps_sqrthz *= 3;
    log.rig.imu_noise.accel_noise_density_mps2_sqrthz *= 2;
    MotionOptions options;
    options.run.truth = &*dataset.truth;
    options.most_rounds = 3;
    noise_ = new Result<MotionNoise>(IdentifyInMotion(config, log, options));
  }
  static void TearDownTestSuite() { delete noise_; }

  static ImuNoise truth_;
  static const Result<MotionNoise>* noise_;
};
ImuNoise ShortMotion::truth_;
const Result<MotionNoise>* ShortMotion::noise_ = nullptr;

TEST_F(ShortMotion, TheDensitiesAndThePixelNoiseAreFound) {
  ASSERT_TRUE(noise_->ok()) << noise_->message();
  const IdentifiedNoise& gyro = Find(**noise_, NoiseSource::kGyro);
  const IdentifiedNoise& accel = Find(**noise_, NoiseSource::kAccel);
  const IdentifiedNoise& pixel = Find(**noise_, NoiseSource::kPixel);
  EXPECT_NEAR(pixel.value, 1, 0.05);
  EXPECT_NEAR(gyro.value / truth_.gyro_noise_density_radps_sqrthz, 1, 0.4);
  for (const IdentifiedNoise* noise : {&gyro, &accel, &pixel}) {
    EXPECT_LT(noise->low, noise->value);
    EXPECT_GT(noise->high, noise->value);
  }
  EXPECT_LT(accel.low, truth_.accel_noise_density_mps2_sqrthz * 1.3);
  EXPECT_GT(accel.high, truth_.accel_noise_density_mps2_sqrthz / 1.3);
}

TEST_F(ShortMotion, AHalfIsPredictedByTheNoisesOfTheOther) {
  ASSERT_TRUE(noise_->ok()) << noise_->message();
  for (const HalfFit& half : (*noise_)->halves) {
    EXPECT_GT(half.dof[0], 3000);
    EXPECT_NEAR(half.nis_ratio[0], 1, 0.05) << half.name;
  }
}

TEST_F(ShortMotion, TheReportHoldsSheetNoisesAndInnovations) {
  ASSERT_TRUE(noise_->ok()) << noise_->message();
  TemporaryFolder folder;
  ASSERT_TRUE(WriteMotionNoise(**noise_, "seq", 100, folder.path()).ok());
  const Result<ImuSensor> sheet = ReadImuSensor(folder.File("mav0/imu0/sensor.yaml"));
  ASSERT_TRUE(sheet.ok()) << sheet.message();
  EXPECT_EQ(sheet->noise.gyro_noise_density_radps_sqrthz, Find(**noise_, NoiseSource::kGyro).value);
  const nlohmann::json json = nlohmann::json::parse(ReadFile(folder.File("identify.json")));
  EXPECT_EQ(json["mode"], "motion");
  ASSERT_EQ(json["noises"].size(), 5u);
  EXPECT_EQ(json["noises"][4]["noise"], "pixel_noise");
  EXPECT_THAT(ReadFile(folder.File("innovations.csv")), HasSubstr("timestamp_ns,log_likelihood,vision_nis,"));
  EXPECT_THAT(ReadFile(folder.File("nis.svg")), HasSubstr("NIS / rows"));
  EXPECT_THAT(MotionNoiseTable(**noise_), HasSubstr("--set=imu.noise_scale=1"));
}

}  // namespace
}  // namespace alidade::test
