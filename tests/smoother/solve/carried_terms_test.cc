#include "smoother/solve/carried_terms.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <vector>

#include "tests/smoother/factors/slam_fixture.h"
#include "tests/smoother/solve/carried_prior.h"
#include "tests/smoother/solve/ceres_view.h"

namespace alidade::test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A prior in its own chart to the canonical one. Precondition: the states are its origins.
void ToCanonical(const StateChart& prior, const Window& window, LinearTerm* linear) {
  ASSERT_EQ(linear->chart, LinearTerm::Chart::kPrior);
  for (const TermPart& part : linear->parts) {
    if (part.of.kind == Unknown::Kind::kFrame) {
      const Matrix15d chart = InverseImuChartJacobian(
          prior.convention, prior.FromCentre(window.frame(part.of.index).nav_state()));
      const MatrixXd columns = linear->jacobian.middleCols(part.first, part.width);
      linear->jacobian.middleCols(part.first, part.width) =
          columns * chart.topLeftCorner(part.width, part.width);
    }
  }
  linear->chart = LinearTerm::Chart::kCanonical;
}

// GIVEN a prior over states, a clock and a calibration, THEN carried into the next prior it has the rows of
// its factor; and where the states have moved, still the residual of its factor, with the Jacobian it was
// made with.
TEST(CarriedTermsTest, APriorHasTheRowsOfItsFactor) {
  for (const ErrorConvention convention : kAllConventions) {
    GnssFixture fixture(4);
    const LinearPrior prior = PriorWithoutTheOldest(convention, &fixture);
    const std::vector<FrameGeometry> geometry;
    const CarriedPrior carried(prior, prior.chart, fixture.window, fixture.calibration, {}, geometry);
    const std::unique_ptr<WindowTerm> factor = MakePriorTerm(prior, fixture.calibration);
    LinearTerm own;
    LinearTerm expected;
    ASSERT_TRUE(carried.Linearize(&own).ok());
    ASSERT_TRUE(factor->Linearize(&expected).ok());
    EXPECT_EQ(own.jacobian, prior.jacobian);
    EXPECT_LT((own.residual - expected.residual).norm(), 1e-12 * (1 + expected.residual.norm()));
    ToCanonical(prior.chart, fixture.window, &own);
    EXPECT_EQ(CompareJacobians(own.jacobian, expected.jacobian, 1e-11), "");

    Disturb(&fixture);
    (*fixture.window.frame(0).clock)[0] += 2;
    VectorXd shift = VectorXd::Constant(fixture.calibration.size(), 1e-3);
    ASSERT_TRUE(Retract(fixture.calibration.layout, shift, &fixture.calibration.mean));
    const VectorXd before = expected.residual;
    ASSERT_TRUE(carried.Linearize(&own).ok());
    ASSERT_TRUE(factor->Linearize(&expected).ok());
    EXPECT_EQ(own.jacobian, prior.jacobian);
    EXPECT_GT((expected.residual - before).norm(), 0.1);
    EXPECT_LT((own.residual - expected.residual).norm(), 1e-12 * (1 + expected.residual.norm()));
  }
}

struct Case {
  ErrorConvention convention;
  bool calibrated;
  double scale;
};
std::vector<Case> Cases() {
  std::vector<Case> cases;
  for (const ErrorConvention convention : kAllConventions) {
    for (const bool calibrated : {false, true}) {
      cases.push_back({convention, calibrated, 1});
      if (StateChart{convention, Eigen::Vector3d::UnitX()}.TurnOfCentre({convention}).isZero()) {
        cases.push_back({convention, calibrated, 1.1});
      }
    }
  }
  return cases;
}

/// Another size of a window.
void Scale(double scale, Window* window) {
  for (int i = 0; i < window->size(); ++i) {
    NavState state = window->frame(i).nav_state();
    state.p_WB *= scale;
    PackNavState(state, window->frame(i).nav.data());
  }
}

// GIVEN a prior with landmarks, THEN the carried prior and the terms of the landmarks' views are, once the
// landmarks are eliminated, what the solver has of them; and so at another size of the window, where the
// Jacobian of the poses' errors does not depend on the positions.
TEST(CarriedTermsTest, PriorAndViewsAreTheSlamPrior) {
  for (const auto& [convention, calibrated, scale] : Cases()) {
    SlamFixture fixture(3, convention, calibrated, {3, 4});
    const LinearPrior prior = fixture.Leave();
    Window& window = fixture.window;
    Scale(scale, &window);
    const SlamPriorTerm term(prior, window, fixture.calibration, ObservationKernel{});
    LinearTerm reduced;
    ASSERT_TRUE(term.Linearize(&reduced).ok());
    std::vector<PriorLandmark> landmarks;
    for (const WindowTrack* track : PriorTracks(prior, window)) {
      const auto i = static_cast<Index>(landmarks.size());
      window.tracks().at(track->id).landmark = term.Landmarks()->segment<3>(3 * i);
      landmarks.push_back({track, static_cast<int>(i)});
    }
    const ColumnMap columns =
        PriorColumns(window.size(), false, fixture.calibration.size(), landmarks.size());
    MatrixXd hessian = MatrixXd::Zero(columns.size(), columns.size());
    VectorXd gradient = VectorXd::Zero(columns.size());
    const std::vector<FrameGeometry> geometry = fixture.Geometry();
    LinearTerm linear;
    ASSERT_TRUE(CarriedPrior(prior, prior.chart, window, fixture.calibration, landmarks, geometry)
                    .Linearize(&linear)
                    .ok());
    ToCanonical(prior.chart, window, &linear);
    linear.AddTo(columns, &hessian, &gradient);
    for (const PriorLandmark& landmark : landmarks) {
      for (const WindowView& view : landmark.track->views) {
        const AnchoredViewTerm seen(geometry, fixture.calibration, {}, *landmark.track, view,
                                    landmark.number);
        ASSERT_TRUE(seen.Linearize(&linear).ok());
        ASSERT_EQ(linear.residual.size(), 2);
        linear.AddTo(columns, &hessian, &gradient);
      }
    }
    hessian.triangularView<Eigen::StrictlyUpper>() = hessian.transpose();
    const Index size = 3 * static_cast<Index>(landmarks.size());
    const Index states = columns.size() - size;
    const MatrixXd gain =
        hessian.bottomRightCorner(size, size).ldlt().solve(hessian.bottomLeftCorner(size, states));
    const MatrixXd schur =
        hessian.topLeftCorner(states, states) - gain.transpose() * hessian.bottomLeftCorner(size, states);
    const VectorXd slope = gradient.head(states) - gain.transpose() * gradient.tail(size);
    const MatrixXd of_solver = reduced.hessian.selfadjointView<Eigen::Lower>();
    EXPECT_LT((schur - of_solver).norm(), 1e-7 * of_solver.norm());
    EXPECT_LT((slope - reduced.gradient).norm(), 1e-6 * reduced.gradient.norm());
  }
}

// GIVEN a landmark at the camera of its anchor, which one of a view's two sides sees, THEN the view has no
// rows where the landmark lies behind it.
TEST(CarriedTermsTest, AViewBehindHasNoRows) {
  SlamFixture fixture(3, ErrorConvention::kRightInvariant, false, {3});
  const std::vector<FrameGeometry> geometry = fixture.Geometry();
  WindowTrack track = *fixture.change.after.front();
  const AnchoredViewTerm term(geometry, fixture.calibration, {}, track, track.views.front(), 0);
  LinearTerm linear;
  ASSERT_TRUE(term.Linearize(&linear).ok());
  EXPECT_EQ(linear.residual.size(), 2);
  Index rows = 0;
  for (const double side : {-1e4, 1e4}) {
    track.landmark.z() = side;
    ASSERT_TRUE(term.Linearize(&linear).ok());
    rows += linear.residual.size();
  }
  EXPECT_EQ(rows, 2);
}

}  // namespace
}  // namespace alidade::test
