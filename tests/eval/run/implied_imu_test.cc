#include "eval/run/implied_imu.h"

#include <gtest/gtest.h>

#include "core/lie.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.81;
const Vector3d kRate(0.3, -0.5, 0.4);
const Vector3d kForce(1.2, -0.7, 10.4);
const ImuBias kBias{{0.01, -0.02, 0.03}, {0.2, -0.1, 0.3}};

/// The state after `seconds` of that constant rate and specific force in the body frame, from fine steps,
/// with these variances of angle [rad^2] and velocity [m^2/s^2].
NavEstimate After(double seconds, double angle_variance = 1e-6, double velocity_variance = 1e-4) {
  constexpr int kSteps = 1000;
  const double dt = seconds / kSteps;
  NavEstimate estimate;
  estimate.stamp_ns = SecondsToNs(100 + seconds);
  estimate.nav.R_WB = so3::Exp(Vector3d(0.1, 0.2, -1));
  estimate.nav.v_WB = {1, 2, 3};
  for (int k = 0; k < kSteps; ++k) {
    const Eigen::Matrix3d middle = estimate.nav.R_WB * so3::Exp(0.5 * dt * kRate);
    estimate.nav.v_WB += dt * (middle * kForce - kGravity * Vector3d::UnitZ());
    estimate.nav.R_WB = estimate.nav.R_WB * so3::Exp(dt * kRate);
  }
  estimate.bias = kBias;
  estimate.covariance.diagonal().head<3>().setConstant(angle_variance);
  estimate.covariance.diagonal().segment<3>(6).setConstant(velocity_variance);
  return estimate;
}

/// interval_s: length of the interval. Within it the rotation changes the mean force by (w dt)^2 / 24 of it.
void ExpectKnown(const ImpliedImu& implied, double seconds, double interval_s) {
  const double turned = kRate.squaredNorm() * interval_s * interval_s / 24 * kForce.norm();
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<double> gyro = implied.Gyro(axis, SecondsToNs(100 + seconds));
    const std::optional<double> accel = implied.Accel(axis, SecondsToNs(100 + seconds));
    ASSERT_TRUE(gyro && accel) << axis;
    EXPECT_NEAR(*gyro, (kRate + kBias.gyro)[axis], 1e-9);
    EXPECT_NEAR(*accel, (kForce + kBias.accel)[axis], turned + 1e-6);
  }
}

TEST(ImpliedImuTest, OfAConstantRateAndForceItIsWhatTheSensorMeasures) {
  ImpliedImu implied(kGravity);
  implied.Add(After(0));
  EXPECT_FALSE(implied.Gyro(0, SecondsToNs(100)));
  implied.Add(After(0.1));
  ExpectKnown(implied, 0.1, 0.1);
  ExpectKnown(implied, 0.1 + ImpliedImu::kLongestS, 0.1);
  EXPECT_FALSE(implied.Gyro(0, SecondsToNs(100.101 + ImpliedImu::kLongestS)));
  implied.Forget();
  EXPECT_FALSE(implied.Gyro(0, SecondsToNs(100.1)));
}

// GIVEN an estimate that nothing has corrected THEN nothing is taken from it, and the next one that is as
// certain as before gives the mean since then.
TEST(ImpliedImuTest, AnEstimateThatHasBecomeUncertainIsPassedOver) {
  ImpliedImu implied(kGravity);
  implied.Add(After(0));
  NavEstimate uncertain = After(0.1, 1e-2, 1);
  uncertain.nav.R_WB = uncertain.nav.R_WB * so3::Exp(Vector3d(0.1, 0.1, 0.1));
  uncertain.nav.v_WB.setZero();
  implied.Add(uncertain);
  EXPECT_FALSE(implied.Gyro(2, SecondsToNs(100.1)));
  EXPECT_FALSE(implied.Accel(2, SecondsToNs(100.1)));
  implied.Add(After(0.2));
  ExpectKnown(implied, 0.2, 0.2);
}

// GIVEN one axis that is uncertain THEN the others are known.
TEST(ImpliedImuTest, EachAxisIsKnownByItsOwnVariance) {
  ImpliedImu implied(kGravity);
  implied.Add(After(0));
  NavEstimate estimate = After(0.1);
  estimate.covariance(1, 1) = 1e-2;
  implied.Add(estimate);
  EXPECT_FALSE(implied.Gyro(1, estimate.stamp_ns));
  EXPECT_TRUE(implied.Gyro(0, estimate.stamp_ns) && implied.Gyro(2, estimate.stamp_ns));
  EXPECT_TRUE(implied.Accel(1, estimate.stamp_ns));
}

// GIVEN a long time without a certain estimate THEN the interval before the next one counts for nothing.
TEST(ImpliedImuTest, AnIntervalIsNoLongerThanASecond) {
  ImpliedImu implied(kGravity);
  implied.Add(After(0));
  implied.Add(After(1.1));
  EXPECT_FALSE(implied.Gyro(0, SecondsToNs(101.1)));
  implied.Add(After(1.2));
  ExpectKnown(implied, 1.2, 0.1);
}

}  // namespace
}  // namespace alidade
