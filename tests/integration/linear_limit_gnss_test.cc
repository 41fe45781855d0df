#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "tests/integration/linear_limit.h"
#include "tests/integration/term_solution.h"
#include "tests/integration/window_epochs.h"
#include "tests/support/jacobian_checker.h"

// The linear limit (tests/integration/linear_limit_test.cc) with raw GNSS: pseudoranges, range rates and the
// receiver's clock.

namespace alidade::test {
namespace {

constexpr double kWalk = 1;  // of clock, drift and biases, a root of a second

/// No kernel; the gate passes all that the model explains.
EstimatorConfig GnssConfigOf(ErrorConvention convention) {
  EstimatorConfig config = MakeConfig(convention);
  config.smoother.solve_to_rounding = true;
  config.gnss.enabled = true;
  config.gnss.corrections.ionosphere = IonosphereMode::kNone;
  config.gnss.robust_kernel = RobustKernel::kNone;
  config.gnss.gate_probability = 1 - 1e-9;
  config.gnss.clock_walk_m_sqrts = kWalk;
  config.gnss.drift_walk_mps_sqrts = kWalk;
  config.gnss.inter_system_walk_m_sqrts = kWalk;
  return config;
}

/// The start knows its position no better than a pseudorange does.
OneWindow GnssWindowOf(const EstimatorConfig& config, double scale) {
  OneWindow window = MakeWindow(scale, {.start_position_std_m = 5});
  AddEpochs(config.gnss, scale, &window);
  return window;
}

Ends Solve(const OneWindow& window, const EstimatorConfig& config, SmootherLandmark landmark) {
  const TermSolution terms(window, config, landmark);
  return {terms.Newest(), terms.Clock(), {}};
}

struct Bounds {
  double means;
  double state_covariance;
  double clock_covariance;
};

void ExpectAgreement(const Ends& a, const Ends& b, const Bounds& bounds) {
  ASSERT_TRUE(a.clock);
  EXPECT_LT(MeanDifference(a.state, b.state), bounds.means);
  EXPECT_LT(MeanDifference(*a.clock, *b.clock), bounds.means);
  EXPECT_LT(RelativeDifference(a.state.covariance, b.state.covariance), bounds.state_covariance);
  EXPECT_LT(RelativeDifference(a.clock->covariance, b.clock->covariance), bounds.clock_covariance);
}

void ExpectAllAgree(const OneWindow& window, const EstimatorConfig& config, SmootherLandmark landmark,
                    const Ends& solved, const Bounds& bounds) {
  {
    SCOPED_TRACE("smoother");
    ExpectAgreement(test::Run(window, MakeSmoother(landmark, config, window.rig).get()), solved, bounds);
  }
  for (const FilterCase& filter : FilterCases()) {
    SCOPED_TRACE(Name(filter, landmark));
    ExpectAgreement(test::Run(window, MakeFilter(filter, config, window.rig).get()), solved, bounds);
  }
}

class LinearLimitGnssTest : public testing::TestWithParam<ErrorConvention> {};

// GIVEN raw GNSS at some of the frames WHEN filter and smoother have read one window, THEN state and clock of
// both are those of the smoother's terms, the means to a ten-thousandth of the correction of both. Three
// things keep it above the millionth of the other sensors; a wrong sign or scale would exceed them by far:
//   - the atmosphere is that of the predicted antenna and has no Jacobian; the zenith delay changes by
//     3e-4 m a metre of height, and filter, smoother and terms predict from different updates: some 1e-5 of
//     the correction, whatever the scale of the errors;
//   - pseudoranges of 2e7 m are rounded to 4e-9 m, 1e-9 of their deviation of 5 m: 3e-6 of a correction of
//     3e-4 deviations;
//   - the curvature over these errors: below 1e-5.
// The covariances depend on the point of linearisation to first order: some ten times the scale.
TEST_P(LinearLimitGnssTest, FilterSmootherAndTermsAgree) {
  constexpr double kScale = 1e-5;
  const EstimatorConfig config = GnssConfigOf(GetParam());
  const OneWindow window = GnssWindowOf(config, kScale);
  ASSERT_EQ(window.epochs.size(), 3u);
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const Ends solved = Solve(window, config, landmark);
    ClockState carried;
    const double seconds = SecondsBetween(window.alignment->stamp_ns, window.frames.back().stamp_ns);
    carried.mean = PropagateClock(config.gnss, seconds).phi * *window.alignment->clock;
    const double clock_correction = MeanDifference(carried, *solved.clock);
    const double state_correction = MeanDifference(window.carried, solved.state);
    EXPECT_GT(clock_correction, kScale);
    EXPECT_GT(state_correction, kScale);
    ExpectAllAgree(window, config, landmark, solved,
                   {1e-4 * std::hypot(state_correction, clock_correction), 3e-4, 3e-4});
  }
}

// GIVEN data without any error, THEN both linearise at the same point: the covariances of the state agree to
// rounding, those of the clock to the floor of 1e-8 that the smoother adds to the clock's process
// (ClockStep).
TEST_P(LinearLimitGnssTest, WithoutErrorsTheCovariancesAreTheSame) {
  constexpr double kFloor = 1e-8;
  constexpr double kFrameS = kSamplesPerFrame / kImuRateHz;
  const EstimatorConfig config = GnssConfigOf(GetParam());
  const OneWindow window = GnssWindowOf(config, 0);
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    ExpectAllAgree(window, config, landmark, Solve(window, config, landmark),
                   {1e-8, 1e-8, 1.1 * kFloor / (kWalk * kWalk * kFrameS)});
  }
}

// GIVEN pseudoranges of which it was measured that their errors are larger than stated and last over several
// epochs, THEN both back ends give them the same weight: that of white errors with as much information.
TEST_P(LinearLimitGnssTest, LastingErrorsWeighTheSameInAll) {
  const EstimatorConfig config = GnssConfigOf(GetParam());
  OneWindow as_stated = GnssWindowOf(config, 0);
  OneWindow lasting = as_stated;
  OneWindow larger = as_stated;
  for (size_t i = 0; i < lasting.epochs.size(); ++i) {
    lasting.epochs[i].measurements.noise = {
        .scale = 1.5, .lasting_variance = 2, .epochs = 10, .settled_epochs = 10};
    larger.epochs[i].measurements.noise = {.scale = 1.5, .lasting_variance = 20};
  }
  const Ends stated = Solve(as_stated, config, SmootherLandmark::kPoseOnly);
  const Ends weighed = Solve(lasting, config, SmootherLandmark::kPoseOnly);
  EXPECT_GT(RelativeDifference(weighed.state.covariance, stated.state.covariance), 0.1);
  constexpr Bounds kBounds = {1e-8, 1e-8, 1e-6};
  ExpectAgreement(weighed, Solve(larger, config, SmootherLandmark::kPoseOnly), kBounds);
  ExpectAllAgree(lasting, config, SmootherLandmark::kPoseOnly, weighed, kBounds);
}

// GIVEN pseudoranges or range rates alone, THEN each is informative about state and clock, so that the tests
// above would notice a wrong one.
TEST_P(LinearLimitGnssTest, PseudorangesAndRangeRatesAreInformative) {
  const EstimatorConfig config = GnssConfigOf(GetParam());
  const OneWindow window = GnssWindowOf(config, 0);
  const Ends both = Solve(window, config, SmootherLandmark::kPoseOnly);
  for (const bool pseudorange : {true, false}) {
    EstimatorConfig one = config;
    one.gnss.pseudorange = pseudorange;
    one.gnss.doppler = !pseudorange;
    const Ends without = Solve(window, one, SmootherLandmark::kPoseOnly);
    EXPECT_GT(RelativeDifference(without.state.covariance, both.state.covariance), 0.1) << pseudorange;
    EXPECT_GT(RelativeDifference(without.clock->covariance, both.clock->covariance), 0.1) << pseudorange;
  }
}

INSTANTIATE_TEST_SUITE_P(Conventions, LinearLimitGnssTest, testing::ValuesIn(kAllConventions),
                         [](const auto& item) { return std::string(ToString(item.param)); });

}  // namespace
}  // namespace alidade::test
