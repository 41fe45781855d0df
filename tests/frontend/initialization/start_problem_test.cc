#include "frontend/initialization/start_problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/frontend/initialization/start_window.h"
#include "tests/support/jacobian_checker.h"

// The gradient of the refinement of a start against numeric differences of its cost.

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class StartProblemTest : public testing::Test {
 protected:
  void SetUp() override {
    test::MakeStartWindow(EstimatorConfig(), test::MovingSequence(), 60, &start_);
    ASSERT_FALSE(HasFatalFailure());
  }

  [[nodiscard]] Index States() const { return static_cast<Index>(start_.states.size()); }

  /// The states moved by (phi, dp, dv) each, and the one bias of all of them, with these tracks.
  [[nodiscard]] StartProblem Problem(const VectorXd& zeta, const std::vector<bool>& tracks) const {
    std::vector<NavState> states = start_.states;
    for (Index k = 0; k < States(); ++k) {
      NavState& state = states[static_cast<size_t>(k)];
      state = Retract(ErrorConvention::kSo3xRn, state, Vector9d(zeta.segment<9>(9 * k)));
    }
    const ImuBias bias = {start_.bias.gyro + zeta.tail<6>().head<3>(), start_.bias.accel + zeta.tail<3>()};
    return {start_.window, tracks, start_.steps, states, bias, start_.settings};
  }

  /// Half the cost, a vector of one, and its gradient over zeta.
  [[nodiscard]] VectorXd HalfCost(const VectorXd& zeta, const std::vector<bool>& tracks) const {
    return VectorXd::Constant(1, 0.5 * Problem(zeta, tracks).Linearize());
  }
  [[nodiscard]] Eigen::RowVectorXd Gradient(const std::vector<bool>& tracks) const {
    StartProblem problem = Problem(VectorXd::Zero(Columns()), tracks);
    problem.Linearize();
    Eigen::RowVectorXd gradient = Eigen::RowVectorXd::Zero(Columns());
    for (Index k = 0; k < States(); ++k) {
      gradient.segment<9>(9 * k) = problem.gradient().segment<9>(15 * k).transpose();
      gradient.tail<6>() += problem.gradient().segment<6>(15 * k + 9).transpose();
    }
    return gradient;
  }
  [[nodiscard]] int Columns() const { return static_cast<int>(9 * States() + 6); }

  /// Each group of three coordinates against its own largest entry.
  static void ExpectEqual(const MatrixXd& analytic, const MatrixXd& numeric, double tolerance) {
    for (Index first = 0; first < numeric.cols(); first += 3) {
      EXPECT_EQ(
          test::CompareJacobians(analytic.middleCols<3>(first), numeric.middleCols<3>(first), tolerance), "")
          << "columns from " << first;
    }
  }

  test::StartWindow start_;
};

// GIVEN no tracks, THEN preintegrations and priors have the gradient of their cost.
TEST_F(StartProblemTest, InertialGradientAgainstDifferences) {
  const std::vector<bool> none(start_.window.tracks.size(), false);
  const auto cost = [&](const VectorXd& zeta) { return HalfCost(zeta, none); };
  ExpectEqual(Gradient(none), test::NumericJacobian(cost, Columns(), 1e-5), 1e-5);
}

// GIVEN the longest tracks besides, THEN what they add to the gradient is what they add to the derivative of
// the cost. Their residuals are far inside the kernel, so that the landmarks, which are refined without it,
// are at their optimum; the IMU is so noisy that its cost does not take their digits.
TEST_F(StartProblemTest, VisualGradientAgainstDifferences) {
  constexpr double kShrink = 1e-3;
  constexpr size_t kTracks = 20;
  for (SharedTrack& track : start_.window.tracks) {
    for (NormalizedObservation& observation : track.observations) {
      observation.sqrt_information *= kShrink;
    }
  }
  start_.steps = PreintegrateWindow(start_.window, start_.bias, {1, 1, 1, 1});
  ASSERT_GT(start_.window.tracks.size(), kTracks);
  const std::vector<bool> none(start_.window.tracks.size(), false);
  std::vector<bool> longest = none;
  std::fill(longest.begin(), longest.begin() + kTracks, true);
  const auto cost = [&](const VectorXd& zeta) -> VectorXd {
    return (HalfCost(zeta, longest) - HalfCost(zeta, none)) / (kShrink * kShrink);
  };
  const Eigen::RowVectorXd analytic = (Gradient(longest) - Gradient(none)) / (kShrink * kShrink);
  const Index without_velocity = 6;
  EXPECT_GT(analytic.head(without_velocity).cwiseAbs().maxCoeff(), 100);
  ExpectEqual(analytic, test::NumericJacobian(cost, Columns(), 1e-4), 1e-4);
}

}  // namespace
}  // namespace alidade
