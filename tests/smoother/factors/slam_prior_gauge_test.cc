#include <gtest/gtest.h>

#include "smoother/factors/slam_prior.h"
#include "smoother/solve/marginalization.h"
#include "tests/smoother/factors/slam_fixture.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::SlamFixture;

// Yaw and position of the whole window are unknown to vision and IMU, and stay so in the prior, also when the
// window has grown since.
TEST(SlamPriorGaugeTest, NothingIsLearntOfYawAndPosition) {
  SlamFixture fixture(8, ErrorConvention::kRightInvariant, false, {1, 4});
  fixture.first.jacobian.setZero();
  LinearPrior prior = fixture.Leave();
  for (int leave = 0; leave < 2; ++leave) {
    MatrixXd gauge = MatrixXd::Zero(prior.columns().size(), 4);
    for (int i = 0; i < static_cast<int>(prior.anchors.size()); ++i) {
      gauge(prior.columns().Frame(i).first + 2, 0) = 1;
      gauge.block<3, 3>(prior.columns().Frame(i).first + 3, 1).setIdentity();
    }
    EXPECT_LT((prior.jacobian * gauge).norm(), 1e-6 * prior.jacobian.norm());
    // Once more, with anchors that leave.
    SlamChange change{PriorTracks(prior, fixture.window), {}, {}, true};
    for (const WindowTrack* known : change.before) {
      WindowTrack& track = fixture.window.tracks().at(known->id);
      if (track.anchor->index == 0) {
        fixture.Anchor(track.anchor, &fixture.window.newest(), &track);
      }
      change.after.push_back(&track);
    }
    std::vector<NavState> states = PointOf(fixture.window, fixture.calibration.mean).states;
    test::Grow(1.2, fixture.T_BC.translation, &states);
    for (int i = 0; i < fixture.window.size(); ++i) {
      PackNavState(states[static_cast<size_t>(i)], fixture.window.frame(i).nav.data());
    }
    prior = test::Marginalize(fixture.window, prior, fixture.NoVision(), {fixture.gravity_W}, change);
  }
}

/// The prior of vision alone when the oldest frame leaves.
LinearPrior PriorOfVision(const SlamFixture& fixture) {
  LinearPrior nothing = fixture.first;
  nothing.jacobian.setZero();
  nothing.residual.setZero();
  WindowTerms terms;
  const PoseSystem no_vision = fixture.NoVision();
  terms.push_back(std::make_unique<test::GivenTerm>(no_vision));
  const Result<LinearPrior> prior =
      MarginalizeOldest(fixture.window, nothing, fixture.calibration, terms, fixture.change);
  EXPECT_TRUE(prior.ok()) << prior.message();
  return *prior;
}

// GIVEN a prior of vision alone, WHEN frames and landmarks have been found elsewhere since it was made THEN
// it prefers no scale of the window; without a spread it prefers one.
TEST(SlamPriorGaugeTest, NothingIsLearntOfTheScale) {
  for (const bool relative_to_spread : {true, false}) {
    const SlamFixture fixture(8, ErrorConvention::kRightInvariant, false, {3, 4}, test::FixtureView::kAhead,
                              relative_to_spread);
    const LinearPrior prior = PriorOfVision(fixture);
    const ColumnMap columns = prior.columns();
    std::vector<NavState> found = PointOf(fixture.window, fixture.calibration.mean).states;
    test::RandomStates random(5);
    for (NavState& state : found) {
      state.p_WB += random.Vector(0.05);
    }
    const auto residual = [&](double scale) -> VectorXd {
      std::vector<NavState> states = found;
      test::Grow(scale, fixture.T_BC.translation, &states);
      const LinearPrior::SpreadChange spread = prior.SpreadAt(states);
      const LinearPrior::FrameErrors errors = prior.ErrorsAt(states, spread, LinearPrior::Derivative::kHere);
      VectorXd xi = VectorXd::Zero(columns.size());
      for (size_t i = 0; i < prior.anchors.size(); ++i) {
        xi.segment<6>(columns.Frame(static_cast<int>(i)).first) = errors.xi[i].head<6>();
      }
      for (size_t l = 0; l < prior.landmarks.size(); ++l) {
        const double inverse_depth = prior.landmarks[l].origin.z() * (l % 2 == 0 ? 1.1 : 0.9) / scale;
        xi[columns.Landmark(static_cast<int>(l)).first + 2] =
            inverse_depth * spread.ratio - prior.landmarks[l].origin.z();
      }
      return prior.jacobian * xi;
    };
    const double difference = (residual(1.5) - residual(1)).norm() / residual(1).norm();
    if (relative_to_spread) {
      EXPECT_LT(difference, 1e-6);
    } else {
      EXPECT_GT(difference, 0.1);
    }
  }
}

}  // namespace
}  // namespace alidade
