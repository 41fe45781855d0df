#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "core/error_convention.h"
#include "frontend/initialization/initializer.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double kGravity = 9.81;
constexpr TimeNs kStart = 1'403'715'273'262'142'976;

/// A body whose motion is given by functions of time [s]; IMU 200 Hz, frames 20 Hz.
struct Bench {
  EstimatorConfig config;
  RigCalibration rig;
  Eigen::Matrix3d R_WB = Eigen::Matrix3d::Identity();
  ImuBias bias;
  Vector3d rate_B = Vector3d::Zero();
  double shake_mps2 = 0;
  Vector2d flow_pxps = Vector2d::Zero();
  int tracks = 80;
  double duration_s = 1.5;
  unsigned seed = 1;

  Bench() {
    rig.camera = *CameraModel::Create(DistortionModel::kNone, {460, 460, 376, 240}, {}, 752, 480);
    config.init.method = InitMethod::kStatic;
  }

  [[nodiscard]] Eigen::Matrix3d RotationAt(double t) const { return R_WB * so3::Exp(rate_B * t); }

  Result<NavEstimate> Run() const {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const auto noise = [&](double std) {
      return Vector3d(std * normal(random), std * normal(random), std * normal(random));
    };
    const double rate_root = std::sqrt(200.0);
    Initializer initializer(config, rig);
    Result<NavEstimate> result = Status::Diverged("no frame");
    std::uniform_real_distribution<double> u(20, 730), v(20, 460);
    std::vector<Vector2d> pixels;
    pixels.reserve(static_cast<std::size_t>(tracks));
    for (int i = 0; i < tracks; ++i) {
      pixels.emplace_back(u(random), v(random));
    }
    for (int k = 0; k <= static_cast<int>(duration_s * 200); ++k) {
      const double t = k / 200.0;
      ImuSample sample{kStart + SecondsToNs(t), Vector3d::Zero(), Vector3d::Zero()};
      sample.gyro = rate_B + bias.gyro + noise(rig.imu_noise.gyro_noise_density_radps_sqrthz * rate_root);
      sample.accel = RotationAt(t).transpose() * Vector3d(0, 0, kGravity) + bias.accel +
                     noise(rig.imu_noise.accel_noise_density_mps2_sqrthz * rate_root) +
                     shake_mps2 * std::sin(30 * t) * Vector3d::UnitX();
      initializer.AddImu(sample);
      if (k % 10 == 0) {
        TrackFrame frame{sample.stamp_ns, {}, 0};
        for (int i = 0; i < tracks; ++i) {
          const Vector2d pixel_noise(normal(random), normal(random));
          frame.observations.push_back({i, pixels[static_cast<size_t>(i)] + flow_pxps * t + pixel_noise});
        }
        result = initializer.AddFrame(frame);
        if (result.ok()) {
          EXPECT_EQ(initializer.method(), "static");
          return result;
        }
      }
    }
    return result;
  }
};

// GIVEN a camera whose stamps are late, WHEN a start is found, THEN it is stamped with the IMU time of its
// frame, where the state stands.
TEST(StaticInitializer, GIVEN_a_time_offset_THEN_the_state_bears_the_IMU_time_of_its_frame) {
  Bench bench;
  bench.rig.camera_time_offset_s = -0.03;
  const Result<NavEstimate> estimate = bench.Run();
  ASSERT_TRUE(estimate.ok()) << estimate.message();
  constexpr TimeNs kFrameInterval = 50'000'000;
  EXPECT_EQ((estimate->stamp_ns - kStart) % kFrameInterval, 20'000'000);
}

TEST(StaticInitializer, GIVEN_rest_with_biases_THEN_tilt_and_biases_are_within_three_sigma) {
  double nees = 0;
  const int runs = 40;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    Bench bench;
    bench.seed = seed;
    std::mt19937 random(1000 + seed);
    std::normal_distribution<double> normal;
    const auto draw = [&](double std) {
      return Vector3d(std * normal(random), std * normal(random), std * normal(random));
    };
    const Vector3d tilt(0.8 * normal(random), 0.8 * normal(random), 0);
    bench.R_WB = so3::Exp(tilt);
    bench.bias.gyro = draw(0.04);
    bench.bias.accel = draw(bench.config.init.accel_bias_std_mps2);
    const Result<NavEstimate> found = bench.Run();
    ASSERT_TRUE(found.ok()) << found.message();
    // Yaw is a convention, not a measurement: give the truth the estimate's yaw.
    const auto yaw_of = [](const Eigen::Matrix3d& r) { return std::atan2(r(1, 0), r(0, 0)); };
    EXPECT_NEAR(yaw_of(found->nav.R_WB), 0, 1e-12);
    const Eigen::Matrix3d truth = so3::Exp(Vector3d(0, 0, -yaw_of(bench.R_WB))) * bench.R_WB;
    Vector15d error = Vector15d::Zero();
    error.head<3>() = so3::Log(found->nav.R_WB.transpose() * truth);
    error.segment<3>(9) = bench.bias.gyro - found->bias.gyro;
    error.segment<3>(12) = bench.bias.accel - found->bias.accel;
    const Matrix15d& p = found->covariance;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix15d>(p).eigenvalues().minCoeff(), 0);
    for (int i = 0; i < 15; ++i) {
      // The zero-yaw convention moves the yaw by tilt error x tan(pitch): the rotation is compared through
      // the NEES.
      if (i >= 3) {
        EXPECT_LT(std::abs(error[i]), 4 * std::sqrt(p(i, i))) << "component " << i << " seed " << seed;
      }
    }
    // Gauge-free: up in the body and the biases.
    const Vector3d up = found->nav.R_WB.transpose().col(2);
    const Eigen::Matrix<double, 3, 2> across = up.unitOrthogonal() * Eigen::RowVector2d(1, 0) +
                                               up.cross(up.unitOrthogonal()) * Eigen::RowVector2d(0, 1);
    Eigen::Matrix<double, 8, 15> pick = Eigen::Matrix<double, 8, 15>::Zero();
    pick.block<2, 3>(0, 0) = across.transpose();
    pick.block<6, 6>(2, 9).setIdentity();
    const Eigen::Matrix<double, 8, 1> e = pick * error;
    const Eigen::Matrix<double, 8, 8> p_e = pick * p * pick.transpose();
    nees += e.dot(p_e.ldlt().solve(e)) / runs;
  }
  // 8 degrees of freedom; the accelerometer's gravity floor makes one of them pessimistic on purpose.
  EXPECT_GT(nees, 5.0);
  EXPECT_LT(nees, 10.0);
}

TEST(StaticInitializer, WHEN_accel_bias_is_large_THEN_the_covariance_ties_it_to_the_tilt) {
  Bench bench;
  bench.config.init.accel_bias_std_mps2 = 0.5;
  const Result<NavEstimate> found = bench.Run();
  ASSERT_TRUE(found.ok()) << found.message();
  const Matrix15d& p = found->covariance;
  EXPECT_NEAR(std::sqrt(p(0, 0)), 0.5 / kGravity, 0.002);
  EXPECT_GT(std::abs(p(0, 13)) / std::sqrt(p(0, 0) * p(13, 13)), 0.99);
  // phi = u x b_a / g with u = z: b_a along y tilts about -x.
  EXPECT_LT(p(0, 13), 0);
}

TEST(StaticInitializer, WHEN_the_window_is_not_full_THEN_it_waits) {
  Bench bench;
  bench.duration_s = 0.8;
  const Result<NavEstimate> found = bench.Run();
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.code(), StatusCode::kDiverged);
  EXPECT_THAT(found.message(), HasSubstr("at rest for 0.80 s of 1.00 s"));
}

TEST(StaticInitializer, WHEN_shaken_THEN_it_refuses) {
  Bench bench;
  bench.shake_mps2 = 2;
  const Result<NavEstimate> found = bench.Run();
  ASSERT_FALSE(found.ok());
  EXPECT_THAT(found.message(), HasSubstr("accelerometer spread"));
}

TEST(StaticInitializer, WHEN_it_rotates_at_a_constant_rate_THEN_it_refuses) {
  Bench fast;
  fast.rate_B = Vector3d(0, 0, 0.5);
  fast.tracks = 0;
  EXPECT_THAT(fast.Run().message(), HasSubstr("mean rate"));

  Bench slow_about_horizontal;
  slow_about_horizontal.rate_B = Vector3d(0.04, 0, 0);
  slow_about_horizontal.tracks = 0;
  EXPECT_THAT(slow_about_horizontal.Run().message(), HasSubstr("specific force drifts"));

  Bench slow_about_vertical;  // the IMU alone cannot separate this from a bias: the tracks do
  slow_about_vertical.rate_B = Vector3d(0, 0, 0.05);
  slow_about_vertical.flow_pxps = Vector2d(0.05 * 460, 0);
  EXPECT_THAT(slow_about_vertical.Run().message(), HasSubstr("tracks move"));
}

TEST(StaticInitializer, WHEN_it_moves_at_constant_velocity_THEN_the_tracks_refuse_it) {
  Bench bench;
  bench.flow_pxps = Vector2d(3, -2);
  const Result<NavEstimate> found = bench.Run();
  ASSERT_FALSE(found.ok());
  EXPECT_THAT(found.message(), HasSubstr("tracks move"));
}

TEST(StaticInitializer, WHEN_there_are_no_tracks_THEN_the_imu_alone_decides) {
  Bench bench;
  bench.tracks = 0;
  EXPECT_TRUE(bench.Run().ok());
}

TEST(StaticInitializer, WHEN_stamps_do_not_increase_THEN_the_frame_is_refused) {
  const Bench bench;
  Initializer initializer(bench.config, bench.rig);
  EXPECT_EQ(initializer.AddFrame({kStart, {}, 0}).code(), StatusCode::kDiverged);
  EXPECT_EQ(initializer.AddFrame({kStart, {}, 0}).code(), StatusCode::kInput);
}

}  // namespace
}  // namespace alidade
