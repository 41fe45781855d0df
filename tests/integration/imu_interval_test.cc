#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/imu_propagation.h"
#include "filter/filter.h"
#include "smoother/sliding/smoother.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

// The filter and the smoother carry a state over the IMU by the same model.

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.81;
constexpr double kImuRateHz = 100;
constexpr int kSamplesPerFrame = 10;

NavEstimate RandomStart(test::RandomStates* random) {
  NavEstimate start;
  start.nav = random->Nav(5);
  start.bias = random->Bias();
  Vector15d deviation;
  deviation << Vector3d::Constant(0.02), Vector3d::Constant(0.1), Vector3d::Constant(0.05),
      Vector3d::Constant(0.002), Vector3d::Constant(0.03);
  Matrix15d mixing = Matrix15d::Identity();
  for (double& entry : mixing.reshaped()) {
    entry += random->Uniform(-0.1, 0.1);
  }
  const Matrix15d root = deviation.asDiagonal() * mixing;
  start.covariance = root * root.transpose();
  return start;
}

/// Largest entry of the difference, whitened by b.
double RelativeDifference(const Matrix15d& a, const Matrix15d& b) {
  const Eigen::LLT<Matrix15d> factor(b);
  const Matrix15d half = factor.matrixL().solve(a - b);
  return factor.matrixL().solve(half.transpose()).cwiseAbs().maxCoeff();
}

// GIVEN equal starts and IMU samples WHEN no camera or GNSS says anything, over more frames than the smoother
// keeps, THEN mean and covariance of both back ends are the same in every error convention, and those of the
// samples carried at once.
TEST(ImuIntervalTest, FilterAndSmootherCarryTheSameState) {
  for (const ErrorConvention convention : test::kAllConventions) {
    test::RandomStates random(11);
    EstimatorConfig config;
    config.imu.gravity_mps2 = kGravity;
    config.filter.error = convention;
    config.smoother.error = convention;
    config.smoother.window = 4;
    const RigCalibration rig;
    const std::unique_ptr<Estimator> filter = MakeFilter(config, rig);
    const std::unique_ptr<Estimator> smoother = MakeSmoother(config, rig);
    const NavEstimate start = RandomStart(&random);
    ASSERT_TRUE(filter->Initialize(start).ok());
    ASSERT_TRUE(smoother->Initialize(start).ok());
    std::vector<ImuSample> samples;
    const Vector3d turn = random.Vector(0.8);
    for (int k = 0; k <= 8 * kSamplesPerFrame; ++k) {
      const Vector3d gyro = turn + random.Vector(0.3);
      samples.push_back({SecondsToNs(k / kImuRateHz), gyro, Vector3d(0, 0, kGravity) + random.Vector(2)});
      for (const std::unique_ptr<Estimator>* estimator : {&filter, &smoother}) {
        ASSERT_TRUE((*estimator)->AddImu(samples.back()).ok());
        if (k % kSamplesPerFrame == 0) {
          TrackFrame frame;
          frame.stamp_ns = samples.back().stamp_ns;
          const Status status = (*estimator)->AddFrame(frame);
          ASSERT_TRUE(status.ok()) << status.message();
        }
      }
      if (k == 0 || k % kSamplesPerFrame != 0) {
        continue;
      }
      NavEstimate carried = start;
      ASSERT_TRUE(PropagateEstimate(samples, rig.imu_noise, GravityInWorld(kGravity), &carried).ok());
      for (const std::unique_ptr<Estimator>* estimator : {&filter, &smoother}) {
        const NavEstimate latest = (*estimator)->Latest();
        SCOPED_TRACE(std::string(ToString(convention)) + (estimator == &filter ? " filter " : " smoother ") +
                     std::to_string(k));
        EXPECT_EQ(latest.stamp_ns, carried.stamp_ns);
        EXPECT_LT(Local(ErrorConvention::kSo3xRn, carried.nav, latest.nav).norm(), 1e-9);
        EXPECT_LT((latest.bias.gyro - carried.bias.gyro).norm(), 1e-9);
        EXPECT_LT((latest.bias.accel - carried.bias.accel).norm(), 1e-9);
        EXPECT_LT(RelativeDifference(latest.covariance, carried.covariance), 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace alidade
