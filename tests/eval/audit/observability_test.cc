#include "eval/audit/observability.h"

#include <gtest/gtest.h>

#include "eval/record/run_options.h"
#include "eval/record/runner.h"
#include "filter/feature_update.h"
#include "filter/filter.h"
#include "filter/filter_state.h"
#include "tests/support/random_states.h"
#include "tests/support/scenario.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using test::RandomStates;

constexpr int kClones = 6;
constexpr ErrorConvention kConventions[] = {ErrorConvention::kRightInvariant, ErrorConvention::kLeftInvariant,
                                            ErrorConvention::kSo3xRn};

/// The paper's eq. 4-9 over [core | clones], written out: yaw in every attitude block, equal shifts in every
/// position block.
MatrixXd PaperNullSpace(int dimension) {
  MatrixXd null_space = MatrixXd::Zero(dimension, 4);
  for (int first = 0; first < dimension; first += first == 0 ? 15 : 6) {
    null_space(first + 2, 0) = 1;
    null_space.block<3, 3>(first + 3, 1).setIdentity();
  }
  return null_space;
}

struct Walk {
  ObservabilityAudit audit;
  double worst_row = 0;  ///< |H N| / |H| over all updates, N of the paper
};

/// Bearings of a landmark in front of the newest clone, as seen from all of them.
Track RandomTrack(const FilterState& state, RandomStates* random) {
  constexpr double kSigma = 2e-3;
  const Vector3d direction(random->Uniform(-1, 1), random->Uniform(-1, 1), 8);
  const Vector3d point = state.clones().back().T_WC * direction;
  Track track;
  for (const Clone& clone : state.clones()) {
    const Vector3d p = clone.T_WC.Inverse() * point;
    NormalizedObservation observation;
    observation.z = p.head<2>() / p.z() + random->Vector(kSigma).head<2>();
    observation.sqrt_information = Eigen::Matrix2d::Identity() / kSigma;
    track.views.push_back({clone.serial, observation});
  }
  return track;
}

std::vector<ImuSample> RandomInterval(const FilterState& state, RandomStates* random) {
  std::vector<ImuSample> samples;
  const Vector3d gyro = random->Vector(1);
  const Vector3d accel = state.nav().R_WB.transpose() * Vector3d(0, 0, 9.81) + random->Vector(3);
  for (int i = 0; i <= 10; ++i) {
    samples.push_back({state.stamp_ns() + i * 10'000'000, gyro, accel});
  }
  return samples;
}

/// A filter state on a random walk that sees random landmarks; every operation goes to the audit. After each
/// update all states are moved at random by up to `correction`, so that no two updates share a linearisation
/// point.
Walk AuditRandomWalk(ErrorConvention convention, unsigned seed, double correction) {
  RandomStates random(seed);
  const Pose T_BC = random.RandomPose(0.2);
  Walk walk;
  FilterState state(convention, false, T_BC, {kClones + 1, 0});
  state.SetObserver(&walk.audit);
  NavEstimate start;
  start.nav = random.Nav(20);
  start.bias = random.Bias();
  start.covariance.setIdentity();
  EXPECT_TRUE(state.Reset(start).ok());
  VisionConfig vision;
  vision.max_relative_depth_deviation = 10;
  FeatureUpdate update(FilterConfig(), vision, kClones + 1);
  for (int frame = 1; frame <= 20; ++frame) {
    EXPECT_TRUE(state.Propagate(RandomInterval(state, &random), ImuNoise(), Vector3d(0, 0, -9.81)).ok());
    state.AddClone(frame);
    update.Begin(state);
    for (int i = 0; i < 8; ++i) {
      update.Append(state, RandomTrack(state, &random));
    }
    if (update.rows() > 0) {
      const MatrixXd h = update.jacobian();
      walk.worst_row =
          std::max(walk.worst_row, (h * PaperNullSpace(static_cast<int>(h.cols()))).norm() / h.norm());
      walk.audit.OnUpdate(state, {h, update.innovation(), {}});
      Eigen::VectorXd delta(state.covariance().dimension());
      for (Eigen::Index k = 0; k < delta.size(); ++k) {
        delta[k] = random.Uniform(-correction, correction);
      }
      state.Correct(delta);
    }
    if (state.clones().size() > kClones) {
      state.RemoveClone(static_cast<size_t>(random.Uniform(0, kClones)));
    }
    walk.audit.OnFrame(state);
  }
  return walk;
}

/// |R N| of each direction over what it would be if nothing cancelled.
Eigen::Vector4d RelativeLeak(const ObservabilityAudit& audit,
                             const Eigen::Matrix<double, 15, 4>& directions) {
  const Matrix15d factor = audit.Factor();
  return (factor * directions).colwise().norm().transpose() / factor.norm();
}

TEST(ObservabilityTest, RightInvariantErrorsKeepThePapersNullSpaceWhateverTheState) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Walk walk = AuditRandomWalk(ErrorConvention::kRightInvariant, seed, 0.02);
    EXPECT_LT(walk.worst_row, 1e-8);
    EXPECT_LT(RelativeLeak(walk.audit, PaperNullSpace(15)).maxCoeff(), 1e-8) << "seed " << seed;
    EXPECT_EQ(walk.audit.records().back().rank, 11);
    EXPECT_LT(walk.audit.records().back().null_angle_rad, 1e-8);
  }
}

TEST(ObservabilityTest, EveryConventionKeepsItsOwnNullSpaceAtAFixedLinearisationPoint) {
  for (const ErrorConvention convention : kConventions) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const ObservabilityAudit audit = AuditRandomWalk(convention, seed, 0).audit;
      EXPECT_LT(RelativeLeak(audit, audit.theory()).maxCoeff(), 1e-8) << ToString(convention) << seed;
      EXPECT_EQ(audit.records().back().rank, 11);
      EXPECT_LT(audit.records().back().null_angle_rad, 1e-8);
    }
  }
}

TEST(ObservabilityTest, MovingLinearisationPointsLoseYawInSo3xRnAndMoreInLeftInvariantErrors) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const ObservabilityAudit so3xrn = AuditRandomWalk(ErrorConvention::kSo3xRn, seed, 0.02).audit;
    const Eigen::Vector4d leak = RelativeLeak(so3xrn, so3xrn.theory());
    EXPECT_EQ(so3xrn.records().back().rank, 12);
    EXPECT_GT(leak[0], 1e-6);
    EXPECT_LT(leak.tail<3>().maxCoeff(), 1e-8) << "positions stay unobservable";
    EXPECT_GT(so3xrn.records().back().yaw_gain, 1);
    const ObservabilityAudit left = AuditRandomWalk(ErrorConvention::kLeftInvariant, seed, 0.02).audit;
    EXPECT_EQ(left.records().back().rank, 15);
  }
}

TEST(ObservabilityTest, ALandmarkOfTheStateAddsTheInformationOfItsEliminatedRows) {
  RandomStates random(5);
  FilterState state(ErrorConvention::kRightInvariant, false, random.RandomPose(0.2), {4, 0});
  ObservabilityAudit in_state;
  ObservabilityAudit eliminated;
  NavEstimate start;
  start.nav = random.Nav(5);
  start.covariance.setIdentity();
  ASSERT_TRUE(state.Reset(start).ok());
  const MatrixXd first = MatrixXd::NullaryExpr(3, 24, [&] { return random.Uniform(-1, 1); });
  const MatrixXd second = MatrixXd::NullaryExpr(7, 30, [&] { return random.Uniform(-1, 1); });
  for (ObservabilityAudit* audit : {&in_state, &eliminated}) {
    audit->OnReset(state);
    audit->OnClone(0, 6);
  }
  // Error: [core | clone | landmark], then a second clone enters and the first leaves.
  in_state.OnAddLandmark(21, first);
  in_state.OnClone(0, 6);
  in_state.OnUpdate(state, {second, Eigen::VectorXd::Zero(7), {}});
  in_state.OnRemove(21, 6);
  in_state.OnRemove(21, 3);
  // The same ten rows with the landmark's three columns projected out.
  eliminated.OnClone(0, 6);
  MatrixXd rows = MatrixXd::Zero(10, 30);
  rows.topRows(3).leftCols(15) = first.leftCols(15);
  rows.topRows(3).rightCols(9) = first.rightCols(9);
  rows.bottomRows(7) = second;
  const MatrixXd landmark = rows.rightCols(3);
  const MatrixXd projector = MatrixXd::Identity(10, 10) -
                             landmark * (landmark.transpose() * landmark).inverse() * landmark.transpose();
  eliminated.OnUpdate(state, {projector * rows.leftCols(27), Eigen::VectorXd::Zero(10), {}});
  const Matrix15d a = in_state.Factor().transpose() * in_state.Factor();
  const Matrix15d b = eliminated.Factor().transpose() * eliminated.Factor();
  EXPECT_LT((a - b).norm(), 1e-12 * b.norm());
}

TEST(ObservabilityTest, WhatATrackMemoryRetainsHoldsNoInformationOnYawOrPosition) {
  SimulatorConfig sim;
  sim.duration_s = 10;
  sim.path_m = 13;
  const Dataset dataset = test::SimulateOrDie(sim, 3);
  EstimatorConfig config;
  config.filter.window = 10;
  config.filter.track_memory = TrackMemoryPolicy::kCarry;
  ObservabilityAudit audit;
  const std::unique_ptr<Estimator> filter = MakeFilter(config, dataset.rig, &audit);
  const NavEstimate initial = test::DrawInitialState(dataset, 3);
  ASSERT_TRUE(test::RunScenario(dataset, initial, filter.get()).status.ok());
  EXPECT_EQ(audit.records().back().rank, 11);
}

struct AuditedCase {
  const char* name;
  ErrorConvention error;
  bool first_estimates;
  int slam_features;
  int rank;
};

class AuditedFilter : public ::testing::TestWithParam<AuditedCase> {};
INSTANTIATE_TEST_SUITE_P(
    Conventions, AuditedFilter,
    ::testing::Values(AuditedCase{"right_invariant", ErrorConvention::kRightInvariant, false, 0, 11},
                      AuditedCase{"right_invariant_slam", ErrorConvention::kRightInvariant, false, 15, 11},
                      AuditedCase{"left_invariant", ErrorConvention::kLeftInvariant, false, 0, 15},
                      AuditedCase{"so3xrn", ErrorConvention::kSo3xRn, false, 0, 12},
                      AuditedCase{"so3xrn_slam", ErrorConvention::kSo3xRn, false, 15, 12},
                      AuditedCase{"so3xrn_first_estimates", ErrorConvention::kSo3xRn, true, 0, 11},
                      AuditedCase{"so3xrn_first_estimates_slam", ErrorConvention::kSo3xRn, true, 15, 11}),
    [](const auto& test_case) { return std::string(test_case.param.name); });

TEST_P(AuditedFilter, HasTheRankOfItsErrorOnASimulatedRun) {
  const int rank = GetParam().rank;
  SimulatorConfig sim;
  sim.duration_s = 10;
  sim.path_m = 13;
  const Dataset dataset = test::SimulateOrDie(sim, 3);
  EstimatorConfig config;
  config.filter.error = GetParam().error;
  config.filter.first_estimates = GetParam().first_estimates;
  config.filter.slam_features = GetParam().slam_features;
  for (const FilterLandmark landmark : {FilterLandmark::kPoseOnlyMulti, FilterLandmark::kMsckf}) {
    config.filter.landmark = landmark;
    ObservabilityAudit audit;
    const std::unique_ptr<Estimator> filter = MakeFilter(config, dataset.rig, &audit);
    const test::ScenarioResult result =
        test::RunScenario(dataset, test::DrawInitialState(dataset, 3), filter.get());
    ASSERT_TRUE(result.status.ok()) << result.status.message();
    ASSERT_EQ(audit.records().size(), static_cast<size_t>(result.frames));
    EXPECT_EQ(audit.records().back().rank, rank);
    const Vector15d values = audit.RelativeSingularValues();
    EXPECT_GT(values[rank - 1], 1e3 * kObservabilityTolerance) << "the rank does not hang on the tolerance";
    if (rank < 15) {
      EXPECT_LT(values[rank], 1e-3 * kObservabilityTolerance);
    }
  }
}

// GIVEN raw GNSS, WHEN it is audited, THEN eleven directions are observable until the state is turned into
// ENU, and then all fifteen: yaw and position with them, as a system of more than cameras has it.
TEST(ObservabilityTest, GnssMakesYawAndPositionObservable) {
  SimulatorConfig sim;
  sim.start_time_s = 1'700'000'000;
  sim.duration_s = 8;
  sim.path_m = 16;
  sim.gnss.rate_hz = 5;
  const Dataset dataset = test::SimulateOrDie(sim, 3);
  const MeasurementLog log{dataset.rig, dataset.imu, dataset.frames, {}, dataset.gnss};
  EstimatorConfig config;
  config.init.method = InitMethod::kTruth;
  config.gnss.enabled = true;
  config.gnss.corrections.model_std_scale = 0;
  RunOptions options;
  options.truth = &*dataset.truth;
  options.seed = 3;
  options.audit = true;
  const RunResult run = RunEstimator(config, log, options);
  ASSERT_TRUE(run.status.ok()) << run.status.message();
  ASSERT_TRUE(run.global.has_value()) << run.align_report;
  int local = 0;
  for (const RunRecord& record : run.records) {
    ASSERT_TRUE(record.observability.has_value());
    const ObservabilityRecord& audited = *record.observability;
    if (record.status == "local") {
      EXPECT_LE(audited.rank, 11);
      EXPECT_LT(audited.yaw_leak, 1e-8);
      ++local;
    }
  }
  EXPECT_GT(local, 5);
  const ObservabilityRecord& last = *run.records.back().observability;
  EXPECT_EQ(last.rank, 15);
  EXPECT_GT(last.position_leak, 100) << "metres: some hundred ranges of half a metre";
  EXPECT_GT(last.yaw_gain, 1e4) << "a hundredth of a radian";
}

}  // namespace
}  // namespace alidade
