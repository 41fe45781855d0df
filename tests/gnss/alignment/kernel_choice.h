#pragma once

#include <gtest/gtest.h>

#include "core/robust_kernel.h"

namespace alidade::test {

/// That a fit to data with residuals beyond half a deviation takes its kernel as configured. solve(kernel,
/// scale_sigma): a number that depends on the weights.
template <typename Solve>
void ExpectKernelIsTaken(const Solve& solve) {
  const double none = solve(RobustKernel::kNone, 0.5);
  const double huber = solve(RobustKernel::kHuber, 0.5);
  EXPECT_EQ(none, solve(RobustKernel::kNone, 5)) << "without a kernel its scale is nothing";
  EXPECT_NE(none, huber);
  EXPECT_NE(huber, solve(RobustKernel::kCauchy, 0.5));
}

}  // namespace alidade::test
