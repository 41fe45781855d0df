#include "gnss/positioning/pseudorange_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/random.h"

namespace alidade {
namespace {

constexpr int kSatellites = 18;
constexpr double kDeviationM = 0.5;

/// Error of a satellite at an epoch, over its stated deviation.
using Error = std::function<double(int satellite, int epoch)>;

/// A solution with these residuals, over the stated deviation, of satellites in use.
SinglePointSolution SolutionAt(double time_s, const std::vector<double>& whitened) {
  SinglePointSolution solution;
  solution.tag_ns = SecondsToNs(time_s);
  double squares = 0;
  for (std::size_t i = 0; i < whitened.size(); ++i) {
    SatelliteResidual satellite;
    satellite.satellite = {i % 2 == 0 ? GnssSystem::kGps : GnssSystem::kGalileo, 1 + static_cast<int>(i)};
    satellite.residual_m = kDeviationM * whitened[i];
    satellite.deviation_m = kDeviationM;
    satellite.used = true;
    solution.satellites.push_back(satellite);
    squares += whitened[i] * whitened[i] / static_cast<double>(whitened.size());
  }
  solution.scale = std::max(1.0, std::sqrt(squares));
  return solution;
}

PseudorangeNoise MeasuredNoise(int epochs, double interval_s, const Error& error) {
  PseudorangeErrors errors;
  // As a fit leaves them: unknowns take up as many degrees of freedom.
  const double share = std::sqrt(1 - 4.0 / kSatellites);
  for (int k = 0; k < epochs; ++k) {
    std::vector<double> whitened;
    whitened.reserve(kSatellites);
    for (int i = 0; i < kSatellites; ++i) {
      whitened.push_back(share * error(i, k));
    }
    errors.Add(SolutionAt(1000 + k * interval_s, whitened));
  }
  return errors.noise();
}

/// First-order Gauss-Markov errors of a deviation and a time, beside white ones of unit deviation.
class Multipath {
 public:
  Multipath(double deviation, double time_s, double interval_s)
      : deviation_(deviation), keep_(std::exp(-interval_s / time_s)), values_(kSatellites) {
    for (double& value : values_) {
      value = deviation_ * random_.Normal();
    }
  }
  double operator()(int satellite, int /*epoch*/) {
    double& value = values_[static_cast<std::size_t>(satellite)];
    value = keep_ * value + deviation_ * std::sqrt(1 - keep_ * keep_) * random_.Normal();
    return value + random_.Normal();
  }

 private:
  RandomStream random_{5, "multipath"};
  double deviation_;
  double keep_;
  std::vector<double> values_;
};

TEST(PseudorangeErrors, WhiteErrorsAsStatedAreWorthWhatIsStated) {
  RandomStream random(3, "white");
  for (const double interval_s : {0.1, 1.0}) {
    for (const double time_s : {6.0, 60.0, 300.0}) {
      const int epochs = static_cast<int>(time_s / interval_s);
      const PseudorangeNoise noise =
          MeasuredNoise(epochs, interval_s, [&](int, int) { return random.Normal(); });
      EXPECT_EQ(noise.scale, 1) << epochs;
      EXPECT_EQ(noise.lasting_variance, 0) << epochs;
    }
  }
}

TEST(PseudorangeErrors, LargerWhiteErrorsHaveALargerScaleAlone) {
  RandomStream random(4, "white");
  const PseudorangeNoise noise = MeasuredNoise(300, 0.1, [&](int, int) { return 3 * random.Normal(); });
  EXPECT_NEAR(noise.scale, 3, 0.15);
  EXPECT_EQ(noise.lasting_variance, 0);
}

TEST(PseudorangeErrors, SmallerErrorsThanStatedChangeNothing) {
  RandomStream random(4, "white");
  const PseudorangeNoise noise = MeasuredNoise(300, 0.1, [&](int, int) { return 0.3 * random.Normal(); });
  EXPECT_EQ(noise.scale, 1);
  EXPECT_EQ(noise.lasting_variance, 0);
}

/// Variance of white errors with as much information, over the stated one.
double Ratio(const PseudorangeNoise& noise) {
  return noise.scale * noise.scale + noise.lasting_variance * noise.epochs / (kDeviationM * kDeviationM);
}

// White and Gauss-Markov errors of time T: r c(0) = 1 + d^2 2 T / dt.
TEST(PseudorangeErrors, MultipathHasTheVarianceOfItsMeanOverALongTime) {
  for (const double interval_s : {0.1, 1.0}) {
    for (const double time_s : {4.0, 15.0}) {
      Multipath multipath(3, time_s, interval_s);
      const int epochs = static_cast<int>(300 / interval_s);
      const PseudorangeNoise noise = MeasuredNoise(epochs, interval_s, std::ref(multipath));
      const double ratio = Ratio(noise);
      const double expected = 1 + 9 * 2 * time_s / interval_s;
      EXPECT_GT(ratio, 0.6 * expected) << interval_s << " " << time_s;
      EXPECT_LT(ratio, 2.5 * expected) << interval_s << " " << time_s;
      EXPECT_NEAR(std::sqrt(noise.lasting_variance), 3 * kDeviationM, 0.25 * kDeviationM * 3);
      EXPECT_LT(noise.scale, 1.8);  // what changes within an interval is white
    }
  }
}

TEST(PseudorangeErrors, MultipathIsNoticedWithinTwoSeconds) {
  Multipath multipath(3, 20, 0.1);
  EXPECT_GT(Ratio(MeasuredNoise(20, 0.1, std::ref(multipath))), 40);
}

TEST(PseudorangeErrors, ConstantErrorsBelowTheStatedOnesCountAsOneEpoch) {
  RandomStream random(6, "constant");
  std::vector<double> constant;
  constant.reserve(kSatellites);
  for (int i = 0; i < kSatellites; ++i) {
    constant.push_back(0.5 * random.Normal());
  }
  const int epochs = 50;
  const PseudorangeNoise noise = MeasuredNoise(epochs, 1, [&](int satellite, int) {
    return constant[static_cast<std::size_t>(satellite)] + 0.1 * random.Normal();
  });
  EXPECT_EQ(noise.scale, 1);
  // The mean of all epochs is no better than one of them.
  const double of_mean_m2 = noise.lasting_variance * noise.epochs / epochs;
  EXPECT_GT(of_mean_m2, 0.5 * 0.25 * kDeviationM * kDeviationM);
  EXPECT_LT(of_mean_m2, 3 * 0.25 * kDeviationM * kDeviationM);
}

TEST(PseudorangeErrors, ASatelliteOutOfUseDoesNotCount) {
  RandomStream random(7, "white");
  PseudorangeErrors errors;
  for (int k = 0; k < 300; ++k) {
    std::vector<double> whitened = {80, 80};
    for (int i = 0; i < 10; ++i) {
      whitened.push_back(0.7 * random.Normal());
    }
    SinglePointSolution solution = SolutionAt(0.1 * k, whitened);
    solution.satellites[0].used = solution.satellites[1].used = false;
    solution.scale = 1;
    errors.Add(solution);
  }
  EXPECT_EQ(errors.noise().scale, 1);
  EXPECT_EQ(errors.noise().lasting_variance, 0);
}

// GIVEN two of eighteen satellites with constant errors of 20 deviations that were not refused, THEN the
// errors of all are taken to be far smaller than the mean square of 44, by what the median is shifted.
TEST(PseudorangeErrors, AMinorityCountsLittle) {
  RandomStream random(8, "white");
  const PseudorangeNoise noise =
      MeasuredNoise(300, 0.1, [&](int satellite, int) { return random.Normal() + (satellite < 2 ? 20 : 0); });
  EXPECT_LT(noise.lasting_variance, 0.5 * kDeviationM * kDeviationM);
  EXPECT_LT(noise.scale, 1.3);
}

// GIVEN constant errors, THEN further epochs add nothing; GIVEN errors that last for seconds, THEN they add
// what the mean over a long time gains.
TEST(PseudorangeErrors, EpochsAddUpToTheInformationOfTheirMean) {
  constexpr double kVariance = kDeviationM * kDeviationM;
  RandomStream random(10, "constant");
  std::vector<double> constant;
  constant.reserve(kSatellites);
  for (int i = 0; i < kSatellites; ++i) {
    constant.push_back(2 * random.Normal());
  }
  const auto constant_and_white = [&](int satellite, int) {
    return constant[static_cast<std::size_t>(satellite)] + random.Normal();
  };
  double added = 0;  // in epochs of white errors as stated
  for (int k = 20; k < 200; ++k) {
    added += MeasuredNoise(k, 0.1, constant_and_white).InformationShare(kVariance);
  }
  EXPECT_LT(added, 0.03);
  Multipath multipath(3, 4, 0.1);
  const PseudorangeNoise settled = MeasuredNoise(3000, 0.1, std::ref(multipath));
  EXPECT_GT(settled.settled_epochs, 0.8 * settled.epochs);
}

TEST(PseudorangeErrors, FewSatellitesDecideNothing) {
  PseudorangeErrors errors;
  for (int k = 0; k < 100; ++k) {
    errors.Add(SolutionAt(k, std::vector<double>(7, 5.0)));
  }
  EXPECT_EQ(errors.noise().scale, 1);
  EXPECT_EQ(errors.noise().lasting_variance, 0);
}

// GIVEN white errors for half a second, THEN they are not taken for white yet; after six seconds they are.
TEST(PseudorangeErrors, TheBeginningIsDoubted) {
  RandomStream random(9, "white");
  const auto white = [&](int, int) { return random.Normal(); };
  const PseudorangeNoise soon = MeasuredNoise(6, 0.1, white);
  EXPECT_GT(Ratio(soon), 1);
  EXPECT_LT(Ratio(soon), 10);
  EXPECT_EQ(Ratio(MeasuredNoise(60, 0.1, white)), 1);
}

}  // namespace
}  // namespace alidade
