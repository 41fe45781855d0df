#include "core/imu_vibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/preintegration.h"
#include "core/random.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr double kRateHz = 200;
constexpr ImuNoise kSheet{2e-4, 2e-3, 2e-5, 3e-3, true};

ImuSample Still(int k) {
  return {SecondsToNs(k / kRateHz), Vector3d::Zero(), Vector3d(0, 0, 9.81)};
}

/// White samples of the sheet times `factor`.
std::vector<ImuSample> White(double factor, unsigned seed, int count) {
  RandomStream gyro(seed, "gyro"), accel(seed, "accel");
  std::vector<ImuSample> samples;
  for (int k = 0; k < count; ++k) {
    samples.push_back(Still(k));
    samples.back().gyro +=
        factor * kSheet.gyro_noise_density_radps_sqrthz * std::sqrt(kRateHz) * gyro.Normal3();
    samples.back().accel +=
        factor * kSheet.accel_noise_density_mps2_sqrthz * std::sqrt(kRateHz) * accel.Normal3();
  }
  return samples;
}

TEST(ImuVibrationTest, GivenTheNoiseOfTheSheetThenHardlyAnythingIsAddedAndNothingTakenOff) {
  double mean = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const ImuNoise with = AddVibration(White(1, seed, 11), kSheet);
    EXPECT_GE(with.gyro_noise_density_radps_sqrthz, kSheet.gyro_noise_density_radps_sqrthz);
    EXPECT_GE(with.accel_noise_density_mps2_sqrthz, kSheet.accel_noise_density_mps2_sqrthz);
    EXPECT_EQ(with.gyro_random_walk_radps2_sqrthz, kSheet.gyro_random_walk_radps2_sqrthz);
    mean += with.gyro_noise_density_radps_sqrthz / kSheet.gyro_noise_density_radps_sqrthz / 200;
  }
  EXPECT_LT(mean, 1.002);
  const ImuNoise quiet = AddVibration(White(0, 1, 11), kSheet);
  EXPECT_EQ(quiet.gyro_noise_density_radps_sqrthz, kSheet.gyro_noise_density_radps_sqrthz);
  EXPECT_EQ(quiet.accel_noise_density_mps2_sqrthz, kSheet.accel_noise_density_mps2_sqrthz);
}

TEST(ImuVibrationTest, GivenAToneThenWhatTheTrapezoidalRuleDoesNotResolveOfItIsAdded) {
  constexpr double frequency_hz = 40, amplitude = 3;
  constexpr int count = 2001;
  std::vector<ImuSample> samples;
  double squares = 0;
  for (int k = 0; k < count; ++k) {
    samples.push_back(Still(k));
    const double phase = 2 * std::numbers::pi * frequency_hz * k / kRateHz;
    samples.back().accel.x() += amplitude * std::sin(phase);
    // The exact integral of a step against the mean of its ends.
    const double next = phase + 2 * std::numbers::pi * frequency_hz / kRateHz;
    const double exact =
        amplitude * (std::cos(phase) - std::cos(next)) / (2 * std::numbers::pi * frequency_hz);
    const double rule = amplitude * (std::sin(phase) + std::sin(next)) / (2 * kRateHz);
    squares += (exact - rule) * (exact - rule);
  }
  const ImuNoise with = AddVibration(samples, kSheet);
  const double added = std::sqrt(std::pow(with.accel_noise_density_mps2_sqrthz, 2) -
                                 std::pow(kSheet.accel_noise_density_mps2_sqrthz, 2));
  // Over three axes, one of which vibrates. The cubic finds most of the error at a fifth of the rate.
  const double unresolved = std::sqrt(squares / count * kRateHz / 3);
  EXPECT_GT(added, 0.6 * unresolved);
  EXPECT_LT(added, 1.1 * unresolved);
  EXPECT_EQ(with.gyro_noise_density_radps_sqrthz, kSheet.gyro_noise_density_radps_sqrthz);
}

TEST(ImuVibrationTest, GivenTooFewOrUnevenSamplesThenTheSheetStands) {
  std::vector<ImuSample> samples = White(50, 1, 4);
  EXPECT_GT(AddVibration(samples, kSheet).accel_noise_density_mps2_sqrthz,
            kSheet.accel_noise_density_mps2_sqrthz);
  samples.back().stamp_ns += kSecondNs / 1000;
  EXPECT_EQ(AddVibration(samples, kSheet).accel_noise_density_mps2_sqrthz,
            kSheet.accel_noise_density_mps2_sqrthz);
  EXPECT_EQ(AddVibration(White(50, 1, 3), kSheet).accel_noise_density_mps2_sqrthz,
            kSheet.accel_noise_density_mps2_sqrthz);
  EXPECT_EQ(AddVibration({}, kSheet).accel_noise_density_mps2_sqrthz, kSheet.accel_noise_density_mps2_sqrthz);
}

TEST(ImuVibrationTest, GivenVibrationThatStopsThenTheCovarianceFallsBackToTheSheet) {
  ImuNoise sheet = kSheet;
  sheet.with_vibration = false;
  std::vector<ImuSample> samples = White(60, 2, 11);
  const std::vector<ImuSample> calm = White(0, 2, 21);
  samples.insert(samples.end(), calm.begin() + 11, calm.end());
  const auto covariance = [&](const ImuNoise& noise, size_t from) {
    Preintegration preintegration(ImuBias(), noise);
    preintegration.Add(std::span(samples).subspan(from, 10));
    return preintegration.covariance();
  };
  EXPECT_GT(covariance(kSheet, 0)(6, 6), 4 * covariance(sheet, 0)(6, 6));
  EXPECT_EQ(covariance(kSheet, 11), covariance(sheet, 11));
}

}  // namespace
}  // namespace alidade
