#include "filter/slam_features.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/random.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/landmark_flight.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

using test::Flight;
using test::kFlightGravity;
using test::kFlightSigma;

VectorXd RandomError(RandomStream* random, Index size, double scale) {
  VectorXd error(size);
  for (Index i = 0; i < size; ++i) {
    error[i] = scale * random->Normal();
  }
  return error;
}

/// A common turn and a common shift of everything, 6 columns in the state's layout: right-invariant error.
MatrixXd CommonMotion(const FilterState& state) {
  MatrixXd motion = MatrixXd::Zero(state.covariance().dimension(), 6);
  for (size_t i = 0; i < state.clones().size(); ++i) {
    motion.block<6, 6>(state.CloneOffset(i), 0).setIdentity();
  }
  for (size_t i = 0; i < state.landmarks().size(); ++i) {
    motion.block<3, 3>(state.LandmarkOffset(i), 3).setIdentity();
  }
  return motion;
}

class EveryConvention : public ::testing::TestWithParam<ErrorConvention> {};
INSTANTIATE_TEST_SUITE_P(Conventions, EveryConvention, ::testing::ValuesIn(test::kAllConventions),
                         [](const auto& test_case) { return std::string(ToString(test_case.param)); });

TEST_P(EveryConvention, LandmarkEntersWithTheDenseFormula) {
  Flight flight(GetParam(), false);
  for (int i = 0; i < 6; ++i) {
    flight.Frame();
  }
  flight.update_.Begin(flight.state_);
  LandmarkRows rows;
  ASSERT_EQ(flight.update_.AppendLandmark(flight.state_, flight.track_, &rows), TrackOutcome::kReady);
  flight.Apply();
  const MatrixXd before = flight.state_.covariance().Covariance();
  rows.t = {0.3, -0.1, 0.2};
  const Vector3d expected = rows.landmark.p_W + rows.R_f.inverse() * rows.t;
  flight.state_.AddLandmark(rows);
  EXPECT_LT((flight.state_.landmarks()[0].p_W - expected).norm(), 1e-12);
  const MatrixXd after = flight.state_.covariance().Covariance();
  const MatrixXd gain = -rows.R_f.inverse() * rows.T;
  const Index n = before.rows();
  ASSERT_EQ(after.rows(), n + 3);
  EXPECT_EQ((after.bottomRightCorner(n, n) - before).norm(), 0) << "the rest is not touched";
  EXPECT_LT((after.topRightCorner(3, n) - gain * before).norm(), 1e-12 * (gain * before).norm());
  const MatrixXd own = gain * before * gain.transpose() + rows.R_f.inverse() * rows.R_f.inverse().transpose();
  EXPECT_LT((after.topLeftCorner(3, 3) - own).norm(), 1e-12 * own.norm());
}

TEST_P(EveryConvention, RowsOfALandmarkAreNumeric) {
  RandomStream random(1, "rows of a landmark");
  for (int trial = 0; trial < 20; ++trial) {
    Flight flight(GetParam(), false);
    for (int i = 0; i < 6; ++i) {
      flight.Frame(kFlightSigma * RandomError(&random, 2, 1));
    }
    flight.EnterLandmark();
    for (int i = 0; i <= trial % 3; ++i) {
      flight.Frame(kFlightSigma *
                   RandomError(&random, 2, 1));  // the anchor is the newest clone, or an older one
    }
    flight.ObserveLandmark(flight.state_);
    const MatrixXd analytic = flight.update_.jacobian();
    const auto innovation = [&](const VectorXd& xi) -> VectorXd {
      FilterState moved = flight.state_;
      moved.Correct(xi);
      flight.ObserveLandmark(moved);
      return -flight.update_.innovation();
    };
    EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(innovation, analytic.cols()), 1e-7), "");
  }
}

// Entering with the first views and adding the others one at a time is the joint update of all of them.
TEST_P(EveryConvention, ALandmarkThatCameAndWentLeavesWhatAJointUpdateLeaves) {
  Flight kept(GetParam(), false);
  Flight joint(GetParam(), false);
  for (int i = 0; i < 10; ++i) {
    kept.Frame();
    joint.Frame();
    if (i == 5) {
      kept.EnterLandmark();
    } else if (i > 5) {
      kept.ObserveLandmark(kept.state_);
      kept.Apply();
    }
  }
  kept.state_.RemoveLandmark(0);
  joint.update_.Begin(joint.state_);
  ASSERT_EQ(joint.update_.Append(joint.state_, joint.track_), TrackOutcome::kReady);
  joint.Apply();
  const MatrixXd expected = joint.state_.covariance().Covariance();
  const MatrixXd actual = kept.state_.covariance().Covariance();
  ASSERT_EQ(actual.rows(), expected.rows());
  const VectorXd scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (actual - expected) * scale.asDiagonal()).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(SlamFeaturesTest, AMovedAnchorChangesNoPredictionAndNoObservation) {
  RandomStream random(2, "anchors");
  Flight flight(ErrorConvention::kRightInvariant, false);
  for (int i = 0; i < 6; ++i) {
    flight.Frame();
  }
  flight.EnterLandmark();
  const size_t anchor = flight.state_.clones().size() - 1;
  flight.Frame();
  flight.ObserveLandmark(flight.state_);
  const auto prediction_covariance = [&] {
    const MatrixXd h = flight.update_.jacobian();
    return MatrixXd(h * flight.state_.covariance().Covariance() * h.transpose());
  };
  const MatrixXd before = prediction_covariance();
  flight.state_.RemoveClone(anchor);
  EXPECT_EQ(flight.state_.landmarks()[0].anchor_serial, flight.serial_);
  flight.ObserveLandmark(flight.state_);
  EXPECT_LT((prediction_covariance() - before).norm(), 1e-9 * before.norm());
}

TEST(SlamFeaturesTest, RightInvariantRowsAnnihilateCommonMotionWhereverTheLandmarkIsLinearised) {
  RandomStream random(3, "common motion");
  for (int trial = 0; trial < 20; ++trial) {
    Flight flight(ErrorConvention::kRightInvariant, false);
    for (int i = 0; i < 6; ++i) {
      flight.Frame(kFlightSigma * RandomError(&random, 2, 1));
    }
    flight.EnterLandmark();
    flight.Frame();
    flight.state_.Correct(RandomError(&random, flight.state_.covariance().dimension(), 0.05));
    flight.ObserveLandmark(flight.state_);
    EXPECT_LT((flight.update_.jacobian() * CommonMotion(flight.state_)).cwiseAbs().maxCoeff(), 1e-8);
  }
}

/// Turn about gravity and common shift, in the additive error at the given poses and point.
MatrixXd UnobservableDirections(const FilterState& state, bool first) {
  const Vector3d up = -kFlightGravity.normalized();
  MatrixXd directions = MatrixXd::Zero(state.covariance().dimension(), 4);
  for (size_t i = 0; i < state.clones().size(); ++i) {
    const Pose& T_WB = first ? state.clones()[i].T_WB_first : state.clones()[i].T_WB;
    directions.block<3, 1>(state.CloneOffset(i), 0) = T_WB.rotation.transpose() * up;
    directions.block<3, 1>(state.CloneOffset(i) + 3, 0) = up.cross(T_WB.translation);
    directions.block<3, 3>(state.CloneOffset(i) + 3, 1).setIdentity();
  }
  for (size_t i = 0; i < state.landmarks().size(); ++i) {
    const Landmark& landmark = state.landmarks()[i];
    directions.block<3, 1>(state.LandmarkOffset(i), 0) = up.cross(first ? landmark.p_W_first : landmark.p_W);
    directions.block<3, 3>(state.LandmarkOffset(i), 1).setIdentity();
  }
  return directions;
}

class TransitionRecorder : public FilterObserver {
 public:
  void OnPropagate(const Matrix15d& phi, const Matrix15d& /*q*/) override { phi_ = phi; }
  Matrix15d phi_;
};

Eigen::Matrix<double, 15, 4> UnobservableCore(const NavState& nav) {
  const Vector3d up = -kFlightGravity.normalized();
  Eigen::Matrix<double, 15, 4> directions = Eigen::Matrix<double, 15, 4>::Zero();
  directions.block<3, 1>(0, 0) = nav.R_WB.transpose() * up;
  directions.block<3, 1>(3, 0) = up.cross(nav.p_WB);
  directions.block<3, 1>(6, 0) = up.cross(nav.v_WB);
  directions.block<3, 3>(3, 1).setIdentity();
  return directions;
}

TEST(FirstEstimatesTest, TransitionsAndRowsKeepTheFourUnobservableDirections) {
  for (const bool first_estimates : {true, false}) {
    RandomStream random(4, "first estimates");
    Flight flight(ErrorConvention::kSo3xRn, first_estimates);
    TransitionRecorder recorder;
    flight.state_.SetObserver(&recorder);
    double rows = 0;
    double transitions = 0;
    for (int i = 0; i < 10; ++i) {
      const NavState from = flight.state_.nav_first();
      flight.Frame(kFlightSigma * RandomError(&random, 2, 1));
      const MatrixXd carried = recorder.phi_ * UnobservableCore(from);
      transitions = std::max(transitions,
                             (carried - UnobservableCore(flight.state_.nav_first())).cwiseAbs().maxCoeff());
      if (i == 5) {
        flight.EnterLandmark();
      }
      // As if other tracks had moved the state: no linearisation point stays where it was.
      flight.state_.Correct(RandomError(&random, flight.state_.covariance().dimension(), 0.01));
      if (i > 5) {
        flight.ObserveLandmark(flight.state_);
        rows = std::max(
            rows,
            (flight.update_.jacobian() * UnobservableDirections(flight.state_, true)).cwiseAbs().maxCoeff());
      }
    }
    if (first_estimates) {
      EXPECT_LT(transitions, 1e-9);
      EXPECT_LT(rows, 1e-8);
    } else {
      EXPECT_GT(transitions, 1e-4);
      EXPECT_GT(rows, 1e-2);
    }
  }
}

TEST(FirstEstimatesTest, MsckfRowsKeepTheFourUnobservableDirections) {
  RandomStream random(5, "first estimates");
  Flight flight(ErrorConvention::kSo3xRn, true);
  for (int i = 0; i < 8; ++i) {
    flight.Frame(kFlightSigma * RandomError(&random, 2, 1));
    flight.state_.Correct(RandomError(&random, flight.state_.covariance().dimension(), 2e-3));
  }
  flight.update_.Begin(flight.state_);
  ASSERT_EQ(flight.update_.Append(flight.state_, flight.track_), TrackOutcome::kReady);
  const MatrixXd h = flight.update_.jacobian();
  EXPECT_LT((h * UnobservableDirections(flight.state_, true)).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_GT((h * UnobservableDirections(flight.state_, false)).cwiseAbs().maxCoeff(), 1e-4);
}

}  // namespace
}  // namespace alidade
