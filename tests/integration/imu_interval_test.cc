#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "core/imu_buffer.h"
#include "core/imu_propagation.h"
#include "core/position_fix.h"
#include "filter/filter.h"
#include "smoother/manifold/nav_state_manifold.h"
#include "smoother/sliding/smoother.h"
#include "tests/smoother/solve/given_terms.h"
#include "tests/support/estimate_difference.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

// The filter and the smoother carry a state over the IMU by the same model.

namespace alidade {
namespace {

using Eigen::Vector3d;
using test::RelativeDifference;

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

using Estimators = std::array<std::unique_ptr<Estimator>, 2>;

Estimators MakeBoth(const EstimatorConfig& config, const RigCalibration& rig) {
  return {MakeFilter(config, rig), MakeSmoother(config, rig)};
}

TrackFrame EmptyFrame(TimeNs stamp_ns) {
  TrackFrame frame;
  frame.stamp_ns = stamp_ns;
  return frame;
}

// GIVEN equal starts and IMU samples WHEN no camera or GNSS adds anything, over more frames than the smoother
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
    const Estimators estimators = MakeBoth(config, rig);
    const NavEstimate start = RandomStart(&random);
    for (const std::unique_ptr<Estimator>& estimator : estimators) {
      ASSERT_TRUE(estimator->Initialize(start).ok());
    }
    ImuBuffer buffer(config.imu.max_gap_s);
    const Vector3d turn = random.Vector(0.8);
    for (int k = 0; k <= 8 * kSamplesPerFrame; ++k) {
      const Vector3d gyro = turn + random.Vector(0.3);
      const ImuSample sample{SecondsToNs(k / kImuRateHz), gyro, Vector3d(0, 0, kGravity) + random.Vector(2)};
      ASSERT_TRUE(buffer.Add(sample).ok());
      for (const std::unique_ptr<Estimator>& estimator : estimators) {
        ASSERT_TRUE(estimator->AddImu(sample).ok());
        if (k % kSamplesPerFrame == 0) {
          const Status status = estimator->AddFrame(EmptyFrame(sample.stamp_ns));
          ASSERT_TRUE(status.ok()) << status.message();
        }
      }
      if (k == 0 || k % kSamplesPerFrame != 0) {
        continue;
      }
      NavEstimate carried = start;
      std::vector<ImuSample> interval;
      ASSERT_TRUE(buffer.Interval(start.stamp_ns, sample.stamp_ns, &interval).ok());
      ASSERT_TRUE(PropagateEstimate(interval, rig.imu_noise, GravityInWorld(kGravity), &carried).ok());
      for (const std::unique_ptr<Estimator>& estimator : estimators) {
        const NavEstimate latest = estimator->Latest();
        SCOPED_TRACE(std::string(ToString(convention)) +
                     (estimator == estimators[0] ? " filter " : " smoother ") + std::to_string(k));
        EXPECT_EQ(latest.stamp_ns, carried.stamp_ns);
        EXPECT_LT(Local(ErrorConvention::kSo3xRn, carried.nav, latest.nav).norm(), 1e-9);
        EXPECT_LT((latest.bias.gyro - carried.bias.gyro).norm(), 1e-9);
        EXPECT_LT((latest.bias.accel - carried.bias.accel).norm(), 1e-9);
        EXPECT_LT(RelativeDifference(latest.covariance, carried.covariance), 1e-9);
      }
    }
  }
}

// GIVEN imu.noise: adaptive WHEN the samples vibrate, THEN both back ends have the same covariance, larger
// than that of the sheet, and after the vibration both add the sheet's noise again.
TEST(ImuIntervalTest, FilterAndSmootherTakeVibrationAlike) {
  test::RandomStates random(12);
  EstimatorConfig config;
  config.imu.gravity_mps2 = kGravity;
  EstimatorConfig adaptive = config;
  adaptive.imu.noise = ImuNoiseModel::kAdaptive;
  const RigCalibration rig;
  const Estimators fixed = MakeBoth(config, rig);
  const Estimators both = MakeBoth(adaptive, rig);
  const NavEstimate start = RandomStart(&random);
  std::array<double, 2> velocity_variance = {};  // of the sheet, adaptive: while it vibrates
  for (const auto* estimators : {&fixed, &both}) {
    for (const std::unique_ptr<Estimator>& estimator : *estimators) {
      ASSERT_TRUE(estimator->Initialize(start).ok());
    }
  }
  for (int k = 0; k <= 4 * kSamplesPerFrame; ++k) {
    const double size = k <= 2 * kSamplesPerFrame ? 20 : 0;
    const ImuSample sample{SecondsToNs(k / kImuRateHz), Vector3d(0.1, 0.2, 0),
                           Vector3d(0, 0, kGravity) + random.Vector(1) * size};
    for (const auto* estimators : {&fixed, &both}) {
      for (const std::unique_ptr<Estimator>& estimator : *estimators) {
        ASSERT_TRUE(estimator->AddImu(sample).ok());
        if (k % kSamplesPerFrame == 0) {
          ASSERT_TRUE(estimator->AddFrame(EmptyFrame(sample.stamp_ns)).ok());
        }
      }
    }
    if (k > 0 && k % kSamplesPerFrame == 0) {
      EXPECT_LT(RelativeDifference(both[1]->Latest().covariance, both[0]->Latest().covariance), 1e-9);
    }
    if (k == 2 * kSamplesPerFrame) {
      velocity_variance = {fixed[0]->Latest().covariance(8, 8), both[0]->Latest().covariance(8, 8)};
      EXPECT_GT(velocity_variance[1], 1.001 * velocity_variance[0]);
    }
  }
  EXPECT_NEAR(both[0]->Latest().covariance(8, 8) - velocity_variance[1],
              fixed[0]->Latest().covariance(8, 8) - velocity_variance[0],
              0.2 * (velocity_variance[1] - velocity_variance[0]));
}

// GIVEN a prior at a frame and the smoother's rows of the IMU up to the next WHEN the first frame is
// eliminated by QR, THEN the covariance left is that of the filter, in every error convention.
TEST(ImuIntervalTest, RowsOfTheSmootherHoldTheCovarianceOfTheFilter) {
  for (const ErrorConvention convention : test::kAllConventions) {
    test::RandomStates random(14);
    EstimatorConfig config;
    config.imu.gravity_mps2 = kGravity;
    config.filter.error = convention;
    const RigCalibration rig;
    const NavEstimate start = RandomStart(&random);
    WindowFrame first;
    WindowFrame second;
    const std::unique_ptr<Estimator> filter = MakeFilter(config, rig);
    ASSERT_TRUE(filter->Initialize(start).ok());
    ImuBuffer buffer(config.imu.max_gap_s);
    for (int k = 0; k <= kSamplesPerFrame; ++k) {
      const ImuSample sample{SecondsToNs(k / kImuRateHz), random.Vector(1),
                             Vector3d(0, 0, kGravity) + random.Vector(2)};
      ASSERT_TRUE(buffer.Add(sample).ok());
      ASSERT_TRUE(filter->AddImu(sample).ok());
    }
    ASSERT_TRUE(buffer.Interval(0, SecondsToNs(kSamplesPerFrame / kImuRateHz), &second.imu).ok());
    ASSERT_TRUE(filter->AddFrame(EmptyFrame(second.imu.back().stamp_ns)).ok());
    const NavEstimate end = filter->Latest();
    PackNavState(start.nav, first.nav.data());
    PackBias(start.bias, first.bias.data());
    PackNavState(end.nav, second.nav.data());
    PackBias(end.bias, second.bias.data());
    UpdatePreintegration(first, rig.imu_noise, &second);
    const test::ImuRows rows = test::LinearizeImu(first, second, GravityInWorld(kGravity));
    EXPECT_LT(rows.residual.norm(), 1e-6) << "in standard deviations";
    const Matrix15d chart = ImuChartJacobian(convention, start.nav);
    const Matrix15d chart_end = ImuChartJacobian(convention, end.nav);
    Eigen::Matrix<double, 30, 30> stacked = Eigen::Matrix<double, 30, 30>::Zero();
    stacked.topLeftCorner<15, 15>() = start.covariance.llt().matrixL().solve(chart);
    stacked.bottomLeftCorner<15, 15>() = rows.first * chart;
    stacked.bottomRightCorner<15, 15>() = rows.second * chart_end;
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(stacked);
    const Matrix15d root_information =
        qr.matrixQR().bottomRightCorner<15, 15>().triangularView<Eigen::Upper>();
    const Matrix15d root = chart_end * root_information.inverse();
    EXPECT_LT(RelativeDifference(root * root.transpose(), end.covariance), 1e-9) << ToString(convention);
  }
}

// GIVEN a fix as late after its frame as the smoother attaches one, as precise as a fix can be, THEN the IMU
// noise that the smoother neglects is less than a hundredth of the filter's innovation covariance.
TEST(ImuIntervalTest, TheNoiseUpToAnAttachedFixIsSmall) {
  const FixConfig config;
  const Vector3d p_BA(0.5, -0.3, 1);
  const RigCalibration rig;
  test::RandomStates random(15);
  std::vector<ImuSample> samples;
  const int last = static_cast<int>(std::lround(config.max_interpolation_s * kImuRateHz));
  for (int k = 0; k <= last; ++k) {
    samples.push_back(
        {SecondsToNs(k / kImuRateHz), random.Vector(1), Vector3d(0, 0, kGravity) + random.Vector(2)});
  }
  NavEstimate carried = RandomStart(&random);
  carried.covariance.setZero();  // any other makes the share smaller
  PositionFix fix;
  fix.covariance = 1e-12 * Eigen::Matrix3d::Identity();
  const Result<FixMeasurement> measured = MakeFixMeasurement(config, p_BA, fix);
  ASSERT_TRUE(measured.ok()) << measured.message();
  ASSERT_TRUE(PropagateEstimate(samples, rig.imu_noise, GravityInWorld(kGravity), &carried).ok());
  FixMeasurement::Residual whitened;
  FixMeasurement::Jacobian jacobian;
  measured->Evaluate(carried.nav, &whitened, &jacobian);
  const Eigen::Matrix3d neglected = jacobian * carried.covariance * jacobian.transpose();
  const double share = neglected.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff();
  EXPECT_LT(share, 0.01) << "of the fix's own covariance, and so of the innovation's";
  EXPECT_GT(share, 1e-6) << "there is something to neglect";
}

// GIVEN one sample that no sensor measures among good ones, THEN both back ends refuse it and go on.
TEST(ImuIntervalTest, ASampleBeyondAnySensorIsRefused) {
  const Vector3d gravity(0, 0, kGravity);
  for (const ImuSample& hostile : {ImuSample{SecondsToNs(0.04), Vector3d::Zero(), Vector3d(1e200, 0, 0)},
                                   ImuSample{SecondsToNs(0.04), Vector3d(0, 1e7, 0), gravity}}) {
    for (const std::unique_ptr<Estimator>& estimator : MakeBoth(EstimatorConfig(), RigCalibration())) {
      test::RandomStates random(12);
      NavEstimate start = RandomStart(&random);
      start.nav = NavState();
      start.bias = ImuBias();
      ASSERT_TRUE(estimator->Initialize(start).ok());
      for (int k = 0; k <= kSamplesPerFrame; ++k) {
        const TimeNs stamp_ns = SecondsToNs(k / kImuRateHz);
        const bool bad = stamp_ns == hostile.stamp_ns;
        EXPECT_EQ(estimator->AddImu(bad ? hostile : ImuSample{stamp_ns, Vector3d::Zero(), gravity}).code(),
                  bad ? StatusCode::kInput : StatusCode::kOk);
      }
      EXPECT_TRUE(estimator->AddFrame(EmptyFrame(SecondsToNs(0.1))).ok());
      EXPECT_LT(estimator->Latest().nav.p_WB.norm(), 0.01);
    }
  }
}

// GIVEN numbers that overflow in the integration, THEN both back ends are diverged, by Status.
TEST(ImuIntervalTest, AnIntervalThatOverflowsIsADivergedStatus) {
  for (const bool by_noise : {true, false}) {
    RigCalibration rig;
    rig.imu_noise.gyro_noise_density_radps_sqrthz = by_noise ? 1e300 : 1e-3;
    for (const std::unique_ptr<Estimator>& estimator : MakeBoth(EstimatorConfig(), rig)) {
      test::RandomStates random(13);
      NavEstimate start = RandomStart(&random);
      start.bias.accel.y() = by_noise ? 0 : 1e200;
      ASSERT_TRUE(estimator->Initialize(start).ok());
      Status status;
      for (int k = 0; k <= 2 * kSamplesPerFrame; ++k) {
        const TimeNs stamp_ns = SecondsToNs(k / kImuRateHz);
        ASSERT_TRUE(estimator->AddImu({stamp_ns, Vector3d::Zero(), Vector3d(0, 0, kGravity)}).ok());
        if (k % kSamplesPerFrame == 0 && status.ok()) {
          status = estimator->AddFrame(EmptyFrame(stamp_ns));
        }
      }
      EXPECT_EQ(status.code(), StatusCode::kDiverged) << status.message();
      EXPECT_FALSE(estimator->initialized());
    }
  }
}

}  // namespace
}  // namespace alidade
