#include "eval/simulation/spline_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.h"
#include "eval/simulation/sim_imu.h"
#include "eval/simulation/sim_trajectory.h"
#include "eval/trajectory/trajectory_reader.h"
#include "tests/support/shared_data.h"
#include "tests/support/steps.h"

namespace alidade {
namespace {

constexpr TimeNs kStart = 1403715273262142976;

Trajectory SampleFigureEight(double duration_s, double rate_hz) {
  const auto trajectory = MakeSimTrajectory(SimulatorConfig());
  const std::vector<TimeNs> stamps = EvenStamps(kStart, duration_s, rate_hz);
  return SampleTruth(*trajectory, stamps, std::vector<ImuBias>(stamps.size()));
}

TEST(SplineTrajectoryTest, DerivativesAreExact) {
  const Result<SplineTrajectory> spline = SplineTrajectory::Fit(SampleFigureEight(20, 100), 0.1);
  ASSERT_TRUE(spline.ok()) << spline.message();
  constexpr double kStep = 1e-4;
  // 7.0 s is a knot; -0.2 s and 20.3 s lie in the margins.
  for (const double t : {-0.2, 0.01, 3.33, 7.0, 12.345, 19.99, 20.3}) {
    const Kinematics before = spline->At(t - kStep);
    const Kinematics at = spline->At(t);
    const Kinematics after = spline->At(t + kStep);
    const Eigen::Vector3d velocity = (after.nav.p_WB - before.nav.p_WB) / (2 * kStep);
    const Eigen::Vector3d acceleration = (after.nav.v_WB - before.nav.v_WB) / (2 * kStep);
    const Eigen::Vector3d rate = so3::Log(before.nav.R_WB.transpose() * after.nav.R_WB) / (2 * kStep);
    EXPECT_LT((velocity - at.nav.v_WB).norm(), 1e-6) << t;
    EXPECT_LT((acceleration - at.acceleration_W).norm(), 1e-6) << t;
    EXPECT_LT((rate - at.angular_rate_B).norm(), 1e-6) << t;
  }
}

TEST(SplineTrajectoryTest, FollowsASmoothMotionWithItsDerivatives) {
  const Result<SplineTrajectory> spline = SplineTrajectory::Fit(SampleFigureEight(20, 100), 0.1);
  ASSERT_TRUE(spline.ok()) << spline.message();
  EXPECT_EQ(spline->start_ns(), kStart);
  EXPECT_NEAR(spline->DurationSeconds(), 20, 1e-9);
  EXPECT_LT(spline->fit().position_max_m, 5e-6) << "largest at the ends";
  EXPECT_LT(spline->fit().rotation_max_rad, 5e-6);
  EXPECT_NEAR(spline->fit().max_gap_s, 0.01, 1e-9);
  const auto truth = MakeSimTrajectory(SimulatorConfig());
  for (const double t : test::Steps(0.5, 19.5, 0.0371)) {
    const Kinematics expected = truth->At(t);
    const Kinematics actual = spline->At(t);
    ASSERT_LT((actual.nav.p_WB - expected.nav.p_WB).norm(), 1e-6) << t;
    ASSERT_LT((actual.nav.v_WB - expected.nav.v_WB).norm(), 1e-5) << t;
    ASSERT_LT((actual.acceleration_W - expected.acceleration_W).norm(), 1e-3) << t;
    ASSERT_LT((actual.angular_rate_B - expected.angular_rate_B).norm(), 1e-4) << t;
  }
}

TEST(SplineTrajectoryTest, SmoothsNoiseOfItsSamples) {
  Trajectory samples = SampleFigureEight(20, 200);
  RandomStream stream(1, "test");
  for (TrajectoryPoint& point : samples.points) {
    point.nav.p_WB += 1e-3 * stream.Normal3();
    point.nav.R_WB = point.nav.R_WB * so3::Exp(1e-3 * stream.Normal3());
  }
  const Result<SplineTrajectory> spline = SplineTrajectory::Fit(samples, 0.1);
  ASSERT_TRUE(spline.ok()) << spline.message();
  // Twenty samples a control point: the residual keeps sqrt(19/20) of the noise, the spline sqrt(1/20) of it.
  EXPECT_NEAR(spline->fit().position_rms_m, 1e-3 * std::sqrt(3 * 0.95), 4e-5);
  EXPECT_NEAR(spline->fit().rotation_rms_rad, 1e-3 * std::sqrt(3 * 0.95), 4e-5);
  const auto truth = MakeSimTrajectory(SimulatorConfig());
  double square = 0;
  int count = 0;
  for (const double t : test::Steps(0.5, 19.5, 0.01)) {
    square += (spline->At(t).nav.p_WB - truth->At(t).nav.p_WB).squaredNorm();
    ++count;
  }
  EXPECT_NEAR(std::sqrt(square / count), 1e-3 * std::sqrt(3 * 0.05), 1e-4);
}

TEST(SplineTrajectoryTest, BridgesAGapAndReportsIt) {
  Trajectory samples = SampleFigureEight(20, 100);
  samples.points.erase(samples.points.begin() + 1000, samples.points.begin() + 1080);
  const Result<SplineTrajectory> spline = SplineTrajectory::Fit(samples, 0.1);
  ASSERT_TRUE(spline.ok()) << spline.message();
  EXPECT_NEAR(spline->fit().max_gap_s, 0.81, 1e-6);
  const auto truth = MakeSimTrajectory(SimulatorConfig());
  EXPECT_LT((spline->At(10.4).nav.p_WB - truth->At(10.4).nav.p_WB).norm(), 0.05);
  EXPECT_LT(so3::Log(spline->At(10.4).nav.R_WB.transpose() * truth->At(10.4).nav.R_WB).norm(), 0.05);
}

TEST(SplineTrajectoryTest, ImuOfTheSplineIntegratesToTheSpline) {
  const Result<SplineTrajectory> spline = SplineTrajectory::Fit(SampleFigureEight(20, 100), 0.1);
  ASSERT_TRUE(spline.ok()) << spline.message();
  SimImuErrors none;
  none.noise = {0, 0, 0, 0};
  const std::vector<TimeNs> stamps = EvenStamps(kStart, 19, 1000);
  const SimulatedImu imu = SimulateImu(*spline, stamps, 1000, 9.81, none, 1);
  NavState state = spline->At(0).nav;
  for (std::size_t k = 1; k < stamps.size(); ++k) {
    constexpr double kDt = 1e-3;
    const Eigen::Matrix3d R_next =
        state.R_WB * so3::Exp(0.5 * (imu.samples[k - 1].gyro + imu.samples[k].gyro) * kDt);
    const Eigen::Vector3d a_W =
        0.5 * (state.R_WB * imu.samples[k - 1].accel + R_next * imu.samples[k].accel) -
        Eigen::Vector3d(0, 0, 9.81);
    state.p_WB += state.v_WB * kDt + 0.5 * a_W * kDt * kDt;
    state.v_WB += a_W * kDt;
    state.R_WB = R_next;
  }
  EXPECT_LT((state.p_WB - spline->At(19).nav.p_WB).norm(), 1e-3);
}

TEST(SplineTrajectoryTest, RealFlightsSettleAtEverySpacing) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::string folder = test::SharedDir() + "/data/euroc/V1_02_medium/mav0/state_groundtruth_estimate0/";
  Trajectory samples = ReadTrajectory(folder + "data.csv").value();
  samples.points.resize(6000);  // ends in flight
  for (const double spacing_s : {0.05, 0.1, 0.2}) {
    const Result<SplineTrajectory> spline = SplineTrajectory::Fit(samples, spacing_s);
    ASSERT_TRUE(spline.ok()) << spline.message();
    EXPECT_LT(spline->fit().rotation_max_rad, 0.03) << spacing_s;
    const double end_s = spline->DurationSeconds();
    EXPECT_LT((spline->At(end_s).nav.v_WB - samples.points.back().nav.v_WB).norm(), 0.1) << "tame at the end";
    EXPECT_LT(spline->At(end_s).angular_rate_B.norm(), 2) << spacing_s;
    EXPECT_LT(spline->At(end_s).acceleration_W.norm(), 10) << spacing_s;
  }
}

TEST(SplineTrajectoryTest, AHardLandingAtTheEndSettles) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::string folder =
      test::SharedDir() + "/data/euroc/MH_05_difficult/mav0/state_groundtruth_estimate0/";
  Trajectory samples = ReadTrajectory(folder + "data.csv").value();
  samples.points.erase(samples.points.begin(), samples.points.end() - 4000);
  EXPECT_TRUE(SplineTrajectory::Fit(samples, 0.1).ok());
}

TEST(SplineTrajectoryTest, BadSamplesAreInputErrors) {
  const Trajectory good = SampleFigureEight(2, 100);
  const auto code = [](const Trajectory& samples, double spacing_s) {
    return SplineTrajectory::Fit(samples, spacing_s).code();
  };
  EXPECT_EQ(code(good, 0.1), StatusCode::kOk);
  EXPECT_EQ(code(good, 0), StatusCode::kInput);
  EXPECT_EQ(code(good, 3), StatusCode::kInput);
  EXPECT_EQ(code(Trajectory(), 0.1), StatusCode::kInput);
  Trajectory bad = good;
  bad.points[5].stamp_ns = bad.points[4].stamp_ns;
  EXPECT_EQ(code(bad, 0.1), StatusCode::kInput);
  bad = good;
  bad.points[5].nav.p_WB.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(bad, 0.1), StatusCode::kInput);
}

}  // namespace
}  // namespace alidade
