#include "smoother/factors/measurement_factor.h"

#include <gtest/gtest.h>

#include <array>

#include "core/imu_propagation.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using test::RandomStates;

const Vector3d kGravity = GravityInWorld(9.81);

using FixFactor = MeasurementFactor<FixMeasurement>;

/// A fix `steps` samples of 5 ms after the frame.
FrameMeasurement MakeFix(RandomStates* random, int steps) {
  FrameMeasurement fix;
  const Eigen::Matrix3d root = Eigen::Matrix3d::NullaryExpr([&] { return random->Uniform(-1, 1); });
  const PositionFix measured{0, 0, random->Vector(5),
                             root * root.transpose() + 0.1 * Eigen::Matrix3d::Identity()};
  fix.measurement = *MakeFixMeasurement({}, random->Vector(1), measured);
  for (int i = 0; steps > 0 && i <= steps; ++i) {
    fix.imu.push_back({i * 5'000'000LL, random->Vector(0.5), Vector3d(0, 0, 9.81) + random->Vector(1)});
  }
  if (steps > 0) {
    fix.preintegration.emplace(random->Bias(), ImuNoise());
    fix.preintegration->Add(fix.imu);
  }
  return fix;
}

Vector3d Residual(const FixFactor& factor, const NavState& nav, const ImuBias& bias) {
  std::array<double, kNavAmbientSize> nav_block{};
  std::array<double, 6> bias_block{};
  PackNavState(nav, nav_block.data());
  PackBias(bias, bias_block.data());
  const double* parameters[] = {nav_block.data(), bias_block.data()};
  Vector3d residual;
  EXPECT_TRUE(factor.Evaluate(parameters, residual.data(), nullptr));
  return residual;
}

TEST(MeasurementFactorTest,
     GIVEN_a_fix_at_or_after_the_frame_THEN_the_Jacobian_is_that_of_differences_in_all_conventions) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    RandomStates random(seed);
    const FrameMeasurement fix = MakeFix(&random, seed % 2 == 0 ? 0 : 30);
    const FixFactor factor(&fix, kGravity);
    const NavState nav = random.Nav(5);
    // Away from the bias of the integration its correction is of first order.
    const ImuBias bias = fix.preintegration ? fix.preintegration->bias() : random.Bias();
    std::array<double, kNavAmbientSize> nav_block{};
    std::array<double, 6> bias_block{};
    PackNavState(nav, nav_block.data());
    PackBias(bias, bias_block.data());
    const double* parameters[] = {nav_block.data(), bias_block.data()};
    Eigen::Matrix<double, 3, 9, Eigen::RowMajor> by_nav;
    Eigen::Matrix<double, 3, 6, Eigen::RowMajor> by_bias;
    double* jacobians[] = {by_nav.data(), by_bias.data()};
    Vector3d residual;
    ASSERT_TRUE(factor.Evaluate(parameters, residual.data(), jacobians));
    EXPECT_EQ(residual, Residual(factor, nav, bias));
    Eigen::Matrix<double, 3, 15> jacobian;
    jacobian << by_nav, by_bias;
    for (const ErrorConvention convention : test::kAllConventions) {
      const auto displaced = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        return Residual(factor, Retract(convention, nav, xi.head<9>()),
                        {bias.gyro + xi.segment<3>(9), bias.accel + xi.segment<3>(12)});
      };
      EXPECT_EQ(test::CompareJacobians(jacobian * ImuChartJacobian(convention, nav),
                                       test::NumericJacobian(displaced, 15), 1e-6),
                "")
          << ToString(convention) << " seed " << seed;
    }
  }
}

TEST(MeasurementFactorTest, GIVEN_a_fix_where_the_IMU_leads_THEN_it_leaves_no_residual) {
  RandomStates random(5);
  FrameMeasurement fix = MakeFix(&random, 40);
  const NavState nav = random.Nav(5);
  const ImuBias bias = fix.preintegration->bias();
  NavEstimate carried;
  carried.nav = nav;
  carried.bias = bias;
  ASSERT_TRUE(PropagateEstimate(fix.imu, ImuNoise(), kGravity, &carried).ok());
  FixMeasurement& measurement = std::get<FixMeasurement>(fix.measurement);
  measurement.model.p_WA = measurement.model.Predict(carried.nav);
  const FixFactor factor(&fix, kGravity);
  const Eigen::Matrix3d root = measurement.sqrt_information;
  EXPECT_LT((root.inverse() * Residual(factor, nav, bias)).norm(), 1e-9);
}

}  // namespace
}  // namespace alidade
