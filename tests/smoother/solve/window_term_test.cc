#include "smoother/solve/window_term.h"

#include <gtest/gtest.h>

#include "smoother/batch/sequence_covariance.h"
#include "smoother/solve/vision_terms.h"
#include "tests/smoother/solve/carried_prior.h"
#include "tests/smoother/solve/ceres_view.h"
#include "tests/support/jacobian_checker.h"

namespace alidade::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

void ExpectRowsOfCeres(const WindowTerms& terms, const WindowFrames& frames,
                       const WindowCalibration& calibration, double step, double tolerance) {
  for (size_t i = 0; i < terms.size(); ++i) {
    LinearTerm linear;
    ASSERT_TRUE(terms[i]->Linearize(&linear).ok());
    for (const ErrorConvention convention : kAllConventions) {
      CeresView ceres_view(convention, frames, calibration);
      ceres_view.Add(terms[i].get());
      VectorXd residual;
      const MatrixXd jacobian = ceres_view.Jacobian(&residual);
      EXPECT_LT((residual - linear.residual).norm(), 1e-12 * (1 + residual.norm())) << "term " << i;
      const MatrixXd expected = linear.jacobian * ceres_view.Chart(linear.parts);
      EXPECT_EQ(CompareJacobians(jacobian, expected, 1e-11), "") << "term " << i;
      const auto moved = [&](const VectorXd& delta) { return ceres_view.Moved(delta); };
      EXPECT_EQ(CompareJacobians(jacobian, NumericJacobian(moved, static_cast<int>(jacobian.cols()), step),
                                 tolerance),
                "")
          << "term " << i << ", " << ToString(convention);
    }
  }
}

// GIVEN a window of every sensor, THEN the rows of each term are those that Ceres has of it, and both are the
// derivatives of its residual, in every error convention.
TEST(WindowTermTest, RowsOfTheSensorsAreThoseOfCeresAndNumeric) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    GnssFixture fixture(seed);
    fixture.window.frame(1).rest =
        MakeRestMeasurement({true, true}, 5, {fixture.random.Vector(0.1), fixture.random.Vector(1)},
                            fixture.random.Vector(0.3), VisionConfig());
    for (int i = 1; i <= 2; ++i) {  // at the frame, and after it
      WindowFrame& frame = fixture.window.frame(i);
      FrameMeasurement& fix = frame.measurements.emplace_back();
      const PositionFix measured{0, 0, fixture.random.Vector(2), 0.04 * Eigen::Matrix3d::Identity()};
      fix.measurement = *MakeFixMeasurement(FixConfig(), fixture.random.Vector(0.5), measured);
      fix.Set(i == 1 ? std::vector<ImuSample>() : frame.epochs[0].imu, frame.imu_bias(), fixture.noise);
    }
    Disturb(&fixture);
    WindowTerms terms;
    ASSERT_TRUE(AddSensorTerms({fixture.gravity_W}, fixture.window.frames(), 4, &terms).ok());
    ASSERT_EQ(terms.size(), 3u + 1u + 2u);
    ExpectRowsOfCeres(terms, fixture.window.frames(), fixture.calibration, 1e-4, 1e-6);
    WindowTerms all;
    ASSERT_TRUE(AddSensorTerms({fixture.gravity_W, &fixture.context}, fixture.window.frames(), 4, &all).ok());
    ASSERT_EQ(all.size(), 6u + 4u + 3u);
    all.erase(all.begin(), all.begin() + 6);
    fixture.context.config.robust_kernel = RobustKernel::kNone;  // its kink is no derivative
    // Ranges of 2e7 m lose digits in differences.
    ExpectRowsOfCeres(all, fixture.window.frames(), fixture.calibration, 1e-2, 1e-4);
  }
}

TEST(WindowTermTest, RowsOfAPriorWithClockAndCalibrationAreThoseOfCeresAndNumeric) {
  for (const ErrorConvention made_in : kAllConventions) {
    GnssFixture fixture(4);
    const LinearPrior prior = PriorWithoutTheOldest(made_in, &fixture);
    Disturb(&fixture);
    WindowTerms terms;
    terms.push_back(MakePriorTerm(prior, fixture.calibration));
    ASSERT_EQ(terms.front()->parts().size(), 3u + 1u + 1u);
    ExpectRowsOfCeres(terms, fixture.window.frames(), fixture.calibration, 1e-4, 1e-6);
  }
}

// GIVEN frames with clocks and epochs, THEN the batch's fronts and the window have the same information on
// the last of them.
TEST(WindowTermTest, TheBatchTakesGnssTermsAsTheWindowDoes) {
  GnssFixture fixture(6);
  LinearPrior prior;
  ASSERT_TRUE(MakeInitialPrior(ErrorConvention::kRightInvariant, fixture.window.frame(0),
                               test::SomeCovariance(), &prior));
  GnssWindow gnss(fixture.context.config, {}, fixture.gravity_W);
  GnssAlignment alignment;
  alignment.enu = fixture.context.mount.enu;
  alignment.clock = Vector6d::Zero();
  gnss.Align(alignment, &fixture.window.frame(0), &prior);
  std::vector<WindowTrack*> tracks;
  for (auto& [id, track] : fixture.window.tracks()) {
    tracks.push_back(&track);
  }
  WindowTerms terms;
  terms.push_back(MakePriorTerm(prior, fixture.calibration));
  ASSERT_TRUE(AddSensorTerms({fixture.gravity_W, &fixture.context}, fixture.window.frames(), 4, &terms).ok());
  const size_t without_vision = terms.size();
  AddTrackTerms(fixture.window.frames(), tracks, fixture.calibration, {}, &terms);
  const Result<SequenceCovariance> batch =
      ComputeSequenceCovariance({fixture.window.frames(), terms}, true, true);
  ASSERT_TRUE(batch.ok()) << batch.message();
  terms.resize(without_vision);
  terms.push_back(std::make_unique<PoseOnlyTerm>(fixture.window, fixture.tracks(), fixture.calibration,
                                                 ObservationKernel{}));
  NewestEstimate newest;
  ASSERT_TRUE(NewestCovariance(fixture.window.frames(), terms, &newest));
  EXPECT_TRUE(batch->smoothed.back().isApprox(newest.covariance, 1e-6));
  EXPECT_TRUE(batch->filtered.back().isApprox(newest.covariance, 1e-6));
}

}  // namespace
}  // namespace alidade::test
