#include "core/imu_step.h"

#include "core/imu_gap.h"
#include "core/lie.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

// Largest ratio r of a step to the one before. The oldest sample has the weight r^2 / (6 (1 + r)) in the mean
// over the step.
constexpr double kMaxExtension = 2;

}  // namespace

void SetCurvature(const ImuSample& first, const ImuSample& second, ImuSample* last) {
  const double before_s = SecondsBetween(first.stamp_ns, second.stamp_ns);
  const double after_s = SecondsBetween(second.stamp_ns, last->stamp_ns);
  if (imu_gap::IsInside(first, second) || imu_gap::IsInside(second, *last) ||
      after_s > kMaxExtension * before_s) {
    last->gyro_curvature.setZero();
    last->accel_curvature.setZero();
    return;
  }
  const double half_s = 0.5 * (before_s + after_s);
  last->gyro_curvature =
      ((last->gyro - second.gyro) / after_s - (second.gyro - first.gyro) / before_s) / half_s;
  last->accel_curvature =
      ((last->accel - second.accel) / after_s - (second.accel - first.accel) / before_s) / half_s;
}

void SetCurvatures(std::span<ImuSample> samples) {
  for (size_t i = 2; i < samples.size(); ++i) {
    SetCurvature(samples[i - 2], samples[i - 1], &samples[i]);
  }
}

Vector6d ParabolaMean(const ImuSample& from, const ImuSample& to, const ImuBias& bias) {
  const double dt_s = SecondsBetween(from.stamp_ns, to.stamp_ns);
  const double bow = dt_s * dt_s / 12;
  Vector6d mean;
  mean << 0.5 * (from.gyro + to.gyro) - bias.gyro - bow * to.gyro_curvature,
      0.5 * (from.accel + to.accel) - bias.accel - bow * to.accel_curvature;
  return mean;
}

StepMean MeanOverStep(const ImuSample& from, const ImuSample& to, const ImuBias& bias) {
  const double dt_s = SecondsBetween(from.stamp_ns, to.stamp_ns);
  const Vector6d mean = ParabolaMean(from, to, bias);
  const Vector3d gyro = mean.head<3>();
  const Vector3d accel = mean.tail<3>();
  if (imu_gap::IsInside(from, to)) {
    return {gyro, accel, Matrix3d::Identity(), Matrix3d::Zero()};
  }
  // w_k x w_{k+1} = w x (w_{k+1} - w_k), with w the mean of the two.
  const Matrix3d turned = Matrix3d::Identity() - dt_s / 12 * Skew(to.gyro - from.gyro);
  const Matrix3d swayed = -dt_s / 12 * Skew(to.accel - from.accel);
  return {turned * gyro, turned * accel + swayed * gyro, turned, swayed};
}

}  // namespace alidade
