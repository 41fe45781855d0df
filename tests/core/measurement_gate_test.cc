#include "core/measurement_gate.h"

#include <gtest/gtest.h>

#include <limits>

namespace alidade {
namespace {

TEST(MeasurementGateTest,
     GIVEN_wrong_measurements_WHEN_they_are_few_THEN_they_are_refused_and_else_scaled_to_the_gate) {
  MeasurementGate gate(3, 0.999, 2, {RobustKernel::kNone, 3});
  const double threshold = ChiSquareQuantile(3, 0.999);
  EXPECT_EQ(gate.Weigh(0.9 * threshold), 1);
  EXPECT_EQ(gate.Weigh(100), 0);
  EXPECT_EQ(gate.Weigh(100), 0);
  EXPECT_DOUBLE_EQ(gate.Weigh(100), threshold / 100);
  EXPECT_EQ(gate.Weigh(1), 1);
  EXPECT_EQ(gate.Weigh(100), 0);
  gate.Weigh(100);
  gate.Reset();
  EXPECT_EQ(gate.Weigh(100), 0);
  gate.Weigh(100);
  EXPECT_EQ(gate.Weigh(std::numeric_limits<double>::quiet_NaN()), 0);
}

TEST(MeasurementGateTest, GIVEN_Hubers_kernel_THEN_a_measurement_beyond_its_scale_counts_less) {
  MeasurementGate gate(3, 0.999, 5, {RobustKernel::kHuber, 2});
  EXPECT_EQ(gate.Weigh(4), 1);
  EXPECT_DOUBLE_EQ(gate.Weigh(9), 2.0 / 3);
}

TEST(MeasurementGateTest, GIVEN_one_row_THEN_its_NIS_is_the_square_over_the_variance_of_the_innovation) {
  Eigen::Matrix<double, 1, 15> jacobian = Eigen::Matrix<double, 1, 15>::Zero();
  jacobian(0, 4) = 2;
  const Matrix15d covariance = 0.5 * Matrix15d::Identity();
  const Eigen::Matrix<double, 1, 1> residual(3.0);
  EXPECT_DOUBLE_EQ(InnovationNis<1>(residual, jacobian, covariance), 9.0 / 3);
}

}  // namespace
}  // namespace alidade
