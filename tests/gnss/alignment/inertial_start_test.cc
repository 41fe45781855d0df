#include "gnss/alignment/inertial_start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/imu_propagation.h"
#include "tests/gnss/alignment/kernel_choice.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr TimeNs kStart = 1'700'000'100 * kSecondNs;
constexpr double kImuHz = 200;

/// A body that moves by functions of time [s], with an IMU that has biases and an antenna on a lever arm.
struct Body {
  std::function<Vector3d(double)> position_N;
  std::function<Matrix3d(double)> R_NB;
  ImuBias bias;
  Vector3d p_BA = Vector3d::Zero();
  EnuFrame enu = EnuFrame::At(Vector3d(3582105, 532590, 5232755));
  double position_std_m = 0.5;  ///< in the single points
  double velocity_std_mps = 0.05;

  [[nodiscard]] Vector3d Velocity(double t) const { return Derivative(position_N, t); }
  [[nodiscard]] Vector3d Omega(double t) const {
    constexpr double kStep = 1e-4;
    return so3::Log(R_NB(t - kStep).transpose() * R_NB(t + kStep)) / (2 * kStep);
  }
  [[nodiscard]] NavState State(double t) const { return {R_NB(t), position_N(t), Velocity(t)}; }

  [[nodiscard]] ImuSample Imu(double t) const {
    const Vector3d acceleration_N = Derivative([this](double s) { return Velocity(s); }, t);
    const Vector3d force_B = R_NB(t).transpose() * (acceleration_N - GravityInWorld(9.81));
    return {kStart + SecondsToNs(t), Omega(t) + bias.gyro, force_B + bias.accel};
  }
  /// Exact position and velocity of the antenna.
  [[nodiscard]] SinglePointSolution SinglePoint(double t) const {
    SinglePointSolution solution;
    solution.position_E = enu.ToEcef(position_N(t) + R_NB(t) * p_BA);
    solution.velocity_E = enu.R_EN * (Velocity(t) + R_NB(t) * Omega(t).cross(p_BA));
    solution.position_covariance_E = position_std_m * position_std_m * Matrix3d::Identity();
    solution.velocity_covariance_E = velocity_std_mps * velocity_std_mps * Matrix3d::Identity();
    solution.has_velocity = true;
    solution.clock_m = 900 + 20 * t;
    solution.drift_mps = 20;
    return solution;
  }

 private:
  static Vector3d Derivative(const std::function<Vector3d(double)>& f, double t) {
    constexpr double kStep = 1e-3;  // error of order step^4
    return (8 * (f(t + kStep) - f(t - kStep)) - (f(t + 2 * kStep) - f(t - 2 * kStep))) / (12 * kStep);
  }
};

/// Accelerates, climbs and turns about all axes.
Body Flying() {
  Body body;
  body.position_N = [](double t) {
    return Vector3d(8 * std::sin(0.5 * t), 6 * std::sin(0.7 * t + 0.3), 0.8 * std::sin(0.9 * t));
  };
  body.R_NB = [](double t) -> Matrix3d {
    return so3::Exp(Vector3d(0, 0, 0.4 + 0.5 * std::sin(0.6 * t))) *
           so3::Exp(Vector3d(0, 0.2 * std::sin(0.8 * t), 0)) *
           so3::Exp(Vector3d(0.15 * std::cos(0.5 * t), 0, 0));
  };
  body.bias = {{0.004, -0.003, 0.005}, {0.06, -0.05, 0.04}};
  return body;
}

/// Stays near a place and turns about the vertical at a rate that swings.
Body Swinging() {
  Body body;
  body.position_N = [](double t) { return Vector3d(1.5 * std::sin(0.9 * t), 0.8 * std::cos(0.7 * t), 0); };
  body.R_NB = [](double t) { return so3::Exp(Vector3d(0, 0, 0.8 * std::sin(1.8 * t))); };
  return body;
}

EstimatorConfig Config() {
  EstimatorConfig config;
  config.gnss.enabled = true;
  config.gnss.align_min_epochs = 6;
  return config;
}

GnssInertialStart MakeStart(const EstimatorConfig& config, const Body& body) {
  RigCalibration rig;
  rig.gnss.p_BA = body.p_BA;
  rig.gnss.anchor_E = body.enu.origin_E;
  return {config, rig};
}

/// Feeds IMU and an epoch every `spacing_s` for `seconds`, then asks for the start. `late_s`: by which the
/// stamps of the epochs are early against the IMU's time.
std::optional<GnssInertialStart::Start> Follow(const Body& body, double seconds, double spacing_s,
                                               GnssInertialStart* start, double late_s = 0) {
  const double margin_s = 0.5;
  double next_s = margin_s;
  for (int i = 0; i <= static_cast<int>(std::lround((seconds + 2 * margin_s) * kImuHz)); ++i) {
    const double t = i / kImuHz;
    start->AddImu(body.Imu(t));
    // The IMU is beyond the epoch.
    if (t > next_s + std::abs(late_s) + 0.3 && next_s <= margin_s + seconds) {
      GnssEpoch epoch;
      epoch.stamp_ns = kStart + SecondsToNs(next_s - late_s);
      start->AddEpoch(epoch, body.SinglePoint(next_s));
      next_s += spacing_s;
    }
  }
  return start->TryStart();
}

double SecondsAt(const GnssInertialStart::Start& start) {
  return SecondsBetween(kStart, start.estimate.stamp_ns);
}

/// Error of the start over its deviations, canonical chart: (phi, dp, dv, dbg, dba).
Vector15d ErrorInDeviations(const Body& body, const GnssInertialStart::Start& start) {
  const NavState truth = body.State(SecondsAt(start));
  Vector15d error;
  error << Local(ErrorConvention::kSo3xRn, start.estimate.nav, truth),
      body.bias.gyro - start.estimate.bias.gyro, body.bias.accel - start.estimate.bias.accel;
  return error.cwiseQuotient(start.estimate.covariance.diagonal().cwiseSqrt());
}

TEST(GnssInertialStartTest, GIVEN_exact_epochs_and_IMU_THEN_the_state_is_recovered_within_its_deviations) {
  for (const Vector3d& p_BA : {Vector3d(0, 0, 0), Vector3d(0.3, -0.2, 1.1), Vector3d(-4, 2, 3)}) {
    Body body = Flying();
    body.p_BA = p_BA;
    GnssInertialStart start = MakeStart(Config(), body);
    const auto found = Follow(body, 20, 0.5, &start);
    ASSERT_TRUE(found) << start.report();
    const NavState truth = body.State(SecondsAt(*found));
    const Vector9d error = Local(ErrorConvention::kSo3xRn, found->estimate.nav, truth);
    EXPECT_LT(error.head<3>().norm(), 0.02) << p_BA.transpose();
    EXPECT_LT(error.segment<3>(3).norm(), 0.1) << p_BA.transpose();
    EXPECT_LT(error.tail<3>().norm(), 0.06) << p_BA.transpose();
    EXPECT_LT((found->estimate.bias.gyro - body.bias.gyro).norm(), 3e-3) << p_BA.transpose();
    EXPECT_LT((found->estimate.bias.accel - body.bias.accel).norm(), 0.05) << p_BA.transpose();
    const Vector15d deviations = ErrorInDeviations(body, *found);
    EXPECT_LT(deviations.cwiseAbs().maxCoeff(), 1) << p_BA.transpose() << ": " << deviations.transpose();
    EXPECT_NEAR((*found->alignment.clock)[ClockState::kDrift], 20, 1e-12);
    EXPECT_TRUE(found->alignment.enu->origin_E.isApprox(body.enu.origin_E, 1e-15));
  }
}

// An antenna 6 m from the body's axis sees a bias of the gyroscope in its velocity: b x l.
TEST(GnssInertialStartTest, GIVEN_a_long_lever_arm_THEN_the_antennas_velocity_observes_the_gyroscopes_bias) {
  EstimatorConfig config = Config();
  config.init.gyro_bias_std_radps = 0.2;
  config.gnss.align_max_yaw_std_rad = 1;
  Body body = Swinging();
  body.p_BA = Vector3d(6, 0, 0);
  body.bias.gyro = Vector3d(0, 0, 0.1);
  GnssInertialStart start = MakeStart(config, body);
  const auto found = Follow(body, 2.8, 0.4, &start);
  ASSERT_TRUE(found) << start.report();
  EXPECT_NEAR(found->estimate.bias.gyro.z(), body.bias.gyro.z(), 5e-3);
  // Eight velocities to 0.16 m/s over 6 m: 0.009 rad/s, doubled by align_inflation. Turning and path alone
  // determine it to 0.046 rad/s.
  EXPECT_LT(std::sqrt(found->estimate.covariance(11, 11)), 0.03);
}

// The antenna's velocity at the first epoch belongs to the rate there, not to that of the second.
TEST(GnssInertialStartTest, GIVEN_a_rate_that_changes_THEN_each_epoch_is_fitted_with_its_own) {
  Body body = Swinging();
  body.p_BA = Vector3d(3, 0, 0);
  EstimatorConfig config = Config();
  config.gnss.align_max_yaw_std_rad = 1;
  config.gnss.robust_scale_sigma = 1e3;
  GnssInertialStart start = MakeStart(config, body);
  const auto found = Follow(body, 4, 0.5, &start);
  ASSERT_TRUE(found) << start.report();
  const Vector9d error = Local(ErrorConvention::kSo3xRn, found->estimate.nav, body.State(SecondsAt(*found)));
  EXPECT_LT(error.head<3>().norm(), 5e-3);
  EXPECT_LT(error.tail<3>().norm(), 0.02);
}

TEST(GnssInertialStartTest, GIVEN_late_stamps_WHEN_the_offset_is_estimated_THEN_it_is_found) {
  Body body = Flying();
  body.p_BA = Vector3d(0.3, -0.2, 1.1);
  EstimatorConfig config = Config();
  config.gnss.estimate_time_offset = true;
  GnssInertialStart start = MakeStart(config, body);
  const auto found = Follow(body, 14, 0.5, &start, 0.05);
  ASSERT_TRUE(found) << start.report();
  EXPECT_NEAR(found->alignment.time_offset_s, 0.05, 0.011) << "the grid's spacing";
  EXPECT_NE(start.report().find("time offset"), std::string::npos) << start.report();
}

TEST(GnssInertialStartTest, GIVEN_rest_THEN_it_is_refused_for_too_little_motion) {
  Body body = Flying();
  body.position_N = [](double) { return Vector3d(1, 2, 3); };
  body.R_NB = [](double) -> Matrix3d { return Matrix3d::Identity(); };
  GnssInertialStart start = MakeStart(Config(), body);
  EXPECT_FALSE(Follow(body, 14, 0.5, &start));
  EXPECT_NE(start.report().find("too little motion"), std::string::npos) << start.report();
}

TEST(GnssInertialStartTest, GIVEN_too_few_epochs_THEN_their_number_is_reported) {
  const Body body = Flying();
  GnssInertialStart start = MakeStart(Config(), body);
  EXPECT_FALSE(Follow(body, 2, 0.5, &start));
  EXPECT_NE(start.report().find("5 single points with velocity, expected 6"), std::string::npos)
      << start.report();
}

TEST(GnssInertialStartTest, GIVEN_epochs_that_the_IMU_does_not_reach_THEN_there_is_no_start) {
  const Body body = Flying();
  GnssInertialStart start = MakeStart(Config(), body);
  for (int i = 0; i < 10; ++i) {
    start.AddImu(body.Imu(i / kImuHz));
  }
  for (int i = 0; i < 10; ++i) {
    GnssEpoch epoch;
    epoch.stamp_ns = kStart + i * kSecondNs;
    start.AddEpoch(epoch, body.SinglePoint(i));
  }
  EXPECT_FALSE(start.TryStart());
  EXPECT_NE(start.report().find("do not determine a start"), std::string::npos) << start.report();
}

TEST(GnssInertialStartTest, GIVEN_epochs_without_solution_or_velocity_THEN_they_are_left_out) {
  const Body body = Flying();
  GnssInertialStart start = MakeStart(Config(), body);
  for (int i = 0; i < 10; ++i) {
    GnssEpoch epoch;
    epoch.stamp_ns = kStart + i * kSecondNs;
    SinglePointSolution solution = body.SinglePoint(i);
    solution.has_velocity = false;
    start.AddEpoch(epoch, i % 2 == 0 ? std::nullopt : std::optional(solution));
  }
  EXPECT_FALSE(start.TryStart());
  EXPECT_NE(start.report().find("0 single points"), std::string::npos) << start.report();
  EXPECT_NE(start.report().find("satellites left out: 0 without ephemeris"), std::string::npos)
      << start.report();
}

// GIVEN a receiver whose epochs begin before the IMU, THEN its first epochs are left out.
TEST(GnssInertialStartTest, GIVEN_epochs_before_the_IMU_THEN_the_start_does_without_them) {
  const Body body = Flying();
  GnssInertialStart start = MakeStart(Config(), body);
  for (const double early_s : {-1.0, -0.5}) {
    GnssEpoch epoch;
    epoch.stamp_ns = kStart + SecondsToNs(early_s);
    start.AddEpoch(epoch, body.SinglePoint(early_s));
  }
  EXPECT_TRUE(Follow(body, 20, 0.5, &start)) << start.report();
}

// GIVEN a solution whose datum is not GPS, THEN the clock of the state is still that of GPS.
TEST(GnssInertialStartTest, GIVEN_another_datum_THEN_the_clock_refers_to_GPS) {
  const Body body = Flying();
  GnssInertialStart start = MakeStart(Config(), body);
  const double margin_s = 0.5;
  double next_s = margin_s;
  for (int i = 0; i <= static_cast<int>(std::lround(21 * kImuHz)); ++i) {
    const double t = i / kImuHz;
    start.AddImu(body.Imu(t));
    if (t > next_s + 0.3 && next_s <= 20) {
      GnssEpoch epoch;
      epoch.stamp_ns = kStart + SecondsToNs(next_s);
      SinglePointSolution solution = body.SinglePoint(next_s);
      solution.inter_system_bias_m[SystemIndex(GnssSystem::kGps)] = -30;  // the datum is Galileo
      start.AddEpoch(epoch, solution);
      next_s += 0.5;
    }
  }
  const auto found = start.TryStart();
  ASSERT_TRUE(found) << start.report();
  const Vector6d& clock = *found->alignment.clock;
  EXPECT_NEAR(clock[ClockState::kClock], 900 + 20 * 20 - 30, 1e-9);
  EXPECT_NEAR(clock[ClockState::kBiases], 30, 1e-12) << "Galileo against GPS";
}

TEST(GnssInertialStartTest, GIVEN_epochs_that_are_late_THEN_the_kernel_is_the_configured_one) {
  const Body body = Flying();
  test::ExpectKernelIsTaken([&](RobustKernel kernel, double scale_sigma) {
    EstimatorConfig config = Config();
    config.gnss.robust_kernel = kernel;
    config.gnss.robust_scale_sigma = scale_sigma;
    GnssInertialStart start = MakeStart(config, body);
    const auto found = Follow(body, 20, 0.5, &start, 0.1);
    return found ? found->estimate.nav.p_WB.x() : 0;
  });
}

}  // namespace
}  // namespace alidade
