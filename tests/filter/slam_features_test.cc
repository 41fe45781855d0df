#include "filter/slam_features.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/random.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kSigma = 2e-3;
const Vector3d kPoint(1.5, -0.8, 9);
const Vector3d kGravity = GravityInWorld(9.81);

/// A filter state that flies sideways past one landmark, frame after frame, and a track of it.
class Flight {
 public:
  Flight(ErrorConvention convention, bool first_estimates)
      : state_(convention, first_estimates, {so3::Exp({0.1, -0.2, 0.05}), {0.1, 0.02, -0.05}}, {12, 4}),
        update_(Filter(), VisionConfig(), 12),
        slam_(Filter(), 12) {
    NavEstimate initial;
    initial.nav = {so3::Exp({0.05, 0.1, -0.1}), {0.3, -0.2, 0.1}, {1.0, 0.4, 0.2}};
    initial.covariance.diagonal() << Vector15d::Constant(1e-4);
    EXPECT_TRUE(state_.Reset(initial).ok());
    track_.id = 7;
  }

  /// Propagates over 0.2 s, clones, and observes the landmark (`noise`: on the normalised plane).
  void Frame(const Eigen::Vector2d& noise = Eigen::Vector2d::Zero()) {
    const auto stamp = [this](int i) { return static_cast<TimeNs>(200'000'000) * serial_ + 20'000'000 * i; };
    std::vector<ImuSample> samples;
    for (int i = 0; i <= 10; ++i) {
      samples.push_back({stamp(i), {0.1, 0.05, -0.08}, {0.2, 0.3, 9.9}});
    }
    const ImuNoise noise_model{3e-4, 1e-3, 3e-5, 2e-4};
    EXPECT_TRUE(state_.Propagate(samples, noise_model, kGravity).ok());
    state_.AddClone(++serial_);
    TrackView view;
    view.serial = serial_;
    view.observation.z = (state_.clones().back().T_WC.Inverse() * kPoint).hnormalized() + noise;
    view.observation.sqrt_information = Eigen::Matrix2d::Identity() / kSigma;
    track_.views.push_back(view);
    track_.last_serial = serial_;
    ++track_.observations;
  }

  /// Applies what update_ holds, corrects and returns the correction.
  VectorXd Apply() {
    VectorXd correction(state_.covariance().dimension());
    MatrixXd rows = update_.jacobian();
    VectorXd innovation = update_.innovation();
    EXPECT_TRUE(
        state_.covariance().Apply(state_.covariance().Prepare(rows, innovation), correction, nullptr));
    state_.Correct(correction);
    return correction;
  }

  void EnterLandmark() {
    TrackStore store;
    store.tracks().push_back(track_);
    update_.Begin(state_);
    slam_.Begin();
    ASSERT_TRUE(slam_.IsCandidate(state_, track_, serial_));
    ASSERT_EQ(update_.AppendLandmark(state_, track_, slam_.TakeRows()), TrackOutcome::kReady);
    slam_.AssignBlock(0);
    slam_.Enter(Apply(), {1.0}, &state_, &store);
    EXPECT_TRUE(store.tracks().front().in_state);
    track_.in_state = true;
  }

  /// The rows of the landmark's newest observation at `state`.
  void ObserveLandmark(const FilterState& state) {
    update_.Begin(state);
    ASSERT_EQ(slam_.Append(state, track_, &update_), TrackOutcome::kReady);
  }

  static FilterConfig Filter() {
    FilterConfig filter;
    filter.landmark = FilterLandmark::kMsckf;
    filter.slam_features = 4;
    filter.slam_min_track = 5;
    return filter;
  }

  FilterState state_;
  FeatureUpdate update_;
  SlamFeatures slam_;
  Track track_;
  int serial_ = 0;
};

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
      flight.Frame(kSigma * RandomError(&random, 2, 1));
    }
    flight.EnterLandmark();
    for (int i = 0; i <= trial % 3; ++i) {
      flight.Frame(kSigma * RandomError(&random, 2, 1));  // the anchor is the newest clone, or an older one
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

// GIVEN a track that five views made a memory of WHEN it becomes a landmark instead and sees on THEN nothing
// was lost: the state is that of one joint update of all views.
TEST_P(EveryConvention, ACarriedMemoryStaysOne) {
  SlamFeatures slam(Flight::Filter(), 12);
  Flight flight(GetParam(), false);
  flight.Frame();
  TrackStore store;
  store.tracks().push_back(flight.track_);
  store.tracks().front().observations = 100;
  TrackMemory& memory = store.tracks().front().memory;
  memory.active = true;
  memory.carried = true;
  slam.Promote(flight.serial_, &store, &flight.state_);
  EXPECT_TRUE(memory.active);
  EXPECT_FALSE(store.tracks().front().in_state);
  EXPECT_TRUE(flight.state_.landmarks().empty());
}

TEST_P(EveryConvention, APromotedMemoryLosesNothing) {
  FilterConfig filter = Flight::Filter();
  filter.error = GetParam();
  filter.track_memory = TrackMemoryPolicy::kCarry;
  filter.memory_depth_deviation = 0.5;
  FeatureUpdate update(filter, VisionConfig(), 12);
  SlamFeatures slam(filter, 12);
  Flight promoted(GetParam(), false);
  Flight joint(GetParam(), false);
  for (int i = 0; i < 9; ++i) {
    promoted.Frame();
    joint.Frame();
    Track& track = promoted.track_;
    if (i == 4) {
      update.Begin(promoted.state_);
      ASSERT_EQ(update.AppendToRemember(promoted.state_, track), TrackOutcome::kReady);
      update.Remember(promoted.state_, 0, 1, 0, &track);
      ASSERT_TRUE(track.memory.active);
      VectorXd correction(promoted.state_.covariance().dimension());
      SquareRootCovariance& covariance = promoted.state_.covariance();
      ASSERT_TRUE(covariance.Apply(update.Prepare(-1, &covariance), correction, nullptr));
    } else if (i == 5) {
      TrackStore store;
      store.tracks().push_back(track);
      slam.Promote(promoted.serial_, &store, &promoted.state_);
      track = store.tracks().front();
      EXPECT_TRUE(track.in_state);
      EXPECT_FALSE(track.memory.active);
      ASSERT_EQ(promoted.state_.landmarks().size(), 1u);
    }
    if (i >= 5) {
      promoted.ObserveLandmark(promoted.state_);
      promoted.Apply();
    }
  }
  promoted.state_.RemoveLandmark(0);
  joint.update_.Begin(joint.state_);
  ASSERT_EQ(joint.update_.Append(joint.state_, joint.track_), TrackOutcome::kReady);
  joint.Apply();
  const MatrixXd expected = joint.state_.covariance().Covariance();
  const VectorXd scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd difference = promoted.state_.covariance().Covariance() - expected;
  EXPECT_LT((scale.asDiagonal() * difference * scale.asDiagonal()).cwiseAbs().maxCoeff(), 1e-8);
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
      flight.Frame(kSigma * RandomError(&random, 2, 1));
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
  const Vector3d up = -kGravity.normalized();
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
  const Vector3d up = -kGravity.normalized();
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
      flight.Frame(kSigma * RandomError(&random, 2, 1));
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
    flight.Frame(kSigma * RandomError(&random, 2, 1));
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
