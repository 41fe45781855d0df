#include "core/robust.h"

#include <gtest/gtest.h>

#include <cmath>

namespace alidade {
namespace {

TEST(RobustTest, GateKeepsItsProbability) {
  EXPECT_NEAR(ChiSquareQuantile(2, 0.95), 5.991464547, 1e-8);  // tables
  EXPECT_NEAR(ChiSquareQuantile(300, 0.99), 359.906, 1e-2);
  const ChiSquareGate gate(0.95, 10);
  EXPECT_TRUE(gate.Accepts(5.9, 2));
  EXPECT_FALSE(gate.Accepts(6.1, 2));
  EXPECT_NEAR(gate.Threshold(20), 31.410, 1e-2) << "beyond the table";
  EXPECT_TRUE(ChiSquareGate(1.0).Accepts(1e300, 3));
}

TEST(RobustTest, KernelsDescendFromOne) {
  for (const RobustKernel kernel :
       {RobustKernel::kNone, RobustKernel::kHuber, RobustKernel::kCauchy, RobustKernel::kLogTail}) {
    EXPECT_NEAR(RobustWeight(kernel, 2, 1e-12), 1, 1e-9);
  }
  EXPECT_EQ(RobustWeight(RobustKernel::kHuber, 2, 3.9), 1);
  EXPECT_NEAR(RobustWeight(RobustKernel::kHuber, 2, 16), 0.5, 1e-15);
  EXPECT_NEAR(RobustWeight(RobustKernel::kCauchy, 2, 4), 0.5, 1e-15);
  EXPECT_EQ(RobustWeight(RobustKernel::kLogTail, 2, 3.9), 1);
  EXPECT_NEAR(RobustWeight(RobustKernel::kLogTail, 2, 16), 0.25, 1e-15);
}

TEST(RobustTest, GIVEN_a_robust_residual_THEN_it_derives_from_the_kernels_weight) {
  constexpr double kScale = 1.7;
  for (const RobustKernel kernel :
       {RobustKernel::kNone, RobustKernel::kHuber, RobustKernel::kCauchy, RobustKernel::kLogTail}) {
    for (const double r : {-40.0, -1.9, -1.5, -1e-3, 0.0, 1e-6, 0.4, 1.6, 1.8, 25.0}) {
      // d rho / d s of rho = value^2 and s = r^2.
      constexpr double kStep = 1e-6;
      const auto value = [&](double at) { return Robustify(kernel, kScale, at).value; };
      const RobustResidual robust = Robustify(kernel, kScale, r);
      EXPECT_NEAR(robust.slope, (value(r + kStep) - value(r - kStep)) / (2 * kStep), 1e-8) << r;
      EXPECT_NEAR(robust.value * robust.slope, RobustWeight(kernel, kScale, r * r) * r, 1e-7 * std::abs(r))
          << "d rho / d r = 2 rho' r at " << r;
    }
  }
  EXPECT_EQ(Robustify(RobustKernel::kHuber, 2, -1.5).value, -1.5);
  EXPECT_NEAR(std::pow(Robustify(RobustKernel::kHuber, 2, -10).value, 2), 2 * 2 * 10 - 4, 1e-12);
  EXPECT_NEAR(std::pow(Robustify(RobustKernel::kCauchy, 2, 4).value, 2), 4 * std::log(5), 1e-12);
  EXPECT_NEAR(std::pow(Robustify(RobustKernel::kLogTail, 2, -4).value, 2), 4 * (1 + std::log(4)), 1e-12);
}

TEST(ConsensusTest, GIVEN_many_refusals_THEN_the_state_is_suspect_and_few_are_the_measurements_fault) {
  EXPECT_TRUE(StateIsSuspect(8, 15, 0.5, 8));
  EXPECT_FALSE(StateIsSuspect(8, 16, 0.5, 8)) << "no more than the share";
  EXPECT_FALSE(StateIsSuspect(7, 7, 0.5, 8)) << "all of too few";
  EXPECT_TRUE(StateIsSuspect(4, 7, 0.5, 4));
  EXPECT_FALSE(StateIsSuspect(0, 0, 0.5, 0));
}

/// Largest probability, over the number of measurements, that chance alone makes more than half of them and
/// at least `least` wrong when each is wrong with probability q.
double FalseSuspicion(double q, int least) {
  double largest = 0;
  for (int n = least; n <= 100; ++n) {
    double probability = 0;
    for (int k = std::max(least, n / 2 + 1); k <= n; ++k) {
      const double log_choose = std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
      probability += std::exp(log_choose + k * std::log(q) + (n - k) * std::log(1 - q));
    }
    largest = std::max(largest, probability);
  }
  return largest;
}

TEST(ConsensusTest, GIVEN_the_stated_share_of_wrong_ones_THEN_the_least_numbers_hold_chance_to_5_percent) {
  EXPECT_NEAR(FalseSuspicion(0.3, kLeastRefusedTracks), 0.05, 1e-3);
  EXPECT_GT(FalseSuspicion(0.3, kLeastRefusedTracks - 1), 0.06);
  EXPECT_LT(FalseSuspicion(0.2, kLeastRefusedGnssRows), 0.05);
  EXPECT_GT(FalseSuspicion(0.2, kLeastRefusedGnssRows - 1), 0.05);
}

}  // namespace
}  // namespace alidade
