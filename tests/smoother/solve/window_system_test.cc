#include "smoother/solve/window_system.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/smoother/solve/given_terms.h"
#include "tests/smoother/window/window_fixture.h"
#include "tests/support/jacobian_checker.h"

namespace alidade {
namespace {

using test::kAllConventions;
using test::WindowFixture;

PoseSystem Vision(const WindowFixture& fixture, int first_base, int last_base) {
  const std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.T_BC);
  PoseSystem system(fixture.window.size());
  TrackWorkspace workspace;
  for (const WindowTrack* track : fixture.tracks()) {
    const int base = track->views.front().frame->index;
    if (base >= first_base && base <= last_base) {
      EXPECT_TRUE(AddTrack(track->views, geometry, {}, track->landmark, &workspace, &system));
    }
  }
  return system;
}

Matrix15d SomeCovariance() {
  Vector15d deviation;
  deviation << Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(1e-3),
      Eigen::Vector3d::Constant(0.05), Eigen::Vector3d::Constant(5e-3), Eigen::Vector3d::Constant(0.1);
  Matrix15d covariance = deviation.cwiseAbs2().asDiagonal();
  covariance(0, 7) = covariance(7, 0) = 2e-4;
  return covariance;
}

/// Gauss-Newton system of prior and IMU over all frames (15 tangent coordinates each), by factor evaluation
/// and PlusJacobian-free charts: written independently of the code under test, which stacks rows and uses QR.
struct DenseSystem {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
};

DenseSystem FullSystem(const WindowFixture& fixture, const LinearPrior& prior, const PoseSystem& vision) {
  const int frames = fixture.window.size();
  DenseSystem system{Eigen::MatrixXd::Zero(15 * frames, 15 * frames), Eigen::VectorXd::Zero(15 * frames)};
  // prior on frame 0 at its origin
  const Eigen::MatrixXd rows = test::RowsAboutOrigin(prior);
  system.hessian.topLeftCorner<15, 15>() += rows.transpose() * rows;
  system.gradient.head<15>() += rows.transpose() * prior.residual;
  for (int i = 0; i + 1 < frames; ++i) {
    const WindowFrame& a = fixture.window.frame(i);
    const WindowFrame& b = fixture.window.frame(i + 1);
    const PreintegrationModel model{&*b.preintegration, fixture.gravity_W};
    Vector15d r;
    Matrix15d ja, jb;
    model.Evaluate(a.nav_state(), a.imu_bias(), b.nav_state(), b.imu_bias(), &r, &ja, &jb);
    const Matrix15d& covariance = b.preintegration->covariance();
    const Matrix15d weight = covariance.inverse();
    Eigen::Matrix<double, 15, 30> j;
    j << ja * ImuChartJacobian(prior.chart.convention, a.nav_state()),
        jb * ImuChartJacobian(prior.chart.convention, b.nav_state());
    system.hessian.block<30, 30>(15 * i, 15 * i) += j.transpose() * weight * j;
    system.gradient.segment<30>(15 * i) += j.transpose() * weight * r;
  }
  for (int i = 0; i < frames; ++i) {
    const WindowFrame& frame = fixture.window.frame(i);
    if (frame.rest) {
      // Zero velocity and gyro bias by their definitions, in the columns they touch.
      const Matrix15d c = ImuChartJacobian(prior.chart.convention, frame.nav_state());
      const double wv = 50 * 50;
      const double wb = 200 * 200;
      const Eigen::Matrix<double, 3, 15> jv = c.middleRows<3>(6);
      const Eigen::Matrix<double, 3, 15> jb = c.middleRows<3>(9);
      system.hessian.block<15, 15>(15 * i, 15 * i) += wv * jv.transpose() * jv + wb * jb.transpose() * jb;
      system.gradient.segment<15>(15 * i) +=
          wv * jv.transpose() * frame.nav_state().v_WB +
          wb * jb.transpose() * (frame.imu_bias().gyro - frame.rest->model.rates.mean_radps);
    }
  }
  const Eigen::MatrixXd full = vision.hessian.selfadjointView<Eigen::Lower>();
  for (int i = 0; i < frames; ++i) {
    const Matrix6d ci = ChartJacobian(prior.chart.convention, fixture.window.frame(i).nav_state().T_WB());
    system.gradient.segment<6>(15 * i) += ci.transpose() * vision.gradient.segment<6>(6 * i);
    for (int j = 0; j < frames; ++j) {
      const Matrix6d cj = ChartJacobian(prior.chart.convention, fixture.window.frame(j).nav_state().T_WB());
      system.hessian.block<6, 6>(15 * i, 15 * j) += ci.transpose() * full.block<6, 6>(6 * i, 6 * j) * cj;
    }
  }
  return system;
}

/// The first two frames stood still, camera and body at one place (deviations 0.02 m/s and 0.005 rad/s).
void AddRest(WindowFixture* fixture) {
  for (int i = 0; i < 2; ++i) {
    fixture->window.frame(i).rest = MakeRestMeasurement({true, true}, 5, {{0.01, -0.02, 0.03 * i}, {}},
                                                        Eigen::Vector3d::Zero(), VisionConfig());
  }
}

class MarginalizationTest : public testing::TestWithParam<ErrorConvention> {};

// GIVEN a window whose oldest frame leaves, WHEN what remains is solved with the prior, THEN the linear
// problem has the same solution and the same information as the batch over everything.
TEST_P(MarginalizationTest, PriorEqualsTheBatchOnTheLinearProblem) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    WindowFixture fixture(seed, 4, 12, 1.0);
    AddRest(&fixture);
    LinearPrior prior;
    ASSERT_TRUE(MakeInitialPrior(GetParam(), fixture.window.frame(0), SomeCovariance(), &prior));
    prior.residual = Vector15d::Constant(0.3);
    const PoseSystem leaving = Vision(fixture, 0, 0);
    const PoseSystem staying = Vision(fixture, 1, 3);

    const DenseSystem first = FullSystem(fixture, prior, leaving);
    const DenseSystem batch_vision = FullSystem(fixture, prior, staying);
    const DenseSystem nothing = FullSystem(fixture, prior, PoseSystem(4));
    const Eigen::MatrixXd batch_hessian = first.hessian + batch_vision.hessian - nothing.hessian;
    const Eigen::VectorXd batch_gradient = first.gradient + batch_vision.gradient - nothing.gradient;
    const Eigen::VectorXd batch_step = -batch_hessian.ldlt().solve(batch_gradient);

    const LinearPrior next = test::Marginalize(fixture.window, prior, leaving, {fixture.gravity_W});
    ASSERT_EQ(next.columns().size(), 15 + 6 + 6);
    // What stays: the new prior, the IMU factors 1-2 and 2-3, and the staying tracks.
    DenseSystem rest = FullSystem(fixture, prior, staying);
    LinearPrior none = prior;
    none.jacobian.setZero();
    rest = FullSystem(fixture, none, staying);
    const WindowFrame& a = fixture.window.frame(0);
    const WindowFrame& b = fixture.window.frame(1);
    Vector15d r;
    Matrix15d ja, jb;
    PreintegrationModel{&*b.preintegration, fixture.gravity_W}.Evaluate(
        a.nav_state(), a.imu_bias(), b.nav_state(), b.imu_bias(), &r, &ja, &jb);
    const Matrix15d& covariance = b.preintegration->covariance();
    const Matrix15d jb_xi = jb * ImuChartJacobian(GetParam(), b.nav_state());
    Eigen::MatrixXd hessian = rest.hessian.bottomRightCorner<45, 45>();
    Eigen::VectorXd gradient = rest.gradient.tail<45>();
    hessian.topLeftCorner<15, 15>() -= jb_xi.transpose() * covariance.inverse() * jb_xi;
    gradient.head<15>() -= jb_xi.transpose() * covariance.inverse() * r;
    const Eigen::MatrixXd rows = test::RowsAboutOrigin(next);
    const Eigen::MatrixXd prior_hessian = rows.transpose() * rows;
    const Eigen::VectorXd prior_gradient = rows.transpose() * next.residual;
    const auto spread = [](int i) { return i < 15 ? i : i < 21 ? i : i + 9; };  // 15 | 6 (of 15) | 6 (of 15)
    for (int i = 0; i < 27; ++i) {
      gradient[spread(i)] += prior_gradient[i];
      for (int j = 0; j < 27; ++j) {
        hessian(spread(i), spread(j)) += prior_hessian(i, j);
      }
    }
    const Eigen::VectorXd step = -hessian.ldlt().solve(gradient);
    EXPECT_LT((step - batch_step.tail<45>()).norm(), 1e-6 * batch_step.norm()) << "seed " << seed;
    const Eigen::MatrixXd batch_covariance = batch_hessian.inverse().bottomRightCorner<45, 45>();
    EXPECT_LT((hessian.inverse() - batch_covariance).norm(), 1e-5 * batch_covariance.norm());
  }
}

TEST_P(MarginalizationTest, NewestCovarianceIsTheInverseOfTheFullHessian) {
  WindowFixture fixture(3, 4, 12, 1.0);
  AddRest(&fixture);
  LinearPrior prior;
  ASSERT_TRUE(MakeInitialPrior(GetParam(), fixture.window.frame(0), SomeCovariance(), &prior));
  const PoseSystem vision = Vision(fixture, 0, 3);
  const Matrix15d covariance = test::Newest(fixture.window, prior, vision, {fixture.gravity_W}).covariance;
  const Matrix15d chart = ImuChartJacobian(GetParam(), fixture.window.newest().nav_state());
  const Eigen::MatrixXd inverse = FullSystem(fixture, prior, vision).hessian.inverse();
  const Matrix15d expected = chart * inverse.bottomRightCorner<15, 15>() * chart.transpose();
  EXPECT_LT((covariance - expected).norm(), 1e-6 * expected.norm());
}

TEST_P(MarginalizationTest, DeviationsOverAllPosesAreThoseOfTheFullHessian) {
  WindowFixture fixture(3, 4, 12, 1.0);
  AddRest(&fixture);
  LinearPrior prior;
  ASSERT_TRUE(MakeInitialPrior(GetParam(), fixture.window.frame(0), SomeCovariance(), &prior));
  const PoseSystem vision = Vision(fixture, 0, 3);
  const WindowInformation window = test::Newest(fixture.window, prior, vision, {fixture.gravity_W}).window;
  const Eigen::MatrixXd inverse = FullSystem(fixture, prior, vision).hessian.inverse();
  Eigen::RowVectorXd row(24);
  Eigen::RowVectorXd in_error = Eigen::RowVectorXd::Zero(60);
  for (int i = 0; i < 4; ++i) {
    row.segment<6>(6 * i) << fixture.random.Vector(1).transpose(), fixture.random.Vector(1).transpose();
    in_error.segment<6>(15 * i) =
        row.segment<6>(6 * i) * ChartJacobian(GetParam(), fixture.window.frame(i).nav_state().T_WB());
  }
  const double expected = std::sqrt(in_error * inverse * in_error.transpose());
  EXPECT_NEAR(window.Whitened(row).norm(), expected, 1e-6 * expected);
}

// The gauge: turning the whole window about gravity and shifting it must change nothing but the first prior's
// own term.
TEST(MarginalizationGaugeTest, VisionAndImuHoldNoInformationOnYawAndPositionInRightInvariantCoordinates) {
  WindowFixture fixture(8, 4, 12, 1.0);
  LinearPrior none;
  ASSERT_TRUE(
      MakeInitialPrior(ErrorConvention::kRightInvariant, fixture.window.frame(0), SomeCovariance(), &none));
  none.jacobian.setZero();
  const LinearPrior prior =
      test::Marginalize(fixture.window, none, Vision(fixture, 0, 0), {fixture.gravity_W});
  Eigen::MatrixXd gauge = Eigen::MatrixXd::Zero(prior.columns().size(), 4);
  for (int i = 0; i < 3; ++i) {
    gauge(prior.columns().Frame(i).first + 2, 0) = 1;  // theta = e_z in every frame, nothing in p and v
    gauge.block<3, 3>(prior.columns().Frame(i).first + 3, 1).setIdentity();
  }
  EXPECT_LT((prior.jacobian * gauge).norm(), 1e-6 * prior.jacobian.norm());
}

INSTANTIATE_TEST_SUITE_P(Conventions, MarginalizationTest, testing::ValuesIn(kAllConventions),
                         [](const auto& item) { return std::string(ToString(item.param)); });

}  // namespace
}  // namespace alidade
