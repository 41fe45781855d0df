#include "smoother/batch/sequence_covariance.h"

#include <ceres/crs_matrix.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "core/imu_propagation.h"
#include "smoother/solve/prior_terms.h"
#include "smoother/solve/sensor_terms.h"
#include "smoother/solve/vision_terms.h"
#include "smoother/solve/window_problem.h"
#include "tests/smoother/batch/batch_fixture.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The normal equations of the whole problem as Ceres sees it: blocks in the order nav, bias of every frame,
/// then landmarks; dense.
struct DenseSystem {
  MatrixXd hessian;
  VectorXd gradient;
};

DenseSystem EvaluateDense(ParameterBlocks* blocks, size_t frames, size_t tracks, ceres::Problem* problem) {
  ceres::Problem::EvaluateOptions options;
  for (size_t i = 0; i < frames; ++i) {
    options.parameter_blocks.push_back(blocks->Nav(static_cast<int>(i)));
    options.parameter_blocks.push_back(blocks->Bias(static_cast<int>(i)));
  }
  for (size_t i = 0; i < tracks; ++i) {
    options.parameter_blocks.push_back(blocks->Landmark(static_cast<int>(i)));
  }
  std::vector<double> residuals;
  ceres::CRSMatrix sparse;
  EXPECT_TRUE(problem->Evaluate(options, nullptr, &residuals, nullptr, &sparse));
  MatrixXd jacobian = MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row) {
    for (int i = sparse.rows[static_cast<size_t>(row)]; i < sparse.rows[static_cast<size_t>(row) + 1]; ++i) {
      jacobian(row, sparse.cols[static_cast<size_t>(i)]) = sparse.values[static_cast<size_t>(i)];
    }
  }
  const Eigen::Map<const VectorXd> r(residuals.data(), static_cast<Index>(residuals.size()));
  return {jacobian.transpose() * jacobian, jacobian.transpose() * r};
}

/// The batch estimate of two seconds, and its problem.
class SequenceCovarianceTest : public testing::Test {
 protected:
  void SetUp() override {
    const Dataset dataset = test::MakeBatchDataset({.duration_s = 2});
    run_ = test::RunBatch(dataset, config_, 1);
    ASSERT_TRUE(run_.frames.ok()) << run_.frames.message();
    for (const BatchTrack& track : run_.estimator->sequence().tracks()) {
      if (track.selected) {
        copies_.push_back(track.used);
      }
    }
    for (WindowTrack& track : copies_) {
      tracks_.push_back(&track);
    }
  }

  [[nodiscard]] const BatchSequence& sequence() const { return run_.estimator->sequence(); }

  /// Of the first `frames` frames and some tracks.
  [[nodiscard]] WindowTerms MakeTerms(const std::vector<WindowTrack*>& tracks, size_t frames) const {
    WindowTerms terms;
    terms.push_back(MakePriorTerm(sequence().prior(), sequence().calibration()));
    const Status status = AddSensorTerms({GravityInWorld(config_.imu.gravity_mps2)}, sequence().frames(),
                                         static_cast<int>(frames), &terms);
    EXPECT_TRUE(status.ok()) << status.message();
    AddTrackTerms(sequence().frames(), tracks, sequence().calibration(), {}, &terms);
    return terms;
  }
  [[nodiscard]] Result<SequenceCovariance> Compute(const std::vector<WindowTrack*>& tracks, size_t frames,
                                                   bool with_covariance, bool with_filtered) const {
    const WindowTerms terms = MakeTerms(tracks, frames);
    return ComputeSequenceCovariance({std::span(sequence().frames()).first(frames), terms}, with_covariance,
                                     with_filtered);
  }

  EstimatorConfig config_ = test::BatchTestConfig();
  test::BatchRun run_;
  std::vector<WindowTrack> copies_;
  std::vector<WindowTrack*> tracks_;
};

TEST_F(SequenceCovarianceTest, EqualsTheDenseInverseOfCeresNormalEquations) {
  WindowFrame& moved = *sequence().frames()[7];
  moved.nav[5] += 0.01;  // off the minimum, so that there is a gradient and a decrement
  const size_t frames = sequence().frames().size();
  const WindowTerms terms = MakeTerms(tracks_, frames);
  WindowProblem problem(config_.smoother.error, sequence().frames(), tracks_, sequence().calibration());
  for (const std::unique_ptr<WindowTerm>& term : terms) {
    term->AddTo(&problem);
  }
  const DenseSystem dense = EvaluateDense(&problem.blocks(), frames, tracks_.size(), &problem.ceres());
  const VectorXd scale = dense.hessian.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<MatrixXd> factor(scale.asDiagonal() * dense.hessian * scale.asDiagonal());
  const MatrixXd inverse =
      scale.asDiagonal() * factor.solve(MatrixXd::Identity(scale.size(), scale.size())) * scale.asDiagonal();

  const Result<SequenceCovariance> sparse = Compute(tracks_, frames, true, false);
  ASSERT_TRUE(sparse.ok()) << sparse.message();
  const NavState centre = sequence().frames().back()->nav_state();  // of the problem's manifold
  for (size_t i = 0; i < frames; ++i) {
    NavState state = sequence().frames()[i]->nav_state();
    state.p_WB -= centre.p_WB;
    state.v_WB -= centre.v_WB;
    const Matrix15d chart = ImuChartJacobian(config_.smoother.error, state);
    const Index at = 15 * static_cast<Index>(i);
    const Matrix15d expected = chart * inverse.block<15, 15>(at, at) * chart.transpose();
    const Vector15d unit = expected.diagonal().cwiseSqrt().cwiseInverse();
    const Matrix15d error = unit.asDiagonal() * (sparse->smoothed[i] - expected) * unit.asDiagonal();
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-6) << "frame " << i;
  }
  const double decrement =
      dense.gradient.dot(scale.asDiagonal() * factor.solve(scale.asDiagonal() * dense.gradient));
  EXPECT_GT(decrement, 1);
  EXPECT_NEAR(sparse->newton_decrement, decrement, 1e-6 * decrement);
}

// GIVEN the same linearisation, WHEN everything after frame k is cut off, THEN the smoothed covariance of
// what is now the last frame is the filtered one of the whole.
TEST_F(SequenceCovarianceTest, FilteredIsSmoothedWithoutTheFuture) {
  const Result<SequenceCovariance> whole = Compute(tracks_, sequence().frames().size(), false, true);
  ASSERT_TRUE(whole.ok()) << whole.message();
  ASSERT_EQ(whole->filtered.size(), sequence().frames().size());
  for (const size_t k : {3u, 10u, 17u}) {
    std::vector<WindowTrack> cut = copies_;
    std::vector<WindowTrack*> tracks;
    for (WindowTrack& track : cut) {
      std::erase_if(track.views, [&](const WindowView& v) { return v.frame->index > static_cast<int>(k); });
      if (track.views.size() >= 2) {  // a single view adds nothing on the poses
        tracks.push_back(&track);
      }
    }
    const Result<SequenceCovariance> past = Compute(tracks, k + 1, true, false);
    ASSERT_TRUE(past.ok()) << past.message();
    const Vector15d unit = past->smoothed.back().diagonal().cwiseSqrt().cwiseInverse();
    const Matrix15d error =
        unit.asDiagonal() * (whole->filtered[k] - past->smoothed.back()) * unit.asDiagonal();
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-4) << "frame " << k;
  }
}

TEST_F(SequenceCovarianceTest, InformationThatIsNotFiniteIsAStatus) {
  sequence().frames()[3]->nav[4] = std::nan("");
  const Result<SequenceCovariance> result = Compute({}, sequence().frames().size(), true, true);
  EXPECT_EQ(result.code(), StatusCode::kDiverged);
}

TEST_F(SequenceCovarianceTest, TrackBehindTheCameraIsAStatusThatNamesIt) {
  copies_.front().landmark.z() = 1e6;
  const Result<SequenceCovariance> result = Compute(tracks_, sequence().frames().size(), true, true);
  EXPECT_EQ(result.code(), StatusCode::kDiverged);
  EXPECT_NE(result.message().find("track " + std::to_string(copies_.front().id)), std::string::npos);
}

}  // namespace
}  // namespace alidade
