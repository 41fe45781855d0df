#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "smoother/factors/imu_factor.h"
#include "smoother/factors/inverse_depth_factor.h"
#include "smoother/factors/prior_factor.h"
#include "smoother/factors/rest_factor.h"
#include "smoother/manifold/lifted_cost.h"
#include "smoother/solve/vision_terms.h"
#include "tests/smoother/solve/ceres_view.h"
#include "tests/smoother/window/window_fixture.h"
#include "tests/support/jacobian_checker.h"

namespace alidade {
namespace {

using test::CeresView;
using test::CompareJacobians;
using test::kAllConventions;
using test::RandomStates;
using test::WindowFixture;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A point in parameter space: one vector a block.
using Point = std::vector<Eigen::VectorXd>;

std::vector<const double*> Pointers(const Point& point) {
  std::vector<const double*> pointers;
  for (const Eigen::VectorXd& block : point) {
    pointers.push_back(block.data());
  }
  return pointers;
}

Eigen::VectorXd Residual(const ceres::CostFunction& cost, const Point& point) {
  Eigen::VectorXd residual(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(Pointers(point).data(), residual.data(), nullptr));
  return residual;
}

/// Jacobian as Ceres forms it: ambient times the manifold's PlusJacobian, all blocks side by side.
Eigen::MatrixXd TangentJacobian(const ceres::CostFunction& cost, const NavStateManifold& manifold,
                                const Point& point, Eigen::VectorXd* residual) {
  std::vector<RowMatrix> ambient;
  std::vector<double*> pointers;
  for (const int size : cost.parameter_block_sizes()) {
    ambient.emplace_back(cost.num_residuals(), size);
  }
  pointers.reserve(ambient.size());
  for (RowMatrix& jacobian : ambient) {
    pointers.push_back(jacobian.data());
  }
  residual->resize(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(Pointers(point).data(), residual->data(), pointers.data()));
  Eigen::MatrixXd stacked(cost.num_residuals(), 0);
  for (size_t i = 0; i < ambient.size(); ++i) {
    Eigen::MatrixXd tangent = ambient[i];
    if (ambient[i].cols() == kNavAmbientSize) {
      Eigen::Matrix<double, kNavAmbientSize, kNavTangentSize, Eigen::RowMajor> plus;
      manifold.PlusJacobian(point[i].data(), plus.data());
      tangent = ambient[i] * plus;
    }
    stacked.conservativeResize(Eigen::NoChange, stacked.cols() + tangent.cols());
    stacked.rightCols(tangent.cols()) = tangent;
  }
  return stacked;
}

int TangentSizeOf(const Point& point) {
  int size = 0;
  for (const Eigen::VectorXd& block : point) {
    size += block.size() == kNavAmbientSize ? kNavTangentSize : static_cast<int>(block.size());
  }
  return size;
}

Point Move(const NavStateManifold& manifold, const Point& point, const Eigen::VectorXd& xi) {
  Point moved = point;
  Eigen::Index offset = 0;
  for (size_t i = 0; i < point.size(); ++i) {
    if (point[i].size() == kNavAmbientSize) {
      const Vector9d delta = xi.segment<9>(offset);
      manifold.Plus(point[i].data(), delta.data(), moved[i].data());
      offset += 9;
    } else {
      moved[i] += xi.segment(offset, point[i].size());
      offset += point[i].size();
    }
  }
  return moved;
}

void ExpectJacobianInAllConventions(const ceres::CostFunction& cost, const Point& point, double tolerance) {
  for (const ErrorConvention convention : kAllConventions) {
    const NavStateManifold manifold(convention);
    Eigen::VectorXd residual;
    const Eigen::MatrixXd analytic = TangentJacobian(cost, manifold, point, &residual);
    EXPECT_EQ((residual - Residual(cost, point)).norm(), 0) << "same residual with and without Jacobians";
    const auto f = [&](const Eigen::VectorXd& xi) { return Residual(cost, Move(manifold, point, xi)); };
    EXPECT_EQ(CompareJacobians(analytic, test::NumericJacobian(f, TangentSizeOf(point)), tolerance), "")
        << ToString(convention);
  }
}

Eigen::VectorXd Nav(const NavState& state) {
  Eigen::VectorXd block(kNavAmbientSize);
  PackNavState(state, block.data());
  return block;
}

Eigen::VectorXd Bias(const ImuBias& bias) {
  Eigen::VectorXd block(6);
  PackBias(bias, block.data());
  return block;
}

/// Of the present calibration.
Eigen::VectorXd NoError() {
  return Eigen::VectorXd::Zero(CalibrationLayout::kMaxSize);
}

TEST(ImuFactorTest, JacobianThroughTheManifoldMatchesNumericInThreeConventions) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    WindowFixture fixture(seed, 2, 0);
    const ImuFactor factor(&*fixture.window.frame(1).preintegration, fixture.gravity_W);
    ASSERT_TRUE(factor.valid());
    const LiftedCost<ImuFactor> cost(factor);
    const NavState a = Retract(ErrorConvention::kSo3xRn, fixture.window.frame(0).nav_state(),
                               0.1 * Vector9d::Constant(fixture.random.Uniform(-1, 1)));
    const Point point = {Nav(a), Bias(fixture.random.Bias()), Nav(fixture.window.frame(1).nav_state()),
                         Bias(fixture.random.Bias())};
    ExpectJacobianInAllConventions(cost, point, 1e-7);
  }
}

TEST(RestFactorTest, JacobianThroughTheManifoldMatchesNumericInThreeConventions) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    RandomStates random(seed);
    const LiftedCost<RestFactor> cost(
        RestFactor(MakeRestMeasurement({true, seed % 2 == 0}, 5, {random.Vector(0.1), random.Vector(1)},
                                       random.Vector(0.3), VisionConfig())));
    ExpectJacobianInAllConventions(cost, {Nav(random.Nav(3)), Bias(random.Bias())}, 1e-8);
  }
}

TEST(ImuFactorTest, VanishesOnTheStatesThatThePropagationGives) {
  WindowFixture fixture(3, 2, 0);
  const LiftedCost<ImuFactor> cost(ImuFactor(&*fixture.window.frame(1).preintegration, fixture.gravity_W));
  const WindowFrame& a = fixture.window.frame(0);
  const WindowFrame& b = fixture.window.frame(1);
  const Eigen::VectorXd r =
      Residual(cost, {Nav(a.nav_state()), Bias(a.imu_bias()), Nav(b.nav_state()), Bias(b.imu_bias())});
  EXPECT_LT(r.norm(), 1e-6) << "in standard deviations";
}

TEST(ImuFactorTest, ASingleImuStepStillHasAnInvertibleCovariance) {
  Preintegration one_step(ImuBias{}, ImuNoise{});
  one_step.Add({0, Eigen::Vector3d(0.1, 0, 0), Eigen::Vector3d(0, 0, 9.81)},
               {5'000'000, Eigen::Vector3d(0.1, 0, 0), Eigen::Vector3d(0, 0, 9.81)});
  EXPECT_TRUE(ImuFactor(&one_step, Eigen::Vector3d(0, 0, -9.81)).valid());
}

TEST(InverseDepthFactorTest, JacobianThroughTheManifoldMatchesNumericInThreeConventions) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    WindowFixture fixture(seed, 3, 4, 1.0,
                          seed <= 20 ? test::FixtureView::kAhead : test::FixtureView::kBehind);
    const WindowTrack& track = *fixture.tracks().front();
    const LiftedCost<InverseDepthFactor> cost(InverseDepthFactor(
        track.views.front().frame, &track.views.back(), &fixture.calibration, track.plane()));
    const Point point = {Nav(track.views.front().frame->nav_state()),
                         Nav(track.views.back().frame->nav_state()), track.landmark, NoError()};
    ExpectJacobianInAllConventions(cost, point, 1e-7);
    const LiftedCost<BaseBearingFactor> base(BaseBearingFactor(&track.views.front(), &fixture.calibration));
    ExpectJacobianInAllConventions(base, {track.landmark, NoError()}, 1e-9);
  }
}

TEST(InverseDepthFactorTest, TheDepthPriorActsOnTheInverseDepthAlone) {
  const LiftedCost<DepthPriorFactor> cost(DepthPriorFactor({0.2, 5}));
  const Point point = {Eigen::Vector3d(0.1, -0.2, 0.5)};
  EXPECT_DOUBLE_EQ(Residual(cost, point)[0], 1.5);
  ExpectJacobianInAllConventions(cost, point, 1e-9);
}

TEST(InverseDepthFactorTest, ALandmarkBehindTheCameraCostsMuchButDoesNotFailTheSolve) {
  WindowFixture fixture(5, 3, 4);
  const WindowTrack& track = *fixture.tracks().front();
  const LiftedCost<InverseDepthFactor> cost(
      InverseDepthFactor(track.views.front().frame, &track.views.back(), &fixture.calibration));
  Eigen::VectorXd landmark = track.landmark;
  landmark[2] = -1e3;  // far behind: rho t outweighs the ray
  const NavState base = track.views.front().frame->nav_state();
  NavState view = base;
  view.p_WB -= 2 * (base.R_WB * fixture.T_BC.rotation).col(2);
  EXPECT_GT(Residual(cost, {Nav(base), Nav(view), landmark, NoError()}).norm(), 100);
}

TEST(PriorFactorTest, JacobianThroughTheManifoldMatchesNumericInThreeConventions) {
  for (const ErrorConvention made_in : kAllConventions) {
    WindowFixture fixture(7, 3, 0);
    LinearPrior prior;
    prior.chart = {made_in, fixture.random.Vector(5)};
    for (int i = 0; i < 3; ++i) {
      const WindowFrame& frame = fixture.window.frame(i);
      Vector9d shift;
      shift << fixture.random.Vector(0.2), fixture.random.Vector(0.3), fixture.random.Vector(0.3);
      prior.anchors.push_back({&frame, Retract(made_in, frame.nav_state(), shift), fixture.random.Bias()});
    }
    prior.jacobian.resize(27, 27);
    for (Eigen::Index i = 0; i < prior.jacobian.size(); ++i) {
      prior.jacobian.data()[i] = fixture.random.Uniform(-1, 1);
    }
    prior.residual = prior.jacobian.col(3);
    const LiftedCost<PriorFactor> cost{PriorFactor(&prior, &fixture.calibration)};
    const Point point = {Nav(fixture.window.frame(0).nav_state()), Bias(fixture.random.Bias()),
                         Nav(fixture.window.frame(1).nav_state()), Nav(fixture.window.frame(2).nav_state()),
                         NoError()};
    ExpectJacobianInAllConventions(cost, point, 1e-7);
  }
}

/// Variable projection promises the exact gradient of its cost, not the derivative of its (equivalent) rows.
class PoseOnlyCostTest : public testing::TestWithParam<RobustKernel> {};

TEST_P(PoseOnlyCostTest, GradientIsThatOfTheCostWithLandmarksSolvedInside) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    // Residuals beyond the kernel's scale; fewer with decreasing slopes, where the cost of a landmark has
    // several minima in heavy contamination.
    const bool decreasing = GetParam() == RobustKernel::kCauchy || GetParam() == RobustKernel::kLogTail;
    WindowFixture fixture(seed, 4, 10, decreasing ? 0.7 : 3.0);
    for (auto& [id, track] : fixture.window.tracks()) {
      track.depth_prior = {0.15, id % 3 == 0 ? 30.0 : 0.0};
    }
    for (const std::unique_ptr<WindowFrame>& frame : fixture.window.frames()) {
      Vector9d shift;
      shift << fixture.random.Vector(0.002), fixture.random.Vector(0.005), Eigen::Vector3d::Zero();
      PackNavState(Retract(ErrorConvention::kSo3xRn, frame->nav_state(), shift), frame->nav.data());
    }
    PoseOnlyTerm term(fixture.window, fixture.tracks(), fixture.calibration, {GetParam(), 1.5});
    for (const ErrorConvention convention : kAllConventions) {
      CeresView ceres_view(convention, fixture.window.frames(), fixture.calibration);
      ceres_view.Add(&term);
      Eigen::VectorXd residual;
      const Eigen::MatrixXd jacobian = ceres_view.Jacobian(&residual);
      const auto f = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        return Eigen::VectorXd::Constant(1, 0.5 * ceres_view.Moved(xi).squaredNorm());
      };
      const Eigen::MatrixXd numeric = test::NumericJacobian(f, static_cast<int>(jacobian.cols()), 1e-5);
      EXPECT_EQ(CompareJacobians((jacobian.transpose() * residual).transpose(), numeric, 1e-5), "")
          << ToString(convention) << " seed " << seed;
      const double cost_alone = 2 * ceres_view.Cost();
      EXPECT_NEAR(residual.squaredNorm(), cost_alone, 1e-9 * cost_alone) << "with and without Jacobians";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, PoseOnlyCostTest,
                         testing::Values(RobustKernel::kNone, RobustKernel::kHuber, RobustKernel::kCauchy,
                                         RobustKernel::kLogTail));

}  // namespace
}  // namespace alidade
