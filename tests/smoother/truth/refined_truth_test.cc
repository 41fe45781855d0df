#include "smoother/truth/refined_truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <memory>

#include "core/numbers.h"
#include "core/random.h"
#include "eval/metrics/nees.h"
#include "eval/simulation/sim_imu.h"
#include "eval/simulation/sim_trajectory.h"
#include "eval/trajectory/trajectory_point.h"
#include "smoother/truth/fixed_point.h"
#include "tests/support/steps.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr double kRateHz = 100;
constexpr double kDurationS = 20;
constexpr TruthNoise kNoise{0.2 * kRadiansPerDegree, 1e-3};

/// A simulated motion capture: IMU, the exact motion, and poses of a marker that is 5 cm and 3 deg off the
/// body in a frame tilted by 0.5 deg, 8 ms late.
struct Capture {
  SimulatedImu imu;
  Trajectory motion;
  TruthConstants constants;
  std::vector<TruthPose> poses;
  TruthRefinementOptions options;
};

Capture MakeCapture(unsigned seed) {
  SimulatorConfig config;
  config.duration_s = kDurationS;
  config.path_m = 26;
  config.wobble_rad = 0.3;
  config.wobble_hz = 0.5;
  const std::unique_ptr<const ContinuousTrajectory> trajectory = MakeSimTrajectory(config, seed);
  const TimeNs start_ns = 1000 * kSecondNs;
  const std::vector<TimeNs> stamps = EvenStamps(start_ns, kDurationS, kRateHz);
  Capture capture;
  capture.options.imu_noise = config.imu_noise;
  capture.imu = SimulateImu(*trajectory, stamps, kRateHz, config.gravity_mps2,
                            {config.imu_noise, config.gyro_bias_radps, config.accel_bias_mps2}, seed);
  capture.motion = SampleTruth(*trajectory, stamps, capture.imu.biases);
  capture.constants.R_TW = so3::Exp(Vector3d(0.4, -0.3, 0) * kRadiansPerDegree);
  capture.constants.T_BM = {so3::Exp(Vector3d(2, -1, 2) * kRadiansPerDegree), {0.03, -0.02, 0.035}};
  capture.constants.time_offset_s = -0.008;
  RandomStream orientation(seed, "capture.orientation");
  RandomStream position(seed, "capture.position");
  for (const double time_s : test::Steps(0.2, kDurationS - 0.2, 1 / 120.0)) {
    const NavState nav = trajectory->At(time_s).nav;
    Pose T_TM = Pose{capture.constants.R_TW, Vector3d::Zero()} * nav.T_WB() * capture.constants.T_BM;
    T_TM.rotation = T_TM.rotation * so3::Exp(kNoise.orientation_rad * orientation.Normal3());
    T_TM.translation += kNoise.position_m * position.Normal3();
    capture.poses.push_back({start_ns + SecondsToNs(time_s - capture.constants.time_offset_s), T_TM});
  }
  return capture;
}

Result<RefinedTruth> Refine(const Capture& capture) {
  return RefineTruth(capture.imu.samples, capture.poses, capture.options);
}

/// Errors of the constants over their deviations.
TruthConstantsError NormalizedErrors(const RefinedTruth& refined, const TruthConstants& truth) {
  TruthConstantsError error;
  error << so3::Log(refined.constants.R_TW.transpose() * truth.R_TW).head<2>(),
      so3::Log(refined.constants.T_BM.rotation.transpose() * truth.T_BM.rotation),
      truth.T_BM.translation - refined.constants.T_BM.translation,
      truth.time_offset_s - refined.constants.time_offset_s;
  return error.cwiseQuotient(refined.constants_covariance.diagonal().cwiseSqrt());
}

/// The refined state at a stamp of the IMU beside the true one.
StatePair PairAt(const RefinedTruth& refined, const Trajectory& motion, TimeNs stamp_ns) {
  StatePair pair;
  for (const NavEstimate& state : refined.states) {
    if (state.stamp_ns == stamp_ns) {
      pair.estimate = PointOf(state);
    }
  }
  for (const TrajectoryPoint& point : motion.points) {
    if (point.stamp_ns == stamp_ns) {
      pair.truth = point;
    }
  }
  EXPECT_EQ(pair.estimate.stamp_ns, pair.truth.stamp_ns);
  return pair;
}

TEST(RefinedTruthTest, GivenAMotionCaptureThenItsConstantsAndItsNoiseAreFound) {
  const Capture capture = MakeCapture(1);
  const Result<RefinedTruth> refined = Refine(capture);
  ASSERT_TRUE(refined.ok()) << refined.message();
  const TruthConstantsError errors = NormalizedErrors(*refined, capture.constants);
  EXPECT_LT(errors.cwiseAbs().maxCoeff(), 3) << errors.transpose();
  // They are known well enough for that to mean something.
  const TruthConstantsError sigma = refined->constants_covariance.diagonal().cwiseSqrt();
  EXPECT_LT(sigma.segment<5>(0).maxCoeff(), 0.05 * kRadiansPerDegree);
  EXPECT_LT(sigma.segment<3>(kLeverColumn).maxCoeff(), 3e-3);
  EXPECT_LT(sigma[kTimeColumn], 3e-4);
  EXPECT_NEAR(refined->noise.orientation_rad / kNoise.orientation_rad, 1, 0.03);
  EXPECT_NEAR(refined->noise.position_m / kNoise.position_m, 1, 0.03);
  EXPECT_NEAR(refined->orientation_correlation, 1, 0.2);
  EXPECT_NEAR(refined->orientation.ratio(), 1, 1e-3);
  EXPECT_NEAR(refined->gyro.ratio(), 1, 0.5);
  EXPECT_NEAR(refined->accel.ratio(), 1, 0.5);
  EXPECT_LT(refined->refused, 5u) << "of 2350";
  EXPECT_TRUE(refined->spans.empty());
  // States at the IMU's stamps, between the first and the last pose.
  EXPECT_NEAR(static_cast<double>(refined->states.size()), 1960, 3);
}

/// Figures of docs/refined_truth.md, on standard output.
void RecordNees(const NeesResult& nees, double constants) {
  std::printf("NEES pose %.2f, orientation %.2f, position %.2f; constants %.2f\n", nees.mean_pose,
              nees.mean_orientation, nees.mean_position, constants);
}

TEST(RefinedTruthTest, TheCovarianceOfRefinedPosesIsThatOfTheirErrors) {
  constexpr unsigned seeds = 20;
  // The middle of one run a seed: independent samples.
  std::vector<StatePair> pairs;
  double constants = 0;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const Capture capture = MakeCapture(seed);
    const Result<RefinedTruth> refined = Refine(capture);
    ASSERT_TRUE(refined.ok()) << refined.message();
    pairs.push_back(PairAt(*refined, capture.motion, capture.imu.samples[1000].stamp_ns));
    constants += NormalizedErrors(*refined, capture.constants).squaredNorm() / kTruthConstants;
  }
  const NeesResult nees = ComputeNees(pairs);
  for (const auto& [mean, dof] : {std::pair(nees.mean_pose, 6), std::pair(nees.mean_orientation, 3),
                                  std::pair(nees.mean_position, 3)}) {
    const auto [low, high] = NeesBand(dof, seeds, 0.99);
    EXPECT_GT(mean, low) << dof;
    EXPECT_LT(mean, high) << dof;
  }
  RecordNees(nees, constants / seeds);
}

TEST(RefinedTruthTest, GivenWrongPosesThenTheyAreRefused) {
  Capture capture = MakeCapture(2);
  RandomStream wrong(2, "wrong poses");
  size_t count = 0;
  for (TruthPose& pose : capture.poses) {
    if (wrong.Chance(0.02)) {
      pose.T_TM.translation += 0.3 * wrong.Normal3();
      pose.T_TM.rotation = pose.T_TM.rotation * so3::Exp(0.4 * wrong.Normal3());
      ++count;
    }
  }
  const Result<RefinedTruth> refined = Refine(capture);
  ASSERT_TRUE(refined.ok()) << refined.message();
  EXPECT_GE(refined->refused, count);
  EXPECT_LT(refined->refused, count + 5);
  EXPECT_LT(NormalizedErrors(*refined, capture.constants).cwiseAbs().maxCoeff(), 3.5);
  EXPECT_NEAR(refined->noise.position_m / kNoise.position_m, 1, 0.03);
}

TEST(RefinedTruthTest, GivenAGapThenTheImuHoldsAndTheCovarianceGrows) {
  Capture capture = MakeCapture(3);
  const TimeNs from_ns = capture.imu.samples[900].stamp_ns;
  const TimeNs to_ns = capture.imu.samples[1100].stamp_ns;
  std::erase_if(capture.poses,
                [&](const TruthPose& pose) { return pose.stamp_ns > from_ns && pose.stamp_ns < to_ns; });
  const Result<RefinedTruth> refined = Refine(capture);
  ASSERT_TRUE(refined.ok()) << refined.message();
  ASSERT_EQ(refined->spans.size(), 1u);
  EXPECT_NEAR(SecondsBetween(refined->spans[0].from_ns, refined->spans[0].to_ns), 2, 0.02);
  const StatePair inside = PairAt(*refined, capture.motion, capture.imu.samples[1000].stamp_ns);
  const StatePair outside = PairAt(*refined, capture.motion, capture.imu.samples[600].stamp_ns);
  EXPECT_GT(inside.estimate.covariance.trace(), outside.estimate.covariance.trace());
  EXPECT_LT(ComputeNees({inside}).mean_pose, NeesBand(6, 1, 0.999).second);
}

TEST(RefinedTruthTest, GivenAMarkerTurnedFarAndAFrameOnItsSideThenBothAreFound) {
  Capture capture = MakeCapture(4);
  const Eigen::Matrix3d marker = so3::Exp(Vector3d(1, -1.5, 0.7));
  const Eigen::Matrix3d frame = so3::Exp(Vector3d(-1.57, 0, 0));  // y up
  for (TruthPose& pose : capture.poses) {
    pose.T_TM = {frame * pose.T_TM.rotation * marker, frame * pose.T_TM.translation};
  }
  capture.constants.R_TW = frame * capture.constants.R_TW;
  capture.constants.T_BM.rotation = capture.constants.T_BM.rotation * marker;
  const Result<RefinedTruth> refined = Refine(capture);
  ASSERT_TRUE(refined.ok()) << refined.message();
  const TruthConstantsError errors = NormalizedErrors(*refined, capture.constants);
  EXPECT_LT(errors.segment<7>(kMarkerColumn).cwiseAbs().maxCoeff(), 4) << errors.transpose();
  EXPECT_LT((refined->constants.R_TW.col(2) - capture.constants.R_TW.col(2)).norm(), 1e-3);
}

TEST(RefinedTruthTest, GivenADeviationThenItIsKept) {
  Capture capture = MakeCapture(1);
  capture.options.noise.position_m = 2e-3;
  const Result<RefinedTruth> refined = Refine(capture);
  ASSERT_TRUE(refined.ok()) << refined.message();
  EXPECT_EQ(refined->noise.position_m, 2e-3);
  EXPECT_NEAR(refined->position.ratio(), 0.25, 0.02);
  EXPECT_NEAR(refined->noise.orientation_rad / kNoise.orientation_rad, 1, 0.03);
}

TEST(RefinedTruthTest, GivenAnImuWithScaleErrorsThenTheFactorsAreFound) {
  Capture capture = MakeCapture(5);
  const TruthImuScale wrong{{4e-3, -6e-3, 5e-3}, {-5e-3, 8e-3, 6e-3}};
  for (ImuSample& sample : capture.imu.samples) {
    sample = wrong.Applied(sample);
  }
  const Result<RefinedTruth> taken = Refine(capture);
  capture.options.imu_scale = true;
  const Result<RefinedTruth> refined = Refine(capture);
  ASSERT_TRUE(refined.ok()) << refined.message();
  Vector6d error, size;
  size << wrong.gyro, wrong.accel;
  error << refined->imu_scale.gyro, refined->imu_scale.accel;
  error = (error.array() + 1) * (size.array() + 1) - 1;
  EXPECT_LT(error.cwiseQuotient(refined->imu_scale_std).cwiseAbs().maxCoeff(), 3.5) << error.transpose();
  EXPECT_LT(refined->imu_scale_std.head<3>().maxCoeff(), 3e-3);
  EXPECT_LT(NormalizedErrors(*refined, capture.constants).cwiseAbs().maxCoeff(), 3.5);
  // Not estimated, they show in the residuals.
  ASSERT_TRUE(taken.ok()) << taken.message();
  EXPECT_TRUE(taken->imu_scale_std.isZero(0));
  EXPECT_GT(taken->gyro.ratio(), 1.5 * refined->gyro.ratio());
}

TEST(RefinedTruthTest, GivenATruthMadeWithItsImuThenItsNoiseStopsAtItsLeastValue) {
  Capture capture = MakeCapture(6);
  const Result<RefinedTruth> first = Refine(capture);
  ASSERT_TRUE(first.ok()) << first.message();
  capture.poses.clear();
  for (size_t k = 0; k < first->states.size(); k += 5) {
    capture.poses.push_back({first->states[k].stamp_ns, first->states[k].nav.T_WB()});
  }
  const Result<RefinedTruth> second = Refine(capture);
  ASSERT_TRUE(second.ok()) << second.message();
  EXPECT_LE(second->noise.orientation_rad, 1e-4);
  EXPECT_GE(second->noise.orientation_rad, 1e-5);
  EXPECT_GE(second->noise.position_m, 1e-5);
}

TEST(FixedPointTest, AnIterationThatConvergesSlowlyTakesFewSteps) {
  // log x <- 0.7 log x: 26 plain steps to 1e-4.
  FixedPoint fixed_point;
  double x = 20;
  int steps = 0;
  while (std::abs(std::log(x)) > 1e-4 && steps < 26) {
    x = fixed_point.Next(x, std::pow(x, 0.7));
    ++steps;
  }
  EXPECT_LE(steps, 4);
  EXPECT_EQ(fixed_point.Next(2, 2), 2) << "where it stands it stays";
}

TEST(RefinedTruthTest, BadInputIsRefused) {
  Capture capture = MakeCapture(1);
  Capture few = capture;
  few.poses.resize(9);
  EXPECT_EQ(Refine(few).code(), StatusCode::kInput);
  EXPECT_THAT(Refine(few).message(), testing::HasSubstr("9 poses"));
  Capture exact = capture;
  exact.options.imu_noise.accel_random_walk_mps3_sqrthz = 0;
  EXPECT_EQ(Refine(exact).code(), StatusCode::kInput);
  Capture torn = capture;
  torn.imu.samples[500].gyro.x() = kNan;
  EXPECT_FALSE(Refine(torn).ok());
  std::atomic<bool> stop = true;
  capture.options.stop = &stop;
  EXPECT_EQ(Refine(capture).code(), StatusCode::kDiverged);
}

}  // namespace
}  // namespace alidade
