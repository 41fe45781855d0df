#include "smoother/manifold/first_estimate.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "smoother/factors/inverse_depth_factor.h"
#include "smoother/factors/pose_only_cost.h"
#include "smoother/tracks/anchored_landmark.h"
#include "tests/smoother/solve/given_terms.h"
#include "tests/smoother/window/window_fixture.h"
#include "tests/support/jacobian_checker.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::kAllConventions;
using test::WindowFixture;

Vector9d SomeShift(test::RandomStates* random) {
  Vector9d shift;
  shift << random->Vector(0.02), random->Vector(0.05), random->Vector(0.05);
  return shift;
}

TEST(FirstEstimateTest, ChainAgainstDifferences) {
  test::RandomStates random(1);
  for (const ErrorConvention convention : kAllConventions) {
    for (int trial = 0; trial < 20; ++trial) {
      const NavState point{random.Rotation(), random.Vector(5), random.Vector(2)};
      const NavState now = Retract(convention, point, 10 * SomeShift(&random));
      const Eigen::Vector3d centre = random.Vector(5);
      const auto seen = [&](NavState state) {
        state.p_WB -= centre;
        return state;
      };
      const FirstEstimate first{{convention, centre}, point, true};
      const auto coordinates = [&](const VectorXd& zeta) -> VectorXd {
        return Local(convention, seen(point), seen(Retract(ErrorConvention::kSo3xRn, now, Vector9d(zeta))));
      };
      const MatrixXd numeric = ChartJacobian(convention, seen(point)) * test::NumericJacobian(coordinates, 9);
      EXPECT_EQ(test::CompareJacobians(first.Chain(now), numeric, 1e-7), "") << ToString(convention);
    }
  }
}

TEST(FirstEstimateTest, AnUnheldVelocityIsThePresentOne) {
  test::RandomStates random(2);
  const NavState point{random.Rotation(), random.Vector(5), random.Vector(2)};
  const NavState now{random.Rotation(), random.Vector(5), random.Vector(2)};
  EXPECT_EQ((FirstEstimate{{ErrorConvention::kSo3xRn}, point, false}.Point(now).v_WB), now.v_WB);
  EXPECT_EQ((FirstEstimate{{ErrorConvention::kSo3xRn}, point, true}.Point(now).v_WB), point.v_WB);
  EXPECT_EQ((FirstEstimate{{ErrorConvention::kSo3xRn}, point, false}.Point(now).p_WB), point.p_WB);
}

/// Turn about gravity and shifts of everything, over 15 canonical coordinates of each frame at its present
/// state, as the Jacobians see them: from where they are taken.
MatrixXd NullSpace(const Window& window) {
  MatrixXd gauge = MatrixXd::Zero(15 * window.size(), 4);
  for (int i = 0; i < window.size(); ++i) {
    const WindowFrame& frame = window.frame(i);
    const NavState now = frame.nav_state();
    const NavState point = frame.first ? frame.first->Point(now) : now;
    const Vector3d up = Vector3d::UnitZ();
    Eigen::Matrix<double, 9, 4> own = Eigen::Matrix<double, 9, 4>::Zero();
    own.col(0) << point.R_WB.transpose() * up, up.cross(point.p_WB), up.cross(point.v_WB);
    own.block<3, 3>(3, 1).setIdentity();
    gauge.middleRows<9>(15 * i) = frame.first ? Matrix9d(frame.first->Chain(now).inverse()) * own : own;
  }
  return gauge;
}

/// How much of the gauge rows see, by column, relative to the rows.
double Seen(const MatrixXd& rows, const MatrixXd& gauge) {
  return (rows * gauge * gauge.colwise().norm().cwiseInverse().asDiagonal()).norm() / rows.norm();
}

struct Sliding : WindowFixture {
  Sliding(unsigned seed, bool first_estimates) : WindowFixture(seed, 7, 16, 1.0), keeps(first_estimates) {
    EXPECT_TRUE(
        MakeInitialPrior(ErrorConvention::kSo3xRn, window.frame(0), 1e-4 * Matrix15d::Identity(), &prior));
    prior.jacobian.setZero();  // yaw and position are unknown
    const std::vector<FrameGeometry> geometry = MakeGeometry(window, T_BC);
    for (auto& [id, track] : window.tracks()) {  // bases in all but the last frames
      const WindowFrame& from = *track.views.front().frame;
      track.views.erase(track.views.begin(), track.views.begin() + (id / 2) % 4);
      AnchorChange moved;
      EXPECT_TRUE(ChangeAnchor(geometry[static_cast<size_t>(from.index)],
                               geometry[static_cast<size_t>(track.views.front().frame->index)],
                               track.landmark, &moved));
      track.landmark = moved.to;
    }
  }
  /// Of the tracks that leave with the oldest frame, or of all.
  [[nodiscard]] PoseSystem Vision(bool leaving) {
    const std::vector<FrameGeometry> geometry = MakeGeometry(window, T_BC);
    PoseSystem vision(window.size());
    TrackWorkspace workspace;
    for (auto& [id, track] : window.tracks()) {
      if (!leaving || track.views.front().frame->index == 0) {
        EXPECT_TRUE(AddTrack(track.views, geometry, {}, track.landmark, &workspace, &vision));
      }
    }
    return vision;
  }
  void Leave() {
    prior = test::Marginalize(window, prior, Vision(true), {gravity_W});
    if (keeps) {
      KeepFirstEstimates(prior, &window);
    }
    for (auto& [id, track] : window.tracks()) {
      if (!track.views.empty() && track.views.front().frame->index == 0) {
        track.Restart();
      }
    }
    std::erase_if(window.tracks(), [](const auto& item) { return item.second.views.empty(); });
    window.RemoveOldest();
  }
  /// As a solve would.
  void Move() {
    for (const std::unique_ptr<WindowFrame>& frame : window.frames()) {
      PackNavState(Retract(ErrorConvention::kSo3xRn, frame->nav_state(), SomeShift(&random)),
                   frame->nav.data());
    }
  }
  [[nodiscard]] double SeenByPrior() const {
    const MatrixXd gauge = NullSpace(window);
    MatrixXd jacobian = MatrixXd::Zero(prior.jacobian.rows(), 15 * window.size());
    for (size_t i = 0; i < prior.anchors.size(); ++i) {
      const LinearPrior::Anchor& anchor = prior.anchors[i];
      const NavState now = anchor.frame->nav_state();
      const Matrix9d chain = prior.chart.LocalJacobian(anchor.origin, now) * prior.chart.InverseJacobian(now);
      const Index width = i == 0 ? 9 : 6;
      jacobian.middleCols(15 * static_cast<Index>(i), 9) =
          prior.jacobian.middleCols(prior.columns().Frame(static_cast<int>(i)).first, width) *
          chain.topRows(width);
    }
    return Seen(jacobian, gauge);
  }
  [[nodiscard]] double SeenByImu() const {
    const MatrixXd gauge = NullSpace(window);
    double worst = 0;
    for (int i = 0; i + 1 < window.size(); ++i) {
      const test::ImuRows imu = test::LinearizeImu(window.frame(i), window.frame(i + 1), gravity_W);
      Eigen::Matrix<double, 15, 30> both;
      both << imu.first, imu.second;
      worst = std::max(worst, Seen(both, gauge.middleRows<30>(15 * i)));
    }
    return worst;
  }
  [[nodiscard]] double SeenByVision() {
    EXPECT_FALSE(window.tracks().empty());
    const MatrixXd gauge = NullSpace(window);
    MatrixXd poses(6 * window.size(), 4);
    for (int i = 0; i < window.size(); ++i) {
      poses.middleRows<6>(6 * i) = gauge.middleRows<6>(15 * i);
    }
    return Seen(Vision(false).hessian.selfadjointView<Eigen::Lower>(), poses);
  }

  bool keeps;
  LinearPrior prior;
};

// GIVEN a window that slides while its states move, WHEN Jacobians stay where the prior was linearised, THEN
// prior, IMU and vision all leave yaw and position undecided, along the same directions.
TEST(FirstEstimateTest, YawAndPositionStayUnobservable) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Sliding sliding(seed, true);
    for (int k = 0; k < 3; ++k) {
      sliding.Leave();
      sliding.Move();
      EXPECT_LT(sliding.SeenByPrior(), 1e-7) << "seed " << seed << ", leave " << k;
      EXPECT_LT(sliding.SeenByImu(), 1e-8);
      EXPECT_LT(sliding.SeenByVision(), 1e-8);
    }
  }
}

// WHEN they move along with the states, THEN the prior holds information about them after the second frame.
TEST(FirstEstimateTest, WithoutFirstEstimatesThePriorGainsInformationAboutThem) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Sliding sliding(seed, false);
    sliding.Leave();
    sliding.Move();
    EXPECT_GT(sliding.SeenByPrior(), 1e-5);
    EXPECT_LT(sliding.SeenByImu(), 1e-8);  // each factor by itself keeps its own null space
    EXPECT_LT(sliding.SeenByVision(), 1e-8);
    sliding.Leave();
    EXPECT_GT(sliding.SeenByPrior(), 1e-5);
  }
}

// The spread of the window does not change when everything turns about gravity or shifts.
TEST(FirstEstimateTest, TheSpreadLeavesYawAndPositionUndecided) {
  for (const bool keeps : {true, false}) {
    Sliding sliding(6, keeps);
    sliding.Leave();
    sliding.Move();
    sliding.prior.calibration_origin.mean.T_BC = sliding.T_BC;
    sliding.prior.spread = 1;
    std::vector<NavState> states;
    MatrixXd row = MatrixXd::Zero(1, 15 * sliding.window.size());
    for (const std::unique_ptr<WindowFrame>& frame : sliding.window.frames()) {
      states.push_back(frame->nav_state());
    }
    const LinearPrior::SpreadChange spread = sliding.prior.SpreadAt(states);
    for (Index i = 0; i < spread.slope.cols(); ++i) {
      row.middleCols<6>(15 * i) = spread.slope.col(i).transpose();
    }
    EXPECT_GT(row.norm(), 0.01);
    EXPECT_LT(Seen(row, NullSpace(sliding.window)), 1e-9);
  }
}

/// The residual, and beside it the sums of the Jacobians' columns, one column a block.
template <typename Factor>
MatrixXd Evaluate(const Factor& factor, const std::vector<const double*>& parameters) {
  MatrixXd all(factor.rows(), 1);
  std::vector<std::vector<double>> storage;
  std::vector<double*> jacobians;
  for (const BlockKind kind : factor.blocks()) {
    storage.emplace_back(static_cast<size_t>(factor.rows() * TangentSize(kind)));
  }
  jacobians.reserve(storage.size());
  for (std::vector<double>& each : storage) {
    jacobians.push_back(each.data());
  }
  EXPECT_TRUE(factor.Evaluate(parameters.data(), all.data(), jacobians.data()));
  for (const std::vector<double>& each : storage) {
    all.conservativeResize(Eigen::NoChange, all.cols() + 1);
    using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Index width = static_cast<Index>(each.size()) / factor.rows();
    all.rightCols<1>() = Eigen::Map<const RowMatrix>(each.data(), factor.rows(), width).rowwise().sum();
  }
  return all;
}

// The first estimates change no residual, and at the first estimate itself no Jacobian.
TEST(FirstEstimateTest, FactorsKeepTheirResiduals) {
  Sliding sliding(6, true);
  const WindowTrack& track = *sliding.tracks().front();
  const WindowFrame& first = *track.views.front().frame;
  const WindowFrame& last = *track.views.back().frame;
  const auto everything = [&] {
    const ImuFactor imu(&*sliding.window.frame(1).preintegration, sliding.gravity_W,
                        sliding.window.frame(0).first_estimate(), sliding.window.frame(1).first_estimate());
    const InverseDepthFactor depth(&first, &track.views.back(), &sliding.calibration);
    PoseOnlyCost pose_only(sliding.window, sliding.tracks(), sliding.calibration, {});
    const double cost = pose_only.Solve(PointOf(sliding.window, sliding.calibration.mean));
    NormalEquations equations;
    EXPECT_TRUE(pose_only.Linearize(&equations));
    MatrixXd reduced(equations.gradient.size(), equations.gradient.size() + 2);
    reduced << VectorXd::Constant(equations.gradient.size(), cost), equations.hessian, equations.gradient;
    const std::vector<double> no_error(CalibrationLayout::kMaxSize, 0);
    const WindowFrame& zero = sliding.window.frame(0);
    const WindowFrame& one = sliding.window.frame(1);
    return std::vector<MatrixXd>{
        Evaluate(imu, {zero.nav.data(), zero.bias.data(), one.nav.data(), one.bias.data()}),
        Evaluate(depth, {first.nav.data(), last.nav.data(), track.landmark.data(), no_error.data()}),
        reduced};
  };
  const std::vector<MatrixXd> plain = everything();
  for (int i = 0; i < sliding.window.size(); ++i) {
    WindowFrame& frame = sliding.window.frame(i);
    frame.first = FirstEstimate{{ErrorConvention::kSo3xRn}, frame.nav_state(), i == 0};
  }
  const std::vector<MatrixXd> there = everything();
  for (size_t i = 0; i < plain.size(); ++i) {
    EXPECT_LT((there[i] - plain[i]).norm(), 1e-9 * plain[i].norm()) << i;
  }
  for (int i = 0; i < sliding.window.size(); ++i) {
    sliding.window.frame(i).first->state.p_WB += sliding.random.Vector(0.1);
  }
  const std::vector<MatrixXd> elsewhere = everything();
  for (size_t i = 0; i < plain.size(); ++i) {
    EXPECT_EQ(elsewhere[i].col(0), there[i].col(0)) << i;
    EXPECT_GT((elsewhere[i] - there[i]).norm(), 1e-6 * there[i].norm()) << i;
  }
}

}  // namespace
}  // namespace alidade
