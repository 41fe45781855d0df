#include "gnss/model/epoch_rows.h"

#include <gtest/gtest.h>

#include "gnss/model/receiver_clock.h"

namespace alidade {
namespace {

std::vector<GnssRow> Rows(const std::vector<double>& residuals) {
  std::vector<GnssRow> rows;
  for (const double residual : residuals) {
    GnssRow row;
    row.residual = residual;
    row.jacobian.setZero();
    rows.push_back(row);
  }
  return rows;
}

TEST(EpochRowsTest, CommonStepIsThatOfMostSatellites) {
  EXPECT_DOUBLE_EQ(CommonStep(Rows({-5, -5.5, -4.5, 80, -5})), 5);
  EXPECT_DOUBLE_EQ(CommonStep({}), 0);
}

TEST(EpochRowsTest, AJumpIsCommonLargeAndSharedByThree) {
  const GnssConfig config;
  const double jump = 299792.458;
  EXPECT_TRUE(IsClockJump(config, Rows({-jump, -jump, -jump}), jump, 1));
  EXPECT_FALSE(IsClockJump(config, Rows({-jump, -jump}), jump, 1));
  EXPECT_FALSE(IsClockJump(config, Rows({-100, -100, -100}), 100, 1));
  EXPECT_FALSE(IsClockJump(config, Rows({-jump, -jump, -jump}), jump, 1e5));
}

TEST(EpochRowsTest, AnUncertainStateExcusesNoContradictedPseudorange) {
  EXPECT_DOUBLE_EQ(NormalisedInnovation(6, 8, false), 4);
  EXPECT_DOUBLE_EQ(NormalisedInnovation(6, 8, true), 36);
}

TEST(EpochRowsTest, GateRefusesFewAndWeighsManyDown) {
  GnssConfig config;
  config.robust_kernel = RobustKernel::kNone;
  const GnssWeights few = WeighRows(config, 10, {1, 1, 1, 1, 40, 1});
  EXPECT_EQ(few.used, 5);
  EXPECT_EQ(few.refused, 1);
  EXPECT_EQ(few.weights[4], 0);
  const GnssWeights many = WeighRows(config, 10, {40, 40, 40, 40, 1, NAN});
  EXPECT_EQ(many.refused, 1);
  EXPECT_DOUBLE_EQ(many.weights[0], 0.25);
  EXPECT_EQ(many.weights[5], 0);
}

TEST(ReceiverClockTest, TwoHalfStepsAreOneStep) {
  const GnssConfig config;
  const ClockTransition half = PropagateClock(config, 0.7);
  const ClockTransition whole = PropagateClock(config, 1.4);
  EXPECT_TRUE((half.phi * half.phi).isApprox(whole.phi, 1e-14));
  EXPECT_TRUE((half.phi * half.q * half.phi.transpose() + half.q).isApprox(whole.q, 1e-12));
}

}  // namespace
}  // namespace alidade
