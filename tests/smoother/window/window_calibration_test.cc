#include "smoother/window/window_calibration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "smoother/factors/inverse_depth_factor.h"
#include "smoother/factors/prior_factor.h"
#include "tests/smoother/solve/ceres_view.h"
#include "tests/smoother/solve/given_terms.h"
#include "tests/smoother/window/calibrated_window.h"
#include "tests/support/jacobian_checker.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::CalibratedWindow;
using test::SomeCovariance;

constexpr int kBlock = CalibrationLayout::kMaxSize;

TEST(WindowCalibrationTest, PoseOnlyGradientIsThatOfItsCostOverPosesAndCalibration) {
  CalibratedWindow fixture(11);
  PoseOnlyTerm term(fixture.window, fixture.tracks(), fixture.calibration, {});
  test::RandomStates random(12);
  for (int trial = 0; trial < 5; ++trial) {
    test::CeresView ceres_view(ErrorConvention::kSo3xRn, fixture.window.frames(), fixture.calibration);
    ceres_view.Add(&term);
    VectorXd error = VectorXd::Zero(kBlock);
    for (int i = 0; trial > 0 && i < fixture.calibration.size(); ++i) {
      // Well away from zero, where the rotation's chart bends.
      error[i] = fixture.estimate.deviations[i] * random.Uniform(-0.5, 0.5);
    }
    ceres_view.SetCalibration(error);
    VectorXd residual;
    const MatrixXd jacobian = ceres_view.Jacobian(&residual);
    const auto cost = [&](const VectorXd& xi) -> VectorXd {
      return VectorXd::Constant(1, 0.5 * ceres_view.Moved(xi).squaredNorm());
    };
    const MatrixXd numeric = test::NumericJacobian(cost, static_cast<int>(jacobian.cols()), 1e-6);
    EXPECT_EQ(test::CompareJacobians((jacobian.transpose() * residual).transpose(), numeric, 2e-5), "")
        << "trial " << trial;
  }
}

TEST(WindowCalibrationTest, PriorOnTheCalibrationIsNumeric) {
  CalibratedWindow fixture(13);
  LinearPrior prior;
  ASSERT_TRUE(MakeInitialPrior(ErrorConvention::kSo3xRn, fixture.window.frame(0), SomeCovariance(), &prior));
  AddCalibrationPrior(fixture.estimate, &prior);
  ASSERT_EQ(prior.columns().size(), prior.jacobian.cols());
  WindowCalibration moved = fixture.calibration;  // the window has moved on since the prior was made
  VectorXd shift = 0.7 * fixture.estimate.deviations;
  ASSERT_TRUE(Retract(moved.layout, shift, &moved.mean));
  const PriorFactor factor(&prior, &moved);
  const WindowFrame& frame = fixture.window.frame(0);
  const auto evaluate = [&](const VectorXd& block, double* jacobian) {
    const double* parameters[] = {frame.nav.data(), frame.bias.data(), block.data()};
    double* jacobians[] = {nullptr, nullptr, jacobian};
    VectorXd residual(factor.rows());
    EXPECT_TRUE(factor.Evaluate(parameters, residual.data(), jacobians));
    return residual;
  };
  const VectorXd at = VectorXd::Zero(kBlock);
  EXPECT_NEAR(evaluate(at, nullptr).norm(), 0.7 * std::sqrt(12.0), 1e-3);
  Eigen::Matrix<double, Eigen::Dynamic, kBlock, Eigen::RowMajor> jacobian(factor.rows(), kBlock);
  evaluate(at, jacobian.data());
  const auto residual = [&](const VectorXd& block) { return evaluate(block, nullptr); };
  EXPECT_EQ(test::CompareJacobians(jacobian, test::NumericJacobian(residual, kBlock, 1e-5), 1e-7), "");
}

// GIVEN a linear problem, WHEN its oldest frame is marginalised, THEN what is known about the newest state
// and the calibration stays the same.
TEST(WindowCalibrationTest, MarginalizationKeepsWhatIsKnown) {
  for (const ErrorConvention convention : test::kAllConventions) {
    CalibratedWindow fixture(14);
    LinearPrior prior;
    ASSERT_TRUE(MakeInitialPrior(convention, fixture.window.frame(0), SomeCovariance(), &prior));
    AddCalibrationPrior(fixture.estimate, &prior);
    const PoseSystem all = fixture.Vision(0, 3);
    const NewestEstimate known_before = test::Newest(fixture.window, prior, all, {fixture.gravity_W});
    const Matrix15d before = known_before.covariance;
    const VectorXd deviations_before = known_before.calibration_deviations;
    ASSERT_EQ(deviations_before.size(), 12);
    for (int i = 0; i < 12; ++i) {
      EXPECT_LT(deviations_before[i], (1 + 1e-9) * fixture.estimate.deviations[i]) << i;
    }
    const PoseSystem leaving = fixture.Vision(0, 0);
    const LinearPrior next = test::Marginalize(fixture.window, prior, leaving, {fixture.gravity_W});
    ASSERT_EQ(next.columns().size(), next.jacobian.cols());
    for (auto& [id, track] : fixture.window.tracks()) {
      if (track.views.front().frame->index == 0) {
        track.Restart();
      }
    }
    std::erase_if(fixture.window.tracks(), [](const auto& item) { return item.second.views.empty(); });
    fixture.window.RemoveOldest();
    const NewestEstimate known_after =
        test::Newest(fixture.window, next, fixture.Vision(0, 2), {fixture.gravity_W});
    const Matrix15d after = known_after.covariance;
    const VectorXd deviations_after = known_after.calibration_deviations;
    EXPECT_LT((after - before).norm(), 1e-6 * before.norm()) << ToString(convention);
    EXPECT_LT((deviations_after - deviations_before).cwiseQuotient(deviations_before).norm(), 1e-6);
  }
}

// The rows of explicit inverse depths over all of their blocks, ahead well away from the calibration block's
// zero.
TEST(WindowCalibrationTest, InverseDepthRowsAgainstDifferences) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const bool ahead = seed <= 20;
    CalibratedWindow fixture(seed, ahead ? 1.0 : 0.0, 4, 12,
                             ahead ? test::FixtureView::kAhead : test::FixtureView::kBehind);
    const WindowTrack& track = *fixture.tracks().front();
    const WindowView& view = track.views.back();
    const WindowFrame* base = track.views.front().frame;
    const InverseDepthFactor factor(base, &view, &fixture.calibration, track.plane(),
                                    track.views.front().observation.row_px);
    const BaseBearingFactor bearing(&track.views.front(), &fixture.calibration);
    VectorXd at = VectorXd::Zero(kBlock);
    for (int i = 0; ahead && i < fixture.calibration.size(); ++i) {
      at[i] = fixture.estimate.deviations[i] * fixture.random.Uniform(-0.5, 0.5);
    }
    const auto evaluate = [&](const VectorXd& delta, double* const* jacobians) -> VectorXd {
      Eigen::Matrix<double, kNavAmbientSize, 2> nav;
      for (int i = 0; i < 2; ++i) {
        const NavState state = (i == 0 ? *base : *view.frame).nav_state();
        PackNavState(Retract(ErrorConvention::kSo3xRn, state, Vector9d(delta.segment<9>(9 * i))),
                     nav.col(i).data());
      }
      const Eigen::Vector3d landmark = track.landmark + delta.segment<3>(18);
      const VectorXd block = at + delta.tail<kBlock>();
      const double* parameters[] = {nav.col(0).data(), nav.col(1).data(), landmark.data(), block.data()};
      VectorXd residual(4);
      EXPECT_TRUE(factor.Evaluate(parameters, residual.data(), jacobians));
      EXPECT_TRUE(bearing.Evaluate(parameters + 2, residual.data() + 2,
                                   jacobians == nullptr ? nullptr : jacobians + 4));
      return residual;
    };
    using Rows3 = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;
    using Rows9 = Eigen::Matrix<double, 2, 9, Eigen::RowMajor>;
    using RowsBlock = Eigen::Matrix<double, 2, kBlock, Eigen::RowMajor>;
    Rows9 of_base, of_view;
    Rows3 of_landmark, bearing_of_landmark;
    RowsBlock of_camera, bearing_of_camera;
    double* jacobians[] = {of_base.data(),
                           of_view.data(),
                           of_landmark.data(),
                           of_camera.data(),
                           bearing_of_landmark.data(),
                           bearing_of_camera.data()};
    evaluate(VectorXd::Zero(21 + kBlock), jacobians);
    MatrixXd analytic = MatrixXd::Zero(4, 21 + kBlock);
    analytic.topRows<2>() << of_base, of_view, of_landmark, of_camera;
    analytic.bottomRows<2>().middleCols<3>(18) = bearing_of_landmark;
    analytic.bottomRows<2>().rightCols<kBlock>() = bearing_of_camera;
    const auto residual = [&](const VectorXd& delta) { return evaluate(delta, nullptr); };
    const MatrixXd numeric = test::NumericJacobian(residual, 21 + kBlock);
    // A step of a microsecond a row moves the last row by a third of a millisecond.
    EXPECT_EQ(test::CompareJacobians(analytic, numeric, 5e-6), "") << "seed " << seed;
    // Over the intrinsics alone: theirs are a thousand times smaller than a rotation's.
    const int first = 21 + fixture.calibration.layout.intrinsics();
    EXPECT_EQ(test::CompareJacobians(analytic.middleCols<4>(first), numeric.middleCols<4>(first), 1e-6), "");
    EXPECT_GT(numeric.middleCols<4>(first).norm(), 0.1);
  }
}

// GIVEN intrinsics that have moved, THEN the rays of views follow them where they are estimated; with a
// layout that has none, views are those that were given.
TEST(WindowCalibrationTest, RaysMoveOnlyWithIntrinsicsThatAreEstimated) {
  CalibratedWindow fixture(1);
  VectorXd error = VectorXd::Zero(fixture.calibration.size());
  error.segment<2>(fixture.calibration.layout.intrinsics()).setConstant(20);
  const CameraCalibration before = fixture.calibration.mean;
  ASSERT_TRUE(Retract(fixture.calibration.layout, error, &fixture.calibration.mean));
  const std::vector<WindowView> views = fixture.tracks().front()->views;
  std::vector<WindowView> scratch;
  const WindowCalibration fixed{{}, fixture.calibration.mean};
  EXPECT_EQ(&Renormalized(fixed, before, views, &scratch), &views);
  EXPECT_EQ(&Renormalized(fixture.calibration, fixture.calibration.mean, views, &scratch), &views);
  EXPECT_EQ(Renormalized(fixed, views.front()).observation.z, views.front().observation.z);
  EXPECT_EQ(&Renormalized(fixture.calibration, before, views, &scratch), &scratch);
  ASSERT_EQ(scratch.size(), views.size());
  EXPECT_GT((scratch.front().observation.z - views.front().observation.z).norm(), 1e-4);

  fixture.window.Renormalize(fixed);
  EXPECT_EQ(fixture.tracks().front()->views.front().observation.z, views.front().observation.z);
  fixture.window.Renormalize(fixture.calibration);
  EXPECT_EQ(fixture.tracks().front()->views.front().observation.z, scratch.front().observation.z);
}

// GIVEN observations of different noise ratios, THEN their weights have the ratio, also with other
// intrinsics.
TEST(WindowCalibrationTest, ANoiseRatioDividesTheWeights) {
  CalibratedWindow fixture(1);
  const Eigen::Vector2d pixel(300, 200);
  ASSERT_EQ(
      fixture.window.AddObservations(fixture.calibration.mean.camera, PixelNoise({.noise_ratios = true}),
                                     {{901, pixel, 1}, {902, pixel, 2}}),
      0);
  const auto expect_half = [&] {
    const WindowView& one = fixture.window.tracks().at(901).views.back();
    const WindowView& two = fixture.window.tracks().at(902).views.back();
    EXPECT_EQ(2 * two.observation.sqrt_information, one.observation.sqrt_information);
    EXPECT_EQ(2 * two.root_weight_per_px, one.root_weight_per_px);
  };
  expect_half();
  VectorXd error = VectorXd::Zero(fixture.calibration.size());
  error.segment<2>(fixture.calibration.layout.intrinsics()).setConstant(20);
  ASSERT_TRUE(Retract(fixture.calibration.layout, error, &fixture.calibration.mean));
  fixture.window.Renormalize(fixture.calibration);
  expect_half();
}

}  // namespace
}  // namespace alidade
