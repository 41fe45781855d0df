#include "smoother/solve/window_term.h"

#include <ceres/crs_matrix.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "smoother/batch/sequence_covariance.h"
#include "smoother/solve/vision_terms.h"
#include "tests/smoother/sliding/gnss_fixture.h"
#include "tests/smoother/solve/given_terms.h"
#include "tests/smoother/window/calibrated_window.h"
#include "tests/support/jacobian_checker.h"

namespace alidade::test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A term as Ceres sees it, with the manifolds of a convention.
class CeresView {
 public:
  CeresView(ErrorConvention convention, const WindowFrames& frames, const WindowCalibration& calibration)
      : convention_(convention),
        frames_(frames),
        blocks_(convention, frames, no_tracks_, calibration),
        problem_(blocks_.MakeProblem()) {}

  void Add(WindowTerm* term) {
    term->AddTo(&blocks_, problem_.get());
    for (const TermPart& part : term->parts()) {
      AddPart(part);
    }
  }

  /// Rows over the tangents of all blocks of the parts, side by side.
  [[nodiscard]] MatrixXd Jacobian(VectorXd* residual) {
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = order_;
    options.apply_loss_function = true;
    std::vector<double> values;
    ceres::CRSMatrix sparse;
    EXPECT_TRUE(problem_->Evaluate(options, nullptr, &values, nullptr, &sparse));
    *residual = Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
    MatrixXd jacobian = MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
    for (int row = 0; row < sparse.num_rows; ++row) {
      for (int i = sparse.rows[static_cast<size_t>(row)]; i < sparse.rows[static_cast<size_t>(row) + 1];
           ++i) {
        jacobian(row, sparse.cols[static_cast<size_t>(i)]) = sparse.values[static_cast<size_t>(i)];
      }
    }
    return jacobian;
  }
  /// Residuals with the blocks moved by `delta`, through the manifolds.
  [[nodiscard]] VectorXd Moved(const VectorXd& delta) {
    std::vector<std::vector<double>> before;
    Index at = 0;
    for (double* block : order_) {
      const int size = problem_->ParameterBlockSize(block);
      const int tangent = problem_->ParameterBlockTangentSize(block);
      before.emplace_back(block, block + size);
      const VectorXd step = delta.segment(at, tangent);
      if (const ceres::Manifold* manifold = problem_->GetManifold(block)) {
        manifold->Plus(before.back().data(), step.data(), block);
      } else {
        Eigen::Map<VectorXd>(block, size) += step;
      }
      at += tangent;
    }
    std::vector<double> values;
    EXPECT_TRUE(problem_->Evaluate({}, nullptr, &values, nullptr, nullptr));
    for (size_t i = 0; i < order_.size(); ++i) {
      std::copy(before[i].begin(), before[i].end(), order_[i]);
    }
    return Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
  }
  /// d canonical coordinates of the parts / d tangents.
  [[nodiscard]] MatrixXd Chart(const std::vector<TermPart>& parts) const {
    MatrixXd chart = MatrixXd::Zero(0, 0);
    for (const TermPart& part : parts) {
      MatrixXd own = MatrixXd::Identity(part.width, part.width);
      if (part.of.kind == Unknown::Kind::kFrame) {
        const NavState state = frames_[static_cast<size_t>(part.of.index)]->nav_state();
        const Index columns = std::max(part.width, kNavColumns);
        own = ImuChartJacobian(convention_, state).topLeftCorner(part.width, columns);
      }
      const Index rows = chart.rows();
      const Index columns = chart.cols();
      chart.conservativeResize(rows + own.rows(), columns + own.cols());
      chart.rightCols(own.cols()).topRows(rows).setZero();
      chart.bottomRows(own.rows()).leftCols(columns).setZero();
      chart.bottomRightCorner(own.rows(), own.cols()) = own;
    }
    return chart;
  }

 private:
  void AddPart(const TermPart& part) {
    switch (part.of.kind) {
      case Unknown::Kind::kFrame:
        order_.push_back(blocks_.Nav(part.of.index));
        if (part.width > kNavColumns) {
          order_.push_back(blocks_.Bias(part.of.index));
        }
        break;
      case Unknown::Kind::kClock:
        order_.push_back(blocks_.Clock(part.of.index));
        break;
      case Unknown::Kind::kCalibration:
        order_.push_back(blocks_.Calibration());
        break;
      case Unknown::Kind::kLandmark:
        FAIL() << "landmarks are compared once they are eliminated";
    }
  }

  ErrorConvention convention_;
  const WindowFrames& frames_;
  const std::vector<WindowTrack*> no_tracks_;
  ParameterBlocks blocks_;
  std::unique_ptr<ceres::Problem> problem_;
  std::vector<double*> order_;
};

/// Moves the states away from where the data put them, so that no residual is zero.
void Disturb(WindowFixture* fixture) {
  for (int i = 0; i < fixture->window.size(); ++i) {
    WindowFrame& frame = fixture->window.frame(i);
    Vector9d shift;
    shift << fixture->random.Vector(0.02), fixture->random.Vector(0.05), fixture->random.Vector(0.05);
    PackNavState(Retract(ErrorConvention::kSo3xRn, frame.nav_state(), shift), frame.nav.data());
  }
}

void ExpectRowsOfCeres(const WindowTerms& terms, const WindowFrames& frames,
                       const WindowCalibration& calibration, double step, double tolerance) {
  for (size_t i = 0; i < terms.size(); ++i) {
    LinearTerm linear;
    ASSERT_TRUE(terms[i]->Linearize(&linear).ok());
    EXPECT_EQ(linear.residual.size(), terms[i]->rows());
    for (const ErrorConvention convention : kAllConventions) {
      CeresView ceres_view(convention, frames, calibration);
      ceres_view.Add(terms[i].get());
      VectorXd residual;
      const MatrixXd jacobian = ceres_view.Jacobian(&residual);
      EXPECT_LT((residual - linear.residual).norm(), 1e-12 * (1 + residual.norm())) << "term " << i;
      const MatrixXd expected = linear.jacobian * ceres_view.Chart(linear.parts);
      EXPECT_EQ(CompareJacobians(jacobian, expected, 1e-11), "") << "term " << i;
      const auto moved = [&](const VectorXd& delta) { return ceres_view.Moved(delta); };
      EXPECT_EQ(CompareJacobians(jacobian, NumericJacobian(moved, static_cast<int>(jacobian.cols()), step),
                                 tolerance),
                "")
          << "term " << i << ", " << ToString(convention);
    }
  }
}

/// Normal equations of a term over the manifolds' tangents.
void ExpectInformationOfCeres(WindowTerm* term, const WindowFrames& frames,
                              const WindowCalibration& calibration, double tolerance) {
  LinearTerm linear;
  ASSERT_TRUE(term->Linearize(&linear).ok());
  for (const ErrorConvention convention : kAllConventions) {
    CeresView ceres_view(convention, frames, calibration);
    ceres_view.Add(term);
    VectorXd residual;
    const MatrixXd jacobian = ceres_view.Jacobian(&residual);
    const MatrixXd chart = ceres_view.Chart(linear.parts);
    const MatrixXd full = linear.hessian.selfadjointView<Eigen::Lower>();
    const MatrixXd expected = chart.transpose() * full * chart;
    EXPECT_LT((jacobian.transpose() * jacobian - expected).norm(), tolerance * expected.norm());
    const VectorXd slope = chart.transpose() * linear.gradient;
    EXPECT_LT((jacobian.transpose() * residual - slope).norm(), tolerance * (1 + slope.norm()));
  }
}

Matrix15d SomeCovariance() {
  Vector15d deviations;
  deviations << Eigen::Vector3d::Constant(0.02), Eigen::Vector3d::Constant(0.1),
      Eigen::Vector3d::Constant(0.2), Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.05);
  return deviations.cwiseAbs2().asDiagonal();
}

// GIVEN a window of every sensor, THEN the rows of each term are those that Ceres has of it, and both are the
// derivatives of its residual, in every error convention.
TEST(WindowTermTest, RowsOfTheSensorsAreThoseOfCeresAndNumeric) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    GnssFixture fixture(seed);
    fixture.window.frame(1).rest =
        MakeRestMeasurement({true, true}, fixture.random.Vector(0.1), VisionConfig());
    for (int i = 1; i <= 2; ++i) {  // at the frame, and after it
      WindowFrame& frame = fixture.window.frame(i);
      FrameFix& fix = frame.fixes.emplace_back();
      const PositionFix measured{0, 0, fixture.random.Vector(2), 0.04 * Eigen::Matrix3d::Identity()};
      fix.measurement = *MakeFixMeasurement(FixConfig(), fixture.random.Vector(0.5), measured);
      fix.Set(i == 1 ? std::vector<ImuSample>() : frame.epochs[0].imu, frame.imu_bias(), fixture.noise);
    }
    Disturb(&fixture);
    WindowTerms terms;
    ASSERT_TRUE(AddSensorTerms({fixture.gravity_W}, fixture.window.frames(), 4, &terms).ok());
    ASSERT_EQ(terms.size(), 3u + 1u + 2u);
    ExpectRowsOfCeres(terms, fixture.window.frames(), fixture.calibration, 1e-4, 1e-6);
    WindowTerms all;
    ASSERT_TRUE(AddSensorTerms({fixture.gravity_W, &fixture.context}, fixture.window.frames(), 4, &all).ok());
    ASSERT_EQ(all.size(), 6u + 4u + 3u);
    all.erase(all.begin(), all.begin() + 6);
    fixture.context.config.robust_kernel = RobustKernel::kNone;  // its kink is no derivative
    // Ranges of 2e7 m lose digits in differences.
    ExpectRowsOfCeres(all, fixture.window.frames(), fixture.calibration, 1e-2, 1e-4);
  }
}

TEST(WindowTermTest, RowsOfAPriorWithClockAndCalibrationAreThoseOfCeresAndNumeric) {
  for (const ErrorConvention made_in : kAllConventions) {
    GnssFixture fixture(4);
    const CalibrationEstimate estimate = CalibrateWindow(&fixture);
    fixture.calibration = {estimate.layout, estimate.mean};
    LinearPrior prior;
    ASSERT_TRUE(MakeInitialPrior(made_in, fixture.window.frame(0), SomeCovariance(), &prior));
    GnssWindow gnss(fixture.context.config, {}, fixture.gravity_W);
    GnssAlignment alignment;
    alignment.enu = fixture.context.mount.enu;
    alignment.clock = Vector6d::Zero();
    gnss.Align(alignment, &fixture.window.frame(0), &prior);
    AddCalibrationPrior(estimate, &prior);
    const SensorContext sensors{fixture.gravity_W, &fixture.context};
    prior = Marginalize(fixture.window, prior, PoseSystem(4, &fixture.calibration), sensors);
    fixture.window.RemoveOldest();
    Disturb(&fixture);
    WindowTerms terms;
    terms.push_back(MakePriorTerm(prior, fixture.calibration));
    ASSERT_EQ(terms.front()->parts().size(), 3u + 1u + 1u);
    ExpectRowsOfCeres(terms, fixture.window.frames(), fixture.calibration, 1e-4, 1e-6);
  }
}

TEST(WindowTermTest, InformationOfPoseOnlyTracksIsThatOfCeres) {
  for (const bool calibrated : {false, true}) {
    WindowFixture fixture(5, 4, 12, 1.0);
    if (calibrated) {
      const CalibrationEstimate estimate = CalibrateWindow(&fixture);
      fixture.calibration = {estimate.layout, estimate.mean};
    }
    const std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.calibration.mean);
    for (auto& [id, track] : fixture.window.tracks()) {  // the factor solves for them
      ASSERT_TRUE(SolveLandmark(track.views, geometry, {}, 30, &track.landmark));
    }
    PoseOnlyTerm term(fixture.window, fixture.tracks(), fixture.calibration, {});
    ExpectInformationOfCeres(&term, fixture.window.frames(), fixture.calibration, 1e-7);
    EXPECT_EQ(term.used().size(), fixture.tracks().size());
  }
}

/// J^T J with the last `landmarks` columns eliminated.
MatrixXd Reduced(const MatrixXd& jacobian, Index landmarks) {
  const MatrixXd hessian = jacobian.transpose() * jacobian;
  const Index kept = hessian.rows() - landmarks;
  const MatrixXd coupling = hessian.topRightCorner(kept, landmarks);
  return hessian.topLeftCorner(kept, kept) -
         coupling * hessian.bottomRightCorner(landmarks, landmarks).inverse() * coupling.transpose();
}

// The landmark's coordinates move with the base frame in Ceres and stand still in the rows: once it is
// eliminated both say the same of the poses.
TEST(WindowTermTest, ViewsSayOfThePosesWhatTheyDoInCeres) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    WindowFixture fixture(seed, 4, 8);
    WindowTrack& track = fixture.window.tracks().begin()->second;
    track.depth_prior = {track.landmark.z(), 30};  // no residual, so that the chart does not matter
    WindowTerms terms;
    AddTrackTerms(fixture.window.frames(), {&track}, fixture.calibration, {}, &terms);
    ASSERT_EQ(terms.size(), track.views.size() + 1);
    ColumnMap columns;
    for (int i = 0; i < 4; ++i) {
      columns.AddPose(i);
    }
    columns.AddLandmark(0);
    MatrixXd hessian = MatrixXd::Zero(columns.size(), columns.size());
    VectorXd gradient = VectorXd::Zero(columns.size());
    const std::vector<WindowTrack*> tracks = {&track};
    ParameterBlocks blocks(ErrorConvention::kSo3xRn, fixture.window.frames(), tracks, fixture.calibration);
    const std::unique_ptr<ceres::Problem> problem = blocks.MakeProblem();
    for (const std::unique_ptr<WindowTerm>& term : terms) {
      LinearTerm linear;
      ASSERT_TRUE(term->Linearize(&linear).ok());
      linear.AddTo(columns, &hessian, &gradient);
      term->AddTo(&blocks, problem.get());
    }
    ceres::Problem::EvaluateOptions options;
    for (int i = 0; i < 4; ++i) {
      options.parameter_blocks.push_back(blocks.Nav(i));
    }
    options.parameter_blocks.push_back(blocks.Landmark(0));
    ceres::CRSMatrix sparse;
    ASSERT_TRUE(problem->Evaluate(options, nullptr, nullptr, nullptr, &sparse));
    MatrixXd jacobian = MatrixXd::Zero(sparse.num_rows, columns.size());
    for (int row = 0; row < sparse.num_rows; ++row) {
      for (int i = sparse.rows[static_cast<size_t>(row)]; i < sparse.rows[static_cast<size_t>(row) + 1];
           ++i) {
        const int column = sparse.cols[static_cast<size_t>(i)];  // of 9 a frame, the velocity's are zero
        if (column >= 36 || column % 9 < 6) {
          jacobian(row, column >= 36 ? column - 12 : 6 * (column / 9) + column % 9) =
              sparse.values[static_cast<size_t>(i)];
        }
      }
    }
    const MatrixXd full = hessian.selfadjointView<Eigen::Lower>();
    const MatrixXd coupling = full.topRightCorner(24, 3);
    const MatrixXd reduced = full.topLeftCorner(24, 24) -
                             coupling * full.bottomRightCorner<3, 3>().inverse() * coupling.transpose();
    EXPECT_LT((reduced - Reduced(jacobian, 3)).norm(), 1e-8 * reduced.norm()) << "seed " << seed;
  }
}

// GIVEN frames with clocks and epochs, THEN the batch's fronts know of the last of them what the window does.
TEST(WindowTermTest, TheBatchTakesGnssTermsAsTheWindowDoes) {
  GnssFixture fixture(6);
  LinearPrior prior;
  ASSERT_TRUE(
      MakeInitialPrior(ErrorConvention::kRightInvariant, fixture.window.frame(0), SomeCovariance(), &prior));
  GnssWindow gnss(fixture.context.config, {}, fixture.gravity_W);
  GnssAlignment alignment;
  alignment.enu = fixture.context.mount.enu;
  alignment.clock = Vector6d::Zero();
  gnss.Align(alignment, &fixture.window.frame(0), &prior);
  std::vector<WindowTrack*> tracks;
  for (auto& [id, track] : fixture.window.tracks()) {
    tracks.push_back(&track);
  }
  WindowTerms terms;
  terms.push_back(MakePriorTerm(prior, fixture.calibration));
  ASSERT_TRUE(AddSensorTerms({fixture.gravity_W, &fixture.context}, fixture.window.frames(), 4, &terms).ok());
  const size_t without_vision = terms.size();
  AddTrackTerms(fixture.window.frames(), tracks, fixture.calibration, {}, &terms);
  const Result<SequenceCovariance> batch =
      ComputeSequenceCovariance({fixture.window.frames(), terms}, true, true);
  ASSERT_TRUE(batch.ok()) << batch.message();
  terms.resize(without_vision);
  terms.push_back(std::make_unique<PoseOnlyTerm>(fixture.window, fixture.tracks(), fixture.calibration,
                                                 ObservationKernel{}));
  NewestEstimate newest;
  ASSERT_TRUE(NewestCovariance(fixture.window.frames(), terms, &newest));
  EXPECT_TRUE(batch->smoothed.back().isApprox(newest.covariance, 1e-6));
  EXPECT_TRUE(batch->filtered.back().isApprox(newest.covariance, 1e-6));
}

}  // namespace
}  // namespace alidade::test
