#include <gtest/gtest.h>

#include "core/robust.h"

namespace alidade {
namespace {

constexpr RobustKernel kKernels[] = {RobustKernel::kNone, RobustKernel::kHuber, RobustKernel::kCauchy,
                                     RobustKernel::kLogTail};

TEST(ObservationKernelTest, RhoIsTheIntegralOfTheSharedWeight) {
  for (const RobustKernel kernel : kKernels) {
    const ObservationKernel robust{kernel, 2.0};
    EXPECT_EQ(robust.Rho(0), 0);
    for (const double s : {0.1, 3.9, 4.1, 50.0}) {
      const double slope = (robust.Rho(s + 1e-5) - robust.Rho(s - 1e-5)) / 2e-5;
      EXPECT_NEAR(slope, RobustWeight(kernel, 2.0, s), 1e-6);
      EXPECT_EQ(robust.Weight(s), RobustWeight(kernel, 2.0, s));
    }
  }
}

TEST(ObservationKernelTest, SecondDerivativeIsThatOfTheCost) {
  for (const RobustKernel kernel : kKernels) {
    const ObservationKernel robust{kernel, 2.0};
    for (const double s : {0.1, 3.9, 4.1, 50.0}) {
      const double change = (robust.Weight(s + 1e-5) - robust.Weight(s - 1e-5)) / 2e-5;
      EXPECT_NEAR(robust.SecondDerivative(s), change, 1e-9);
      EXPECT_NEAR(robust.RadialCurvature(s), robust.Weight(s) + 2 * s * robust.SecondDerivative(s), 1e-15);
    }
  }
}

TEST(ObservationKernelTest, RadialCurvatureIsTheSecondDerivativeAlongTheResidual) {
  for (const RobustKernel kernel : kKernels) {
    const ObservationKernel robust{kernel, 2.0};
    for (const double r : {0.3, 1.9, 2.1, 7.0}) {
      constexpr double kStep = 1e-3;
      const auto half_cost = [&](double at) { return 0.5 * robust.Rho(at * at); };
      const double curvature =
          (half_cost(r + kStep) - 2 * half_cost(r) + half_cost(r - kStep)) / (kStep * kStep);
      EXPECT_NEAR(robust.RadialCurvature(r * r), curvature, 1e-5);
    }
  }
}

}  // namespace
}  // namespace alidade
