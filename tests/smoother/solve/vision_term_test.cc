#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/reprojection.h"
#include "smoother/solve/vision_terms.h"
#include "tests/smoother/factors/slam_fixture.h"
#include "tests/smoother/solve/ceres_view.h"
#include "tests/smoother/window/calibrated_window.h"
#include "tests/support/jacobian_checker.h"

// Terms with landmarks. Where they are eliminated within a term its rows are no derivative of a residual, but
// its gradient is that of the cost, and its information that of the gradient where nothing is left over.

namespace alidade::test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One over the root of the diagonal, 1 where that is zero: a step in each coordinate that costs as much.
VectorXd UnitSteps(const MatrixXd& information) {
  return information.diagonal().unaryExpr([](double x) { return x > 0 ? 1 / std::sqrt(x) : 1.0; });
}

/// The normal equations of a term over the manifolds' tangents are those of Ceres, and their gradient is that
/// of the cost. `exact`: the residuals vanish, so that the information is the derivative of the gradient.
void ExpectInformationOfCeresAndNumeric(WindowTerm* term, const WindowFrames& frames,
                                        const WindowCalibration& calibration, bool exact) {
  LinearTerm linear;
  ASSERT_TRUE(term->Linearize(&linear).ok());
  const MatrixXd canonical = linear.hessian.selfadjointView<Eigen::Lower>();
  for (const ErrorConvention convention : kAllConventions) {
    SCOPED_TRACE(ToString(convention));
    CeresView ceres_view(convention, frames, calibration);
    ceres_view.Add(term);
    const MatrixXd chart = ceres_view.Chart(linear.parts);
    const MatrixXd information = chart.transpose() * canonical * chart;
    const VectorXd unit = UnitSteps(information);
    const auto scaled = [&](const MatrixXd& of) -> MatrixXd {
      return unit.asDiagonal() * of * unit.asDiagonal();
    };
    const VectorXd gradient = unit.asDiagonal() * (chart.transpose() * linear.gradient);
    VectorXd residual;
    const MatrixXd jacobian = ceres_view.Jacobian(&residual);
    EXPECT_EQ(CompareJacobians(scaled(jacobian.transpose() * jacobian), scaled(information), 1e-6), "");
    EXPECT_EQ(CompareJacobians(unit.asDiagonal() * (jacobian.transpose() * residual), gradient, 1e-6), "");
    const int size = static_cast<int>(unit.size());
    const auto cost = [&](const VectorXd& steps) -> VectorXd {
      const VectorXd moved = ceres_view.Moved(unit.asDiagonal() * steps);
      return VectorXd::Constant(1, moved.squaredNorm() / 2);
    };
    EXPECT_EQ(CompareJacobians(gradient.transpose(), NumericJacobian(cost, size, 1e-2), 1e-5), "");
    if (exact) {
      const auto slope = [&](const VectorXd& steps) -> VectorXd {
        return unit.asDiagonal() * ceres_view.MovedGradient(unit.asDiagonal() * steps);
      };
      EXPECT_EQ(CompareJacobians(scaled(information), NumericJacobian(slope, size, 1e-1), 1e-5), "");
    }
  }
}

/// Estimates the calibration too. `exact`: frames were placed by the present time offset, as their rays were,
/// and all rows exposed at once.
void Calibrate(bool exact, WindowFixture* fixture) {
  const CalibrationEstimate estimate = CalibrateWindow(fixture);
  fixture->calibration = {estimate.layout, estimate.mean};
  for (int i = 0; exact && i < fixture->window.size(); ++i) {
    fixture->window.frame(i).time_offset_s = estimate.mean.time_offset_s;
    fixture->calibration.mean.line_delay_s = 0;
  }
}

TEST(VisionTermTest, PoseOnlyTracksAreThoseOfCeresAndNumeric) {
  for (const FixtureView seen : {FixtureView::kAhead, FixtureView::kBehind}) {
    for (const bool calibrated : {false, true}) {
      for (const bool exact : {false, true}) {
        if (calibrated && !exact && seen == FixtureView::kBehind) {
          continue;  // calibrated_window.h
        }
        WindowFixture fixture(5, 4, 12, exact ? 0 : 1, seen);
        if (calibrated) {
          Calibrate(exact, &fixture);
        }
        const std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.calibration.mean);
        for (auto& [id, track] : fixture.window.tracks()) {  // the factor solves for them
          ASSERT_TRUE(SolveLandmark(track.views, geometry, {}, 30, &track.landmark));
        }
        PoseOnlyTerm term(fixture.window, fixture.tracks(), fixture.calibration, {});
        ExpectInformationOfCeresAndNumeric(&term, fixture.window.frames(), fixture.calibration, exact);
        EXPECT_EQ(term.used().size(), fixture.tracks().size());
      }
    }
  }
}

/// Puts the views of the prior's landmarks where these are.
void MakeViewsExact(SlamFixture* fixture) {
  for (int i = 0; fixture->calibrated() && i < fixture->window.size(); ++i) {
    fixture->window.frame(i).time_offset_s = fixture->calibration.mean.time_offset_s;
  }
  const std::vector<FrameGeometry> geometry = fixture->Geometry();
  for (auto& [id, track] : fixture->window.tracks()) {
    for (WindowView& view : track.views) {
      if (track.anchor != nullptr) {
        FrameGeometry row;
        const AnchoredPointInCamera seen(geometry[static_cast<size_t>(track.anchor->index)].T_WC,
                                         AtRow(geometry, view, &row).T_WC, track.landmark, track.plane());
        view.observation.z = view.observation.plane.InAxes(seen.q).hnormalized();
        ASSERT_TRUE(!fixture->calibrated() || fixture->calibration.mean.camera.Project(seen.q, &view.pixel));
      }
    }
  }
}

TEST(VisionTermTest, APriorWithLandmarksIsThatOfCeresAndNumeric) {
  for (const ErrorConvention made_in : kAllConventions) {
    for (const FixtureView seen : {FixtureView::kAhead, FixtureView::kBehind}) {
      for (const bool calibrated : {false, true}) {
        for (const bool exact : {false, true}) {
          SCOPED_TRACE(std::string(ToString(made_in)) + (calibrated ? ", calibrated" : "") +
                       (seen == FixtureView::kBehind ? ", behind" : ""));
          if (calibrated && !exact && seen == FixtureView::kBehind) {
            continue;  // calibrated_window.h
          }
          SlamFixture fixture(6, made_in, calibrated, {2, 4}, seen);
          LinearPrior prior = fixture.Leave();
          if (exact) {
            MakeViewsExact(&fixture);
            prior.residual.setZero();
          }
          SlamPriorTerm term(prior, fixture.window, fixture.calibration, {});
          ASSERT_GT(term.slam().tracks().size(), 3u);
          ExpectInformationOfCeresAndNumeric(&term, fixture.window.frames(), fixture.calibration, exact);
        }
      }
    }
  }
}

/// Frames, calibration and the one landmark of a track: the columns of its views.
std::vector<TermPart> PartsOf(const WindowFixture& fixture) {
  std::vector<TermPart> parts;
  Index first = 0;
  const auto add = [&](const Unknown& of, Index width) {
    parts.push_back({of, first, width});
    first += width;
  };
  for (int i = 0; i < fixture.window.size(); ++i) {
    add({Unknown::Kind::kFrame, i}, kPoseColumns);
  }
  if (fixture.calibration.size() > 0) {
    add({Unknown::Kind::kCalibration, 0}, fixture.calibration.size());
  }
  add({Unknown::Kind::kLandmark, 0}, kLandmarkColumns);
  return parts;
}

/// H | g with the last three columns, the landmark's, eliminated.
MatrixXd Reduced(const MatrixXd& hessian, const VectorXd& gradient) {
  const Index kept = hessian.rows() - kLandmarkColumns;
  const MatrixXd solved = hessian.topRightCorner(kept, kLandmarkColumns) *
                          hessian.bottomRightCorner<kLandmarkColumns, kLandmarkColumns>().inverse();
  MatrixXd reduced(kept, kept + 1);
  reduced.leftCols(kept) = hessian.topLeftCorner(kept, kept) - solved * hessian.bottomLeftCorner(3, kept);
  reduced.col(kept) = gradient.head(kept) - solved * gradient.tail<kLandmarkColumns>();
  return reduced;
}

/// The rows of one view in Ceres under a kernel, and its cost.
struct ViewInCeres {
  ViewInCeres(WindowFixture* fixture, WindowTrack* track, std::size_t view, const ObservationKernel& kernel) {
    ViewTerm term(std::make_shared<const ViewContext>(fixture->window.frames(), fixture->calibration, kernel),
                  track, 0, view);
    CeresView ceres_view(ErrorConvention::kSo3xRn, fixture->window.frames(), fixture->calibration, {track});
    ceres_view.Add(&term);
    jacobian = ceres_view.Jacobian(&residual);
    cost = ceres_view.Cost();
  }

  MatrixXd jacobian;
  VectorXd residual;
  double cost = 0;
};

// GIVEN views on both sides of a kernel's bend THEN Ceres sees the kernel's cost, slope and weight. It leaves
// out a second derivative that is negative, as these are.
TEST(VisionTermTest, ViewsInCeresAreUnderTheSharedKernel) {
  int within = 0;
  int beyond = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    WindowFixture fixture(seed, 4, 8, 1.0);
    Disturb(&fixture);
    WindowTrack& track = fixture.window.tracks().begin()->second;
    for (std::size_t view = 1; view < track.views.size(); ++view) {
      const ViewInCeres plain(&fixture, &track, view, {});
      const double s = plain.residual.squaredNorm();
      for (const RobustKernel kind : {RobustKernel::kHuber, RobustKernel::kCauchy, RobustKernel::kLogTail}) {
        for (const double bend : {0.5, 2.0}) {  // of the residual's length
          const ObservationKernel kernel{kind, bend * std::sqrt(s)};
          (kernel.Weight(s) < 1 ? beyond : within) += 1;
          const ViewInCeres robust(&fixture, &track, view, kernel);
          EXPECT_NEAR(robust.cost, 0.5 * kernel.Rho(s), 1e-12 * s);
          const MatrixXd information = kernel.Weight(s) * plain.jacobian.transpose() * plain.jacobian;
          const VectorXd gradient = kernel.Weight(s) * plain.jacobian.transpose() * plain.residual;
          EXPECT_TRUE((robust.jacobian.transpose() * robust.jacobian).isApprox(information, 1e-12));
          EXPECT_TRUE((robust.jacobian.transpose() * robust.residual).isApprox(gradient, 1e-12));
        }
      }
    }
  }
  EXPECT_GE(within, 8);
  EXPECT_GE(beyond, 8);
}

// The landmark's coordinates move with the base frame in Ceres and stand still in the rows: once it is
// eliminated both give the same information on poses and calibration. In Ceres every row is numeric.
TEST(VisionTermTest, ViewsAndDepthPriorsAreThoseOfCeresAndNumeric) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    WindowFixture fixture(seed, 4, 8, 1.0, seed <= 6 ? FixtureView::kAhead : FixtureView::kBehind);
    if (seed % 2 == 0 && seed <= 6) {
      Calibrate(false, &fixture);
    }
    Disturb(&fixture);
    WindowTrack& track = fixture.window.tracks().begin()->second;
    track.depth_prior = {track.landmark.z(), 30};  // no residual, so that the chart does not matter
    WindowTerms terms;
    AddTrackTerms(fixture.window.frames(), {&track}, fixture.calibration, {}, &terms);
    ASSERT_EQ(terms.size(), track.views.size() + 1);
    const std::vector<TermPart> parts = PartsOf(fixture);
    ColumnMap columns;
    for (const TermPart& part : parts) {
      columns.Add(part.of, part.width);
    }
    MatrixXd canonical = MatrixXd::Zero(columns.size(), columns.size());
    VectorXd slope = VectorXd::Zero(columns.size());
    for (const std::unique_ptr<WindowTerm>& term : terms) {
      LinearTerm linear;
      ASSERT_TRUE(term->Linearize(&linear).ok());
      linear.AddTo(columns, &canonical, &slope);
    }
    canonical = MatrixXd(canonical.selfadjointView<Eigen::Lower>());
    for (const ErrorConvention convention : kAllConventions) {
      SCOPED_TRACE(std::string(ToString(convention)) + ", seed " + std::to_string(seed));
      CeresView ceres_view(convention, fixture.window.frames(), fixture.calibration, {&track});
      for (const std::unique_ptr<WindowTerm>& term : terms) {
        ceres_view.Add(term.get());
      }
      ceres_view.SetColumns(parts);
      VectorXd residual;
      const MatrixXd jacobian = ceres_view.Jacobian(&residual);
      const auto moved = [&](const VectorXd& delta) { return ceres_view.Moved(delta); };
      EXPECT_EQ(CompareJacobians(jacobian, NumericJacobian(moved, static_cast<int>(jacobian.cols())), 1e-7),
                "");
      const MatrixXd chart = ceres_view.Chart(parts);
      const MatrixXd of_rows = Reduced(chart.transpose() * canonical * chart, chart.transpose() * slope);
      const MatrixXd of_ceres = Reduced(jacobian.transpose() * jacobian, jacobian.transpose() * residual);
      const Index size = of_ceres.rows();
      const VectorXd unit = UnitSteps(of_ceres.leftCols(size));
      EXPECT_EQ(CompareJacobians(unit.asDiagonal() * of_rows.leftCols(size) * unit.asDiagonal(),
                                 unit.asDiagonal() * of_ceres.leftCols(size) * unit.asDiagonal(), 1e-7),
                "");
      EXPECT_EQ(CompareJacobians(unit.asDiagonal() * of_rows.col(size),
                                 unit.asDiagonal() * of_ceres.col(size), 1e-7),
                "");
    }
  }
}

}  // namespace
}  // namespace alidade::test
