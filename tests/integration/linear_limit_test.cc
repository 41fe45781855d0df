#include "tests/integration/linear_limit.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "tests/integration/term_solution.h"
#include "tests/support/jacobian_checker.h"

// One window without marginalisation is one least-squares problem. The filter linearises it once and the
// smoother until it converges, so that they differ by the curvature over the errors alone: where the errors
// vanish against the assumed deviations, both must end with the same mean and the same covariance.

namespace alidade {
namespace {

using test::Estimate;
using test::ExpectFiltersAgree;
using test::FilterCase;
using test::FilterCases;
using test::kSmootherLandmarks;
using test::kTracks;
using test::MakeConfig;
using test::MakeFilter;
using test::MakeSmoother;
using test::MakeWindow;
using test::MeanDifference;
using test::Name;
using test::OneWindow;
using test::RelativeDifference;
using test::TermSolution;

class LinearLimitTest : public testing::TestWithParam<ErrorConvention> {};

// GIVEN equal starts, IMU samples and tracks whose errors are small WHEN the filter has read one window and
// the smoother's terms of it are solved, THEN the newest states agree to a millionth: the means relative to
// the correction by the measurements, the covariances relative to themselves; whichever way either of them
// treats landmarks.
TEST_P(LinearLimitTest, FilterAgreesWithTheSolutionOfTheSmoothersTerms) {
  const OneWindow window = MakeWindow(1e-6);
  const EstimatorConfig config = MakeConfig(GetParam());
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const NavEstimate solved = TermSolution(window, config, landmark).Newest();
    const double correction = MeanDifference(window.carried, solved);
    EXPECT_GT(correction, 1e-6) << "vision has something to correct";
    EXPECT_GT(RelativeDifference(window.carried.covariance, solved.covariance), 1) << "and is informative";
    ExpectFiltersAgree(window, config, landmark, solved, correction);
  }
}

// GIVEN position fixes at some of the frames besides, THEN the same holds, and the smoother itself, its
// solver going on to the minimum, ends there too.
TEST_P(LinearLimitTest, FilterSmootherAndTermsAgreeOnPositionFixes) {
  const OneWindow window = MakeWindow(1e-6, {.with_fixes = true});
  ASSERT_EQ(window.fixes.size(), 3u);
  EstimatorConfig config = MakeConfig(GetParam());
  config.smoother.solve_to_rounding = true;
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const NavEstimate solved = TermSolution(window, config, landmark).Newest();
    const NavEstimate without = TermSolution(MakeWindow(1e-6), config, landmark).Newest();
    EXPECT_GT(RelativeDifference(without.covariance, solved.covariance), 0.1) << "the fixes are informative";
    const double correction = MeanDifference(window.carried, solved);
    const NavEstimate smoothed = Estimate(window, MakeSmoother(landmark, config, window.rig).get());
    EXPECT_LT(MeanDifference(smoothed, solved), 1e-6 * correction);
    EXPECT_LT(RelativeDifference(smoothed.covariance, solved.covariance), 1e-6);
    ExpectFiltersAgree(window, config, landmark, solved, correction);
  }
}

// GIVEN a rig that stands still, whose tracks have no parallax and are left out by both, WHEN rest is
// measured, THEN both end with the same mean and covariance.
TEST_P(LinearLimitTest, FilterAgreesWithTheSmootherAtRest) {
  const OneWindow window = test::MakeWindowAtRest(1e-6);
  EstimatorConfig config = MakeConfig(GetParam());
  config.vision.rest_updates = true;
  config.vision.max_relative_depth_deviation = 0.1;
  config.smoother.keyframe_min_tracked = 0;  // no assumed depths
  config.smoother.solve_to_rounding = true;
  const std::unique_ptr<Estimator> smoother = MakeSmoother(SmootherLandmark::kPoseOnly, config, window.rig);
  const std::unique_ptr<Estimator> filter = MakeFilter(FilterCases()[0], config, window.rig);
  const NavEstimate smoothed = Estimate(window, smoother.get());
  const NavEstimate filtered = Estimate(window, filter.get());
  for (const Estimator* estimator : {smoother.get(), filter.get()}) {
    EXPECT_TRUE(estimator->last_statistics().at_rest);
    EXPECT_EQ(estimator->last_statistics().features_used, 0);
  }
  EXPECT_GT(RelativeDifference(window.carried.covariance, smoothed.covariance), 1) << "rest is informative";
  EXPECT_LT(MeanDifference(filtered, smoothed), 1e-6 * MeanDifference(window.carried, smoothed));
  EXPECT_LT(RelativeDifference(filtered.covariance, smoothed.covariance), 1e-6);
}

// GIVEN the window of IMU and vision, THEN the smoother itself ends with that covariance, and, its solver
// going on to the minimum, with that mean to a millionth of the correction. As shipped, its solver stops
// within a millionth of a deviation and a hundredth of the correction.
TEST_P(LinearLimitTest, FilterAgreesWithTheSmoother) {
  const OneWindow window = MakeWindow(1e-6);
  const EstimatorConfig config = MakeConfig(GetParam());
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const std::unique_ptr<Estimator> smoother = MakeSmoother(landmark, config, window.rig);
    const NavEstimate smoothed = Estimate(window, smoother.get());
    EXPECT_EQ(smoother->last_statistics().features_used, kTracks);
    EstimatorConfig to_rounding = config;
    to_rounding.smoother.solve_to_rounding = true;
    const NavEstimate minimum = Estimate(window, MakeSmoother(landmark, to_rounding, window.rig).get());
    for (const FilterCase& filter : FilterCases()) {
      SCOPED_TRACE(Name(filter, landmark));
      const NavEstimate filtered = Estimate(window, MakeFilter(filter, config, window.rig).get());
      EXPECT_LT(MeanDifference(filtered, smoothed), 1e-6);
      EXPECT_LT(MeanDifference(filtered, smoothed), 0.01 * MeanDifference(window.carried, smoothed));
      EXPECT_LT(MeanDifference(filtered, minimum), 1e-6 * MeanDifference(window.carried, smoothed));
      EXPECT_LT(RelativeDifference(filtered.covariance, smoothed.covariance), 1e-6);
    }
  }
}

// GIVEN data without any error, THEN both linearise at the same point: the covariances agree to rounding.
TEST_P(LinearLimitTest, WithoutErrorsTheCovariancesAreTheSame) {
  const OneWindow window = MakeWindow(0);
  const EstimatorConfig config = MakeConfig(GetParam());
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const NavEstimate smoothed = Estimate(window, MakeSmoother(landmark, config, window.rig).get());
    for (const FilterCase& filter : FilterCases()) {
      const NavEstimate filtered = Estimate(window, MakeFilter(filter, config, window.rig).get());
      EXPECT_LT(MeanDifference(filtered, smoothed), 1e-9) << Name(filter, landmark);
      EXPECT_LT(RelativeDifference(filtered.covariance, smoothed.covariance), 1e-9) << Name(filter, landmark);
    }
  }
}

// GIVEN errors ten times as small, THEN the difference of the covariances is: what is left is the point of
// linearisation, to first order.
TEST_P(LinearLimitTest, TheDifferenceVanishesWithTheErrors) {
  const auto difference = [&](const FilterCase& filter, double scale) {
    const OneWindow window = MakeWindow(scale);
    const EstimatorConfig config = MakeConfig(GetParam());
    const NavEstimate smoothed =
        Estimate(window, MakeSmoother(SmootherLandmark::kPoseOnly, config, window.rig).get());
    const NavEstimate filtered = Estimate(window, MakeFilter(filter, config, window.rig).get());
    return RelativeDifference(filtered.covariance, smoothed.covariance);
  };
  for (const FilterCase& filter : FilterCases()) {
    EXPECT_NEAR(difference(filter, 1e-3) / difference(filter, 1e-2), 0.1, 0.02) << filter.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Conventions, LinearLimitTest, testing::ValuesIn(test::kAllConventions),
                         [](const auto& item) { return std::string(ToString(item.param)); });

}  // namespace
}  // namespace alidade
