#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "smoother/solve/vision_terms.h"
#include "smoother/tracks/track_landmark.h"
#include "tests/smoother/solve/ceres_view.h"
#include "tests/smoother/window/calibrated_window.h"
#include "tests/support/jacobian_checker.h"

// Terms with eliminated landmarks as Ceres has them, and what is used of its last evaluation.

namespace alidade::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A window of six frames, whose rows in Ceres are several groups, with landmarks of the present states.
struct LongWindow : WindowFixture {
  explicit LongWindow(bool calibrated) : WindowFixture(6, 6, 20, 1.0) {
    if (calibrated) {
      const CalibrationEstimate estimate = CalibrateWindow(this);
      calibration = {estimate.layout, estimate.mean};
    }
    const std::vector<FrameGeometry> geometry = MakeGeometry(window, calibration.mean);
    for (auto& [id, track] : window.tracks()) {
      EXPECT_TRUE(SolveLandmark(track.views, geometry, {}, 30, &track.landmark));
    }
  }
  /// Every second track, from the first or the second on.
  [[nodiscard]] std::vector<const WindowTrack*> Half(std::size_t first) const {
    std::vector<const WindowTrack*> half;
    for (std::size_t i = first; i < tracks().size(); i += 2) {
      half.push_back(tracks()[i]);
    }
    return half;
  }
};

// GIVEN two terms with eliminated landmarks THEN in Ceres they are one triangle of rows with the information,
// the gradient and the cost of both, without the columns of a calibration that is not estimated there.
TEST(ReducedRowsTest, EliminatedLandmarksOfAllTermsAreOneTriangle) {
  const LongWindow fixture(true);
  const WindowCalibration held{{}, fixture.calibration.mean};
  PoseOnlyTerm one(fixture.window, fixture.Half(0), fixture.calibration, {});
  PoseOnlyTerm other(fixture.window, fixture.Half(1), fixture.calibration, {});
  for (const ErrorConvention convention : kAllConventions) {
    SCOPED_TRACE(ToString(convention));
    CeresView ceres_view(convention, fixture.window.frames(), held);
    ceres_view.Add(&one);
    ceres_view.Add(&other);
    std::vector<TermPart> parts = one.parts();
    ASSERT_EQ(parts.back().of.kind, Unknown::Kind::kCalibration);
    parts.pop_back();
    ceres_view.SetColumns(parts);
    VectorXd residual;
    const MatrixXd jacobian = ceres_view.Jacobian(&residual);
    EXPECT_EQ(jacobian.rows(), kStateColumns + 5 * kPoseColumns + 1);
    const MatrixXd chart = ceres_view.Chart(parts);
    const Eigen::Index size = chart.rows();
    ASSERT_LT(size, one.system().hessian.rows());
    const MatrixXd canonical = (one.system().hessian + other.system().hessian).topLeftCorner(size, size);
    const MatrixXd sum = canonical.selfadjointView<Eigen::Lower>();
    EXPECT_TRUE((jacobian.transpose() * jacobian).isApprox(chart.transpose() * sum * chart, 1e-9));
    const VectorXd slope = chart.transpose() * (one.system().gradient + other.system().gradient).head(size);
    EXPECT_TRUE((jacobian.transpose() * residual).isApprox(slope, 1e-9));
    EXPECT_NEAR(2 * ceres_view.Cost(), one.system().robust_cost + other.system().robust_cost, 1e-6);
  }
}

// GIVEN tracks whose landmarks Ceres has solved for WHEN some are removed THEN what is left is the system of
// the others, and the landmarks are of no use once the window has moved.
TEST(ReducedRowsTest, RemovedTracksLeaveTheSystemOfTheOthers) {
  for (const bool calibrated : {false, true}) {
    LongWindow fixture(calibrated);
    PoseOnlyTerm term(fixture.window, fixture.tracks(), fixture.calibration, {});
    EXPECT_TRUE(term.SolvedLandmarks().empty());
    CeresView ceres_view(ErrorConvention::kSo3xRn, fixture.window.frames(), fixture.calibration);
    ceres_view.Add(&term);
    VectorXd residual;
    (void)ceres_view.Jacobian(&residual);
    const std::vector<double> no_error(CalibrationLayout::kMaxSize, 0);
    CameraCalibration solved;
    ASSERT_TRUE(fixture.calibration.At(no_error.data(), &solved));
    fixture.calibration.mean = solved;  // as a solve leaves it
    ASSERT_EQ(term.SolvedLandmarks().size(), fixture.tracks().size());
    for (std::size_t i = 0; i < fixture.tracks().size(); ++i) {
      EXPECT_TRUE(term.SolvedLandmarks()[i]->isApprox(fixture.tracks()[i]->landmark, 1e-6));
    }
    term.Remove(fixture.Half(0));
    EXPECT_EQ(term.used(), fixture.Half(1));
    const PoseOnlyTerm others(fixture.window, fixture.Half(1), fixture.calibration, {});
    EXPECT_TRUE(term.system().hessian.isApprox(others.system().hessian, 1e-9));
    EXPECT_TRUE(term.system().gradient.isApprox(others.system().gradient, 1e-6));
    EXPECT_NEAR(term.system().chi2, others.system().chi2, 1e-6);
    EXPECT_EQ(term.system().dof, others.system().dof);
    EXPECT_EQ(term.system().tracks, others.system().tracks);
    fixture.window.frame(3).nav[4] += 0.01;
    EXPECT_TRUE(term.SolvedLandmarks().empty());
    fixture.window.frame(3).nav[4] -= 0.01;
    fixture.calibration.mean.time_offset_s += 1e-4;
    EXPECT_TRUE(term.SolvedLandmarks().empty());
  }
}

}  // namespace
}  // namespace alidade::test
