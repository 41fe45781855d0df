#include "core/imu_step.h"

#include "core/imu_gap.h"
#include "core/lie.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// Second derivative of the parabola through three samples: the difference of the slopes after and before the
/// middle one, over half the distance of the outer ones.
struct Curvature {
  Vector3d gyro = Vector3d::Zero();
  Vector3d accel = Vector3d::Zero();

  Curvature() = default;
  Curvature(const ImuSample& a, const ImuSample& b, const ImuSample& c) {
    const double first_s = SecondsBetween(a.stamp_ns, b.stamp_ns);
    const double second_s = SecondsBetween(b.stamp_ns, c.stamp_ns);
    const double half_s = 0.5 * (first_s + second_s);
    gyro = ((c.gyro - b.gyro) / second_s - (b.gyro - a.gyro) / first_s) / half_s;
    accel = ((c.accel - b.accel) / second_s - (b.accel - a.accel) / first_s) / half_s;
  }
};

/// Mean of the curvatures that the samples around a step show; zero in or beside a silence.
Curvature MeanCurvature(std::span<const ImuSample> samples, size_t k) {
  Curvature mean;
  if (imu_gap::IsInside(samples[k], samples[k + 1])) {
    return mean;
  }
  int count = 0;
  const auto add = [&](size_t first) {
    const Curvature part(samples[first], samples[first + 1], samples[first + 2]);
    mean.gyro += part.gyro;
    mean.accel += part.accel;
    ++count;
  };
  if (k > 0 && !imu_gap::IsInside(samples[k - 1], samples[k])) {
    add(k - 1);
  }
  if (k + 2 < samples.size() && !imu_gap::IsInside(samples[k + 1], samples[k + 2])) {
    add(k);
  }
  if (count > 1) {
    mean.gyro /= count;
    mean.accel /= count;
  }
  return mean;
}

}  // namespace

StepMean MeanOverStep(std::span<const ImuSample> samples, size_t k, const ImuBias& bias) {
  const ImuSample& from = samples[k];
  const ImuSample& to = samples[k + 1];
  const double dt_s = SecondsBetween(from.stamp_ns, to.stamp_ns);
  const Curvature curvature = MeanCurvature(samples, k);
  const Vector3d gyro = 0.5 * (from.gyro + to.gyro) - bias.gyro - dt_s * dt_s / 12 * curvature.gyro;
  const Vector3d accel = 0.5 * (from.accel + to.accel) - bias.accel - dt_s * dt_s / 12 * curvature.accel;
  const Vector3d gyro_change = to.gyro - from.gyro;
  const Vector3d accel_change = to.accel - from.accel;
  // w_k x w_{k+1} = w x (w_{k+1} - w_k), with w the mean of the two.
  const Matrix3d turned = Matrix3d::Identity() - dt_s / 12 * Skew(gyro_change);
  const Matrix3d swayed = -dt_s / 12 * Skew(accel_change);
  return {turned * gyro, turned * accel + swayed * gyro, turned, swayed};
}

ImuSample OntoParabola(const ImuSample& before, const ImuSample& from, const ImuSample& to,
                       const ImuSample& on_line) {
  ImuSample sample = on_line;
  if (!imu_gap::IsInside(before, from) && !imu_gap::IsInside(from, to)) {
    const Curvature curvature(before, from, to);
    const double bow =
        0.5 * SecondsBetween(from.stamp_ns, sample.stamp_ns) * SecondsBetween(sample.stamp_ns, to.stamp_ns);
    sample.gyro -= bow * curvature.gyro;
    sample.accel -= bow * curvature.accel;
  }
  return sample;
}

}  // namespace alidade
