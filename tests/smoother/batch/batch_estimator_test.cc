#include "smoother/batch/batch_estimator.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "tests/smoother/batch/batch_fixture.h"
#include "tests/support/estimate_difference.h"
#include "tests/support/fix_scenario.h"

namespace alidade {
namespace {

using test::BatchRun;
using test::BatchTestConfig;
using test::MakeBatchDataset;
using test::RunBatch;

double RmsePosition(const Dataset& dataset, const std::vector<FinalizedFrame>& frames) {
  double squares = 0;
  for (const FinalizedFrame& frame : frames) {
    squares += test::ErrorOf(dataset, frame.estimate).segment<3>(3).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(frames.size()));
}

TEST(BatchEstimatorTest, ExactDataGivesTheTruthInEveryFrame) {
  const Dataset dataset = MakeBatchDataset({.exact = true});
  const BatchRun run = RunBatch(dataset, BatchTestConfig(), 0);
  ASSERT_TRUE(run.frames.ok()) << run.frames.message();
  ASSERT_EQ(run.frames->size(), dataset.frames.size());
  for (const FinalizedFrame& frame : *run.frames) {
    const Vector15d error = test::ErrorOf(dataset, frame.estimate);
    // What is left is the midpoint rule's at 400 Hz.
    EXPECT_LT(error.head<9>().norm(), 1e-4) << FormatSeconds(frame.estimate.stamp_ns);
  }
}

// GIVEN a window so long that nothing is ever marginalised, WHEN it has seen everything, THEN its newest
// state and covariance are those of the batch.
TEST(BatchEstimatorTest, EqualsASmootherWhoseWindowHoldsTheWholeSequence) {
  const Dataset dataset = MakeBatchDataset({});
  const EstimatorConfig whole = test::WholeWindowConfig();
  const std::unique_ptr<Estimator> smoother = MakeSmoother(whole, dataset.rig);
  const test::ScenarioResult window =
      test::RunScenario(dataset, test::DrawInitialState(dataset, 1), smoother.get());
  ASSERT_TRUE(window.status.ok()) << window.status.message();

  EstimatorConfig config = BatchTestConfig();
  config.batch.gate_probability = 1;
  const BatchRun run = RunBatch(dataset, config, 1);
  ASSERT_TRUE(run.frames.ok()) << run.frames.message();
  const NavEstimate& last = run.frames->back().estimate;
  ASSERT_EQ(last.stamp_ns, window.last.stamp_ns);
  Vector15d difference;
  difference << Local(ErrorConvention::kSo3xRn, last.nav, window.last.nav),
      window.last.bias.gyro - last.bias.gyro, window.last.bias.accel - last.bias.accel;
  const Vector15d sigma = last.covariance.diagonal().cwiseSqrt();
  // The window's solver stops when a step changes the cost by less than 1e-6: 0.07 sigma from the minimum.
  EXPECT_LT(difference.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 0.1);
  EXPECT_LT((window.last.covariance - last.covariance).norm(), 0.01 * last.covariance.norm());
}

// GIVEN a world whose origin is kilometres away THEN every state and covariance is that near the origin.
TEST(BatchEstimatorTest, TheOriginDoesNotMatter) {
  const Eigen::Vector3d shift(4000, -3000, 200);
  const Dataset near = MakeBatchDataset({});
  Dataset far = near;
  for (TrajectoryPoint& point : far.truth->points) {
    point.nav.p_WB += shift;
  }
  const BatchRun at_origin = RunBatch(near, BatchTestConfig(), 1);
  const BatchRun away = RunBatch(far, BatchTestConfig(), 1);
  ASSERT_TRUE(at_origin.frames.ok() && away.frames.ok());
  ASSERT_EQ(away.frames->size(), at_origin.frames->size());
  for (size_t i = 0; i < away.frames->size(); ++i) {
    const NavEstimate& expected = at_origin.frames->at(i).estimate;
    NavEstimate estimate = away.frames->at(i).estimate;
    estimate.nav.p_WB -= shift;
    const Vector9d difference = Local(ErrorConvention::kSo3xRn, expected.nav, estimate.nav);
    EXPECT_LT(difference.norm(), 1e-6) << i;
    EXPECT_LT((estimate.covariance - expected.covariance).norm(), 1e-5 * expected.covariance.norm()) << i;
  }
}

// The band of the mean NEES of all 15 components over independent runs: chi-square, 99.9 %.
TEST(BatchEstimatorTest, CovarianceIsThatOfTheErrors) {
  constexpr int kRuns = 10;
  double first = 0, middle = 0, last = 0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Dataset dataset = MakeBatchDataset({.seed = seed});
    const BatchRun run = RunBatch(dataset, BatchTestConfig(), 1, seed);
    ASSERT_TRUE(run.frames.ok()) << run.frames.message();
    const auto nees = [&](size_t index) {
      const NavEstimate& estimate = (*run.frames)[index].estimate;
      const Vector15d error = test::ErrorOf(dataset, estimate);
      return error.dot(estimate.covariance.llt().solve(error)) / kRuns;
    };
    first += nees(0);
    middle += nees(run.frames->size() / 2);
    last += nees(run.frames->size() - 1);
  }
  const double low = ChiSquareQuantile(15 * kRuns, 0.0005) / kRuns;
  const double high = ChiSquareQuantile(15 * kRuns, 0.9995) / kRuns;
  for (const double nees : {first, middle, last}) {
    EXPECT_GT(nees, low);
    EXPECT_LT(nees, high);
  }
}

TEST(BatchEstimatorTest, LaterDataMakesEveryStateBetterKnownAndTheLastOneEquallyWell) {
  const Dataset dataset = MakeBatchDataset({});
  const BatchRun run = RunBatch(dataset, BatchTestConfig(), 1);
  ASSERT_TRUE(run.frames.ok()) << run.frames.message();
  for (const FinalizedFrame& frame : *run.frames) {
    ASSERT_TRUE(frame.filtering_covariance.has_value());
    const Matrix15d gained = *frame.filtering_covariance - frame.estimate.covariance;
    const Vector15d scale = frame.filtering_covariance->diagonal().cwiseSqrt().cwiseInverse();
    const Matrix15d scaled = scale.asDiagonal() * gained * scale.asDiagonal();
    EXPECT_GT(scaled.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-6);
  }
  const FinalizedFrame& last = run.frames->back();
  EXPECT_LT((*last.filtering_covariance - last.estimate.covariance).norm(),
            1e-6 * last.estimate.covariance.norm());
  const FinalizedFrame& first = run.frames->front();
  EXPECT_LT(first.estimate.covariance(6, 6), 0.6 * (*first.filtering_covariance)(6, 6))
      << "the first velocity has only the prior, until one looks back";
}

TEST(BatchEstimatorTest, EqualInputGivesEqualBits) {
  const Dataset dataset = MakeBatchDataset({.duration_s = 2});
  const BatchRun first = RunBatch(dataset, BatchTestConfig(), 1);
  const std::vector<double> fragment_the_heap(12345, 1.0);
  const BatchRun second = RunBatch(dataset, BatchTestConfig(), 1);
  ASSERT_TRUE(first.frames.ok() && second.frames.ok());
  ASSERT_EQ(first.frames->size(), second.frames->size());
  for (size_t i = 0; i < first.frames->size(); ++i) {
    const FinalizedFrame& a = (*first.frames)[i];
    const FinalizedFrame& b = (*second.frames)[i];
    EXPECT_TRUE(test::EqualBits(a.estimate, b.estimate));
    EXPECT_TRUE(test::EqualBits(*a.filtering_covariance, *b.filtering_covariance));
  }
}

TEST(BatchEstimatorTest, OutliersAreGatedAndDoNotBias) {
  const Dataset clean = MakeBatchDataset({.duration_s = 6});
  const BatchRun reference = RunBatch(clean, BatchTestConfig(), 1);
  ASSERT_TRUE(reference.frames.ok()) << reference.frames.message();
  int gated_clean = 0, used = 0;
  for (const FinalizedFrame& frame : *reference.frames) {
    gated_clean += frame.statistics.features_gated;
    used += frame.statistics.features_used;
  }
  EXPECT_LT(gated_clean, 0.002 * used);
  for (const SimOutlierKind kind : {SimOutlierKind::kJump, SimOutlierKind::kDrift}) {
    const Dataset dataset = MakeBatchDataset({.duration_s = 6, .outlier_rate = 0.1, .outlier_kind = kind});
    const BatchRun run = RunBatch(dataset, BatchTestConfig(), 1);
    ASSERT_TRUE(run.frames.ok()) << run.frames.message();
    int gated = 0;
    for (const FinalizedFrame& frame : *run.frames) {
      gated += frame.statistics.features_gated;
    }
    EXPECT_GT(gated, 0.05 * used);
    EXPECT_LT(RmsePosition(dataset, *run.frames), 1.5 * RmsePosition(clean, *reference.frames));
  }
}

TEST(BatchEstimatorTest, ReportsHowFarFromTheMinimumItWasLeft) {
  const Dataset dataset = MakeBatchDataset({.duration_s = 2});
  EstimatorConfig config = BatchTestConfig();
  config.batch.max_iterations = 1;
  config.batch.tolerance_sigma = 1e-8;
  const BatchRun run = RunBatch(dataset, config, 1);
  EXPECT_EQ(run.frames.code(), StatusCode::kDiverged);
  EXPECT_NE(run.frames.message().find("sigma from the minimum"), std::string::npos) << run.frames.message();
}

TEST(BatchEstimatorTest, StopsWhenAsked) {
  const Dataset dataset = MakeBatchDataset({.duration_s = 2});
  const std::atomic<bool> stop{true};
  const BatchRun run = RunBatch(dataset, BatchTestConfig(), 1, 1, &stop);
  ASSERT_TRUE(run.frames.ok());
  EXPECT_TRUE(run.frames->empty());
}

TEST(BatchEstimatorTest, BadInputIsAStatus) {
  const Dataset dataset = MakeBatchDataset({.duration_s = 2});
  const EstimatorConfig config = BatchTestConfig();
  BatchEstimator estimator(config, dataset.rig, MakeSmoother(config, dataset.rig));
  EXPECT_EQ(estimator.AddFrame(dataset.frames.front()).code(), StatusCode::kDiverged);
  NavEstimate bad = test::DrawInitialState(dataset, 1, 0);
  bad.nav.p_WB.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(estimator.Initialize(bad).code(), StatusCode::kInput);
  ASSERT_TRUE(estimator.Initialize(test::DrawInitialState(dataset, 1, 0)).ok());
  ImuSample sample = dataset.imu.front();
  sample.gyro.x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(estimator.AddImu(sample).code(), StatusCode::kInput);
  EXPECT_EQ(estimator.AddFrame(dataset.frames[1]).code(), StatusCode::kInput) << "no IMU reaches the frame";
  const Result<std::vector<FinalizedFrame>> nothing = estimator.TakeFinalized(nullptr);
  ASSERT_TRUE(nothing.ok()) << nothing.message();
  EXPECT_TRUE(nothing->empty());
}

// GIVEN fixes between frames, a tenth of them wrong, WHEN the batch has solved, THEN it refuses the wrong
// ones, its covariance is that of the errors, and the position is known better than by the fixes alone.
TEST(BatchEstimatorTest, RefusesWrongFixesAndIsConsistent) {
  SimulatorConfig scene = test::FixScene();
  scene.duration_s = 20;
  scene.path_m = 60;
  scene.fix.wrong_rate = 0.1;
  constexpr int kRuns = 3;
  double nees = 0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Dataset dataset = test::SimulateOrDie(scene, seed);
    BatchEstimator batch(BatchTestConfig(), dataset.rig, MakeSmoother(BatchTestConfig(), dataset.rig));
    test::RunWithFixes(dataset, test::DrawInitialState(dataset, seed), &batch, [](const PositionFix&) {});
    const Result<std::vector<FinalizedFrame>> frames = batch.TakeFinalized(nullptr);
    ASSERT_TRUE(frames.ok()) << frames.message();
    int wrong = 0;
    int refused = 0;
    for (const BatchMeasurement& fix : batch.sequence().measurements()) {
      const TrajectoryPoint& truth =
          test::TruthAt(dataset, batch.sequence().frames()[static_cast<size_t>(fix.frame)]->stamp_ns);
      const bool is_wrong =
          (std::get<FixMeasurement>(fix.attached.measurement).model.p_WA - truth.nav.p_WB).norm() > 5;
      wrong += is_wrong ? 1 : 0;
      refused += fix.weight > 0 ? 0 : 1;
      EXPECT_FALSE(is_wrong && fix.weight > 0);
    }
    EXPECT_GE(wrong, 2);
    EXPECT_LE(refused, wrong + 1) << "a thousandth of the right ones";
    EXPECT_LT(RmsePosition(dataset, *frames), scene.fix.std_m);
    const NavEstimate& middle = (*frames)[frames->size() / 2].estimate;
    const Vector15d error = test::ErrorOf(dataset, middle);
    nees += error.dot(middle.covariance.llt().solve(error));
  }
  EXPECT_GT(nees, ChiSquareQuantile(15 * kRuns, 0.001));
  EXPECT_LT(nees, ChiSquareQuantile(15 * kRuns, 0.999));
}

}  // namespace
}  // namespace alidade
