// docs/equivalences.md: one update by the pose-only model and one by the MSCKF, on the same observations and
// at the same linearisation point, leave the same state and covariance.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/SVD>

#include "core/pose_only.h"
#include "filter/feature_update.h"
#include "filter/filter.h"
#include "filter/filter_state.h"
#include "tests/support/pose_only_model.h"
#include "tests/support/random_states.h"
#include "tests/support/scenario.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kClones = 7;
constexpr int kTracks = 6;
constexpr double kSigma = 2e-3;

struct Outcome {
  NavEstimate estimate;
  std::vector<Pose> clones;
  MatrixXd covariance;
};

/// A window of clones after half a second of motion, and tracks that see random landmarks with noise.
struct Window {
  explicit Window(ErrorConvention convention, unsigned seed)
      : random(seed), state(convention, false, random.RandomPose(0.1), {kClones, 0}) {
    NavEstimate start;
    start.nav = random.Nav(3);
    start.covariance = 1e-4 * Matrix15d::Identity();
    EXPECT_TRUE(state.Reset(start).ok());
    const Vector3d gyro = random.Vector(0.5);
    const Vector3d accel = start.nav.R_WB.transpose() * Vector3d(0, 0, 9.81) + random.Vector(2);
    for (int clone = 1; clone <= kClones; ++clone) {
      std::vector<ImuSample> samples;
      for (int i = 0; i <= 10; ++i) {
        samples.push_back({state.stamp_ns() + i * 10'000'000, gyro, accel});
      }
      state.Propagate(samples, ImuNoise(), Vector3d(0, 0, -9.81));
      state.AddClone(clone);
    }
    for (int i = 0; i < kTracks; ++i) {
      AddTrack();
    }
  }

  void AddTrack() {
    const Vector3d point =
        state.clones().back().T_WC * Vector3d(random.Uniform(-2, 2), random.Uniform(-2, 2), 6);
    Track track;
    for (const Clone& clone : state.clones()) {
      const Vector3d p = clone.T_WC.Inverse() * point;
      if (p.z() < 1) {
        continue;
      }
      NormalizedObservation observation;
      observation.z = p.head<2>() / p.z() + random.Vector(kSigma).head<2>();
      observation.sqrt_information = Eigen::Matrix2d::Identity() / kSigma;
      track.views.push_back({clone.serial, observation});
    }
    tracks.push_back(track);
  }

  [[nodiscard]] Outcome Look() const {
    Outcome outcome{state.Estimate(), {}, state.covariance().Covariance()};
    for (const Clone& clone : state.clones()) {
      outcome.clones.push_back(clone.T_WB);
    }
    return outcome;
  }

  test::RandomStates random;
  FilterState state;
  std::vector<Track> tracks;
};

/// The filter's update: landmark held fixed, eliminated (the MSCKF's way), square-root algebra.
Outcome MsckfUpdate(Window window) {
  FilterConfig filter;
  filter.landmark = FilterLandmark::kMsckf;
  filter.refine_iterations = 0;  // stay at the pose-only depth: the linearisation point of the other update
  VisionConfig vision;
  vision.max_relative_depth_deviation = 1;
  FeatureUpdate update(filter, vision, kClones);
  update.Begin(window.state);
  for (const Track& track : window.tracks) {
    EXPECT_EQ(update.Append(window.state, track), TrackOutcome::kReady);
  }
  VectorXd correction(window.state.covariance().dimension());
  SquareRootCovariance& covariance = window.state.covariance();
  EXPECT_TRUE(covariance.Apply(update.Prepare(-1, &covariance), correction, nullptr));
  window.state.Correct(correction);
  return window.Look();
}

/// Rows of one track by the paper's model: total derivatives through the depth, residual noise H_n n; the
/// range of H_n is reached by the 2N-3 left singular vectors that a noise-free H_n would have.
void PoseOnlyRows(const FilterState& state, const Track& track, MatrixXd* h, MatrixXd* noise, VectorXd* y) {
  std::vector<Pose> views;
  std::vector<Vector2d> points;
  for (const TrackView& view : track.views) {
    views.push_back(state.clones()[static_cast<size_t>(state.FindClone(view.serial))].T_WC);
    points.push_back(view.observation.z);
  }
  const Index count = static_cast<Index>(views.size());
  PoseOnlyDepth depth;
  VectorXd residual;
  MatrixXd total;
  MatrixXd by_observations;
  ASSERT_TRUE(test::PoseOnlyModel{}.Evaluate(views, points, &depth, &residual, &total, &by_observations));
  // N spans what no landmark can explain: the left null space of d prediction / d p_f.
  MatrixXd by_landmark(2 * count, 3);
  for (Index k = 0; k < count; ++k) {
    const Pose& view = views[static_cast<size_t>(k)];
    const Vector3d p = view.Inverse() * depth.p_W;
    Eigen::Matrix<double, 2, 3> projection;
    projection << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
    by_landmark.middleRows<2>(2 * k) = projection * view.rotation.transpose();
  }
  const Eigen::JacobiSVD<MatrixXd> svd(by_landmark, Eigen::ComputeFullU);
  const MatrixXd n = svd.matrixU().rightCols(2 * count - 3);
  h->setZero(n.cols(), state.covariance().dimension());
  for (Index k = 0; k < count; ++k) {
    const int index = state.FindClone(track.views[static_cast<size_t>(k)].serial);
    const Clone& clone = state.clones()[static_cast<size_t>(index)];
    h->middleCols<6>(state.CloneOffset(static_cast<size_t>(index))) =
        n.transpose() * total.middleCols<6>(6 * k) * clone.camera_from_error;
  }
  const MatrixXd h_n = n.transpose() * (MatrixXd::Identity(2 * count, 2 * count) - by_observations);
  *noise = kSigma * kSigma * h_n * h_n.transpose();
  *y = -n.transpose() * residual;
}

/// Textbook Kalman update in dense algebra, all tracks at once.
Outcome PoseOnlyUpdate(Window window) {
  const MatrixXd prior = window.state.covariance().Covariance();
  MatrixXd h(0, prior.cols());
  MatrixXd noise(0, 0);
  VectorXd y(0);
  for (const Track& track : window.tracks) {
    MatrixXd rows;
    MatrixXd rows_noise;
    VectorXd rows_y;
    PoseOnlyRows(window.state, track, &rows, &rows_noise, &rows_y);
    const Index first = h.rows();
    const Index total = first + rows.rows();
    h.conservativeResize(total, Eigen::NoChange);
    h.bottomRows(rows.rows()) = rows;
    y.conservativeResize(total);
    y.tail(rows.rows()) = rows_y;
    noise.conservativeResizeLike(MatrixXd::Zero(total, total));
    noise.bottomRightCorner(rows.rows(), rows.rows()) = rows_noise;
  }
  const MatrixXd innovation = h * prior * h.transpose() + noise;
  const MatrixXd gain = innovation.ldlt().solve(h * prior).transpose();
  window.state.Correct(gain * y);
  Outcome outcome = window.Look();
  outcome.covariance = prior - gain * h * prior;
  return outcome;
}

TEST(EquivalenceTest, OnePoseOnlyUpdateLeavesTheStateAndCovarianceOfOneMsckfUpdate) {
  for (const ErrorConvention convention :
       {ErrorConvention::kRightInvariant, ErrorConvention::kLeftInvariant, ErrorConvention::kSo3xRn}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const Window window(convention, seed);
      const Outcome prior = window.Look();
      const Outcome msckf = MsckfUpdate(window);
      const Outcome pose_only = PoseOnlyUpdate(window);
      EXPECT_GT((msckf.estimate.nav.p_WB - prior.estimate.nav.p_WB).norm(), 1e-6) << "it must do something";
      EXPECT_LT((msckf.estimate.nav.p_WB - pose_only.estimate.nav.p_WB).norm(), 1e-9);
      EXPECT_LT((msckf.estimate.nav.R_WB - pose_only.estimate.nav.R_WB).norm(), 1e-9);
      EXPECT_LT((msckf.estimate.nav.v_WB - pose_only.estimate.nav.v_WB).norm(), 1e-9);
      for (size_t i = 0; i < msckf.clones.size(); ++i) {
        EXPECT_LT((msckf.clones[i].translation - pose_only.clones[i].translation).norm(), 1e-9);
      }
      EXPECT_LT((msckf.covariance - pose_only.covariance).cwiseAbs().maxCoeff(), 1e-9);
      EXPECT_GT((msckf.covariance - prior.covariance).cwiseAbs().maxCoeff(), 1e-6);
    }
  }
}

/// The filter's two settings differ in the linearisation point alone: on noise-free data, where depth and
/// reprojection minimum are the same landmark, whole runs are the same run.
TEST(EquivalenceTest, OnNoiseFreeDataPoseOnlyAndMsckfFiltersAreTheSame) {
  SimulatorConfig sim;
  sim.duration_s = 5;
  sim.path_m = 6.5;
  sim.pixel_noise_px = 0;
  const Dataset dataset = test::SimulateOrDie(sim, 2);
  EstimatorConfig config;
  config.filter.update = UpdateTiming::kDelayedAll;
  const auto run = [&](FilterLandmark landmark) {
    config.filter.landmark = landmark;
    const std::unique_ptr<Estimator> filter = MakeFilter(config, dataset.rig);
    return test::RunScenario(dataset, test::DrawInitialState(dataset, 2, 0), filter.get()).last;
  };
  const NavEstimate pose_only = run(FilterLandmark::kPoseOnlyMulti);
  const NavEstimate msckf = run(FilterLandmark::kMsckf);
  const double deviation = std::sqrt(msckf.covariance.diagonal().segment<3>(3).sum());
  EXPECT_LT((pose_only.nav.p_WB - msckf.nav.p_WB).norm(), 0.05 * deviation);
  EXPECT_LT((pose_only.covariance - msckf.covariance).norm(), 1e-2 * msckf.covariance.norm());
}

}  // namespace
}  // namespace alidade
