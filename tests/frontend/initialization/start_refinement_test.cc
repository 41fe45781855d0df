// The chi-squares by which the refinement accepts a solution.

#include "frontend/initialization/start_refinement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "frontend/initialization/dynamic_initializer.h"
#include "tests/frontend/initialization/start_window.h"

namespace alidade {
namespace {

using testing::HasSubstr;

TEST(StartRefinement, GIVEN_the_sheets_noise_THEN_both_chi_squares_are_about_one_in_the_mean) {
  const Dataset dataset = test::MovingSequence();
  const EstimatorConfig config;
  double inertial = 0;
  double reprojection = 0;
  int windows = 0;
  for (size_t first = 0; first + 22 < dataset.frames.size(); first += 12) {
    SCOPED_TRACE(first);
    test::StartWindow start;
    test::MakeStartWindow(config, dataset, first, &start);
    ASSERT_FALSE(HasFatalFailure());
    const Result<RefinedStart> refined =
        RefineStart(start.window, start.inlier, start.steps, start.states, start.bias, start.settings);
    if (refined.ok()) {
      inertial += refined->inertial_chi2;
      reprojection += refined->reprojection_chi2;
      ++windows;
    }
  }
  inertial /= windows;
  reprojection /= windows;
  std::cout << "  " << windows << " windows: inertial " << inertial << ", reprojection " << reprojection
            << "\n";
  ASSERT_GE(windows, 15);
  // Below one: the process noise also covers motion between samples (core/imu_vibration.h).
  EXPECT_GT(inertial, 0.5);
  EXPECT_LT(inertial, 1.2);
  EXPECT_NEAR(reprojection, 1, 0.1);
}

TEST(StartRefinement, GIVEN_specific_force_that_vision_contradicts_THEN_the_start_is_refused) {
  Dataset dataset = test::MovingSequence();
  for (ImuSample& sample : dataset.imu) {
    const double t = SecondsBetween(dataset.imu.front().stamp_ns, sample.stamp_ns);
    sample.accel.x() += 2 * std::sin(2 * M_PI * 0.8 * t);
  }
  ImuBuffer imu = test::AllSamples(dataset);
  const EstimatorConfig config;
  for (const size_t first : {20U, 60U, 100U, 140U, 200U}) {
    SCOPED_TRACE(first);
    Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
    const Result<DynamicSolution> solution =
        InitializeDynamic(config, dataset.rig, test::FramesFrom(dataset, first),
                          DynamicLimits{0.5, test::kStartWindowS}, &imu, &accel_bias);
    ASSERT_FALSE(solution.ok());
    EXPECT_THAT(solution.message(), HasSubstr("inertial chi-square"));
  }
}

}  // namespace
}  // namespace alidade
