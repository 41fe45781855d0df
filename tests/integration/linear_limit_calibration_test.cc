#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <ostream>
#include <string>
#include <tuple>

#include "tests/integration/linear_limit.h"
#include "tests/integration/term_solution.h"
#include "tests/support/jacobian_checker.h"

// The linear limit (tests/integration/linear_limit_test.cc) with a camera that is calibrated online.

namespace alidade::test {
namespace {

struct Estimated {
  std::string name;
  bool extrinsics = false;
  bool intrinsics = false;
  bool line_delay = false;
  bool time_offset = false;
};

void PrintTo(const Estimated& estimated, std::ostream* out) {
  *out << estimated.name;
}

const Estimated kExtrinsics = {.name = "extrinsics", .extrinsics = true};
const Estimated kIntrinsics = {.name = "intrinsics", .intrinsics = true};
const Estimated kLineDelay = {.name = "line_delay", .line_delay = true};
const Estimated kTimeOffset = {.name = "time_offset", .time_offset = true};
const Estimated kAll = {"all", true, true, true, true};

class LinearLimitCalibrationTest : public testing::TestWithParam<std::tuple<ErrorConvention, Estimated>> {};

double DeviationDifference(const CalibrationEstimate& a, const CalibrationEstimate& b) {
  return (a.deviations.cwiseQuotient(b.deviations).array() - 1).abs().maxCoeff();
}

void ExpectAgreement(const Ends& a, const Ends& b, double correction) {
  ASSERT_TRUE(a.calibration);
  EXPECT_LT(MeanDifference(a.state, b.state), 1e-6 * correction);
  EXPECT_LT(RelativeDifference(a.state.covariance, b.state.covariance), 1e-6);
  EXPECT_LT(MeanDifference(*a.calibration, *b.calibration), 1e-6 * correction);
  EXPECT_LT(DeviationDifference(*a.calibration, *b.calibration), 1e-6);
}

// GIVEN a camera that is off by a little of what the configuration admits WHEN it is estimated, THEN state
// and camera end with the solution of the smoother's terms to a millionth of their correction.
//
// With a time offset the smoother, and a filter that updates before the last frame, place later frames where
// the offset then estimated has them, in whole nanoseconds: 1e-7 of its deviation, a third of the errors
// here. So only what updates once, at the end, is compared.
TEST_P(LinearLimitCalibrationTest, FilterSmootherAndTermsAgree) {
  constexpr double kScale = 3e-7;
  const Estimated& estimated = std::get<1>(GetParam());
  EstimatorConfig config = MakeConfig(std::get<0>(GetParam()));
  config.smoother.solve_to_rounding = true;
  config.calibration.extrinsics = estimated.extrinsics;
  config.calibration.intrinsics = estimated.intrinsics;
  config.calibration.line_delay = estimated.line_delay;
  config.calibration.time_offset = estimated.time_offset;
  const OneWindow window =
      MakeWindow(kScale, {.calibration = config.calibration, .staggered = !estimated.time_offset});
  const CalibrationEstimate given =
      InitialCalibration(config.calibration, GivenCamera(window.rig, config.vision));
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const TermSolution terms(window, config, landmark);
    const Ends solved = {terms.Newest(), {}, terms.Calibration()};
    const double camera_correction = MeanDifference(given, *solved.calibration);
    EXPECT_GT(camera_correction, 0.1 * kScale);
    const double correction = std::hypot(MeanDifference(window.carried, solved.state), camera_correction);
    for (const double share : solved.calibration->deviations.cwiseQuotient(given.deviations)) {
      EXPECT_LT(share, 0.97) << "each coordinate is observed";
    }
    if (!estimated.time_offset) {
      SCOPED_TRACE("smoother");
      ExpectAgreement(test::Run(window, MakeSmoother(landmark, config, window.rig).get()), solved,
                      correction);
    }
    for (const FilterCase& filter : FilterCases()) {
      if (estimated.time_offset && (filter.slam_features > 0 || filter.memory != TrackMemoryPolicy::kNone)) {
        continue;
      }
      SCOPED_TRACE(Name(filter, landmark));
      ExpectAgreement(test::Run(window, MakeFilter(filter, config, window.rig).get()), solved, correction);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Conventions, LinearLimitCalibrationTest,
                         testing::Combine(testing::ValuesIn(kAllConventions),
                                          testing::Values(kExtrinsics, kIntrinsics, kLineDelay, kTimeOffset,
                                                          kAll)),
                         [](const auto& item) {
                           return std::string(ToString(std::get<0>(item.param))) + "_" +
                                  std::get<1>(item.param).name;
                         });

}  // namespace
}  // namespace alidade::test
