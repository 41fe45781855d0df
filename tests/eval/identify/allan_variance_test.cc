#include "eval/identify/allan_variance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/random.h"
#include "eval/identify/noise_fit.h"

namespace alidade::test {
namespace {

constexpr double kPeriod_s = 0.1;

NoisePowers Powers(double quantisation, double white, double flicker, double walk) {
  return NoisePowers{
      Eigen::Vector4d(quantisation * quantisation, white * white, flicker * flicker, walk * walk)};
}

/// Rates with white noise, random walk, and quantisation of the integrated rate.
std::vector<double> Draw(const NoisePowers& powers, std::size_t count, unsigned seed) {
  RandomStream random(seed, "allan");
  std::vector<double> rates;
  double walk = 0;
  double error_before = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double error = std::sqrt(powers.value[NoisePowers::kQuantisation]) * random.Normal();
    walk += std::sqrt(powers.value[NoisePowers::kWalk] * kPeriod_s) * random.Normal();
    rates.push_back(walk + std::sqrt(powers.value[NoisePowers::kWhite] / kPeriod_s) * random.Normal() +
                    (error - error_before) / kPeriod_s);
    error_before = error;
  }
  return rates;
}

/// Flicker of coefficient B as a sum of first-order Gauss-Markov processes, two an octave: their spectra add
/// up to one in 1/f within 1 % between the corners (Keshner 1982).
std::vector<double> DrawFlicker(double bias_instability, std::size_t count, unsigned seed) {
  RandomStream random(seed, "flicker");
  std::vector<double> rates(count, 0);
  const double ratio = std::numbers::sqrt2;
  // The one-sided spectrum B^2 / (pi f) is that of processes of variance v each, sum = v / (f ln ratio).
  const double deviation = bias_instability * std::sqrt(std::log(ratio) / std::numbers::pi);
  const double longest_s = 20 * kPeriod_s * static_cast<double>(count);
  const int processes =
      static_cast<int>(std::ceil(std::log(longest_s / (0.2 * kPeriod_s)) / std::log(ratio)));
  for (int k = 0; k < processes; ++k) {
    const double time_s = 0.2 * kPeriod_s * std::pow(ratio, k);
    const double keep = std::exp(-kPeriod_s / time_s);
    double value = deviation * random.Normal();
    for (double& rate : rates) {
      value = keep * value + deviation * std::sqrt(1 - keep * keep) * random.Normal();
      rate += value;
    }
  }
  return rates;
}

NoiseFit Fit(const std::vector<double>& rates) {
  const std::vector<AllanPoint> points = OverlappingAllanVariance(rates, kPeriod_s);
  return FitNoise(points, AllanCovariance(points, rates.size()));
}

TEST(AllanVariance, GivenARampThenItIsHalfTheSquareOfTheStep) {
  std::vector<double> rates;
  rates.reserve(64);
  for (int k = 0; k < 64; ++k) {
    rates.push_back(3.0 * k);
  }
  for (const AllanPoint& point : OverlappingAllanVariance(rates, kPeriod_s)) {
    const double step = 3.0 * static_cast<double>(point.cluster);
    EXPECT_NEAR(point.variance, 0.5 * step * step, 1e-9 * step * step);
    EXPECT_DOUBLE_EQ(point.tau_s, kPeriod_s * static_cast<double>(point.cluster));
  }
}

TEST(AllanVariance, GivenTheRecordOfNbsThenTheDeviationIsThePublishedOne) {
  // The 1000 points of Riley, Handbook of Frequency Stability Analysis (NIST SP 1065), 12.4, at one sample.
  std::vector<double> rates;
  std::int64_t n = 1234567890;
  for (int k = 0; k < 1000; ++k) {
    rates.push_back(static_cast<double>(n) / 2147483647.0);
    n = 16807 * n % 2147483647;
  }
  const std::vector<AllanPoint> points = OverlappingAllanVariance(rates, 1);
  EXPECT_NEAR(std::sqrt(points[0].variance), 2.922319e-01, 1e-7);
}

TEST(AllanCovariance, GivenManyRecordsThenTheirScatterIsThePredictedOne) {
  const NoisePowers powers = Powers(0.02, 0.3, 0, 0.05);
  constexpr std::size_t kSamples = 1500;
  constexpr int kRecords = 600;
  std::vector<AllanPoint> points;
  Eigen::MatrixXd draws;
  for (int record = 0; record < kRecords; ++record) {
    points = OverlappingAllanVariance(Draw(powers, kSamples, 100 + static_cast<unsigned>(record)), kPeriod_s);
    draws.conservativeResize(static_cast<Eigen::Index>(points.size()), kRecords);
    for (std::size_t i = 0; i < points.size(); ++i) {
      draws(static_cast<Eigen::Index>(i), record) = points[i].variance;
    }
  }
  const Eigen::VectorXd mean = draws.rowwise().mean();
  const Eigen::MatrixXd centred = draws.colwise() - mean;
  const Eigen::MatrixXd sampled = centred * centred.transpose() / (kRecords - 1);
  const Eigen::MatrixXd predicted = AllanCovariance(points, kSamples).At(powers);
  for (Eigen::Index i = 0; i < predicted.rows(); ++i) {
    EXPECT_NEAR(mean[i] / powers.VarianceAt(points[static_cast<std::size_t>(i)].tau_s), 1, 0.06) << i;
    EXPECT_NEAR(sampled(i, i) / predicted(i, i), 1, 0.3) << i;
    for (Eigen::Index j = 0; j < i; ++j) {
      const double scale = std::sqrt(predicted(i, i) * predicted(j, j));
      EXPECT_NEAR(sampled(i, j) / scale, predicted(i, j) / scale, 0.18) << i << ", " << j;
    }
  }
}

TEST(NoiseFit, GivenFlickerAndWhiteNoiseThenTheBiasInstabilityIsFound) {
  const std::vector<double> flicker = DrawFlicker(0.1, 40000, 3);
  std::vector<double> rates = Draw(Powers(0, 0.05, 0, 0), flicker.size(), 4);
  for (std::size_t k = 0; k < rates.size(); ++k) {
    rates[k] += flicker[k];
  }
  const NoiseFit fit = Fit(rates);
  ASSERT_TRUE(fit[NoisePowers::kFlicker].visible);
  EXPECT_NEAR(fit[NoisePowers::kFlicker].value, 0.1, 0.015);
  EXPECT_LT(fit[NoisePowers::kFlicker].low, 0.1);
  EXPECT_GT(fit[NoisePowers::kFlicker].high, 0.1);
}

TEST(NoiseFit, GivenQuantisationThenItIsSeparatedFromWhiteNoise) {
  const NoisePowers powers = Powers(0.05, 0.1, 0, 0);
  const std::vector<double> rates = Draw(powers, 20000, 5);
  const NoiseFit fit = Fit(rates);
  EXPECT_NEAR(fit[NoisePowers::kQuantisation].value, 0.05, 0.005);
  EXPECT_NEAR(fit[NoisePowers::kWhite].value, 0.1, 0.01);
  EXPECT_FALSE(fit[NoisePowers::kWalk].visible);
  EXPECT_GT(fit[NoisePowers::kWalk].high, 0);
}

TEST(NoiseFit, GivenManyRecordsThenTheIntervalsHoldTheTruthAtTheirStatedRate) {
  const NoisePowers powers = Powers(0, 0.3, 0, 0.05);
  int white = 0, walk = 0;
  constexpr int kRecords = 60;
  for (unsigned seed = 0; seed < kRecords; ++seed) {
    const std::vector<double> rates = Draw(powers, 4000, 1000 + seed);
    const NoiseFit fit = Fit(rates);
    white += fit[NoisePowers::kWhite].low <= 0.3 && 0.3 <= fit[NoisePowers::kWhite].high ? 1 : 0;
    walk += fit[NoisePowers::kWalk].low <= 0.05 && 0.05 <= fit[NoisePowers::kWalk].high ? 1 : 0;
  }
  EXPECT_GE(white, 52);
  EXPECT_GE(walk, 52);
}

}  // namespace
}  // namespace alidade::test
