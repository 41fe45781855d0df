#include "eval/simulation/gyro_agreement.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/dense_solvers.h"

namespace alidade {
namespace {

constexpr std::size_t kMinSamples = 100;
constexpr std::size_t kMaxSamples = 5000;
constexpr int kIterations = 4;
constexpr double kDifferenceSeconds = 1e-3;

std::vector<ImuSample> PickSamples(double duration_s, TimeNs start_ns, std::span<const ImuSample> imu) {
  std::vector<ImuSample> inside;
  for (const ImuSample& sample : imu) {
    const double time_s = SecondsBetween(start_ns, sample.stamp_ns);
    if (time_s >= 0 && time_s <= duration_s) {
      inside.push_back(sample);
    }
  }
  const std::size_t stride = inside.size() / kMaxSamples + 1;
  std::vector<ImuSample> picked;
  for (std::size_t k = 0; k < inside.size(); k += stride) {
    picked.push_back(inside[k]);
  }
  return picked;
}

class GyroFit {
 public:
  GyroFit(const ContinuousTrajectory& motion, TimeNs start_ns, const std::vector<ImuSample>& imu)
      : motion_(motion), start_ns_(start_ns), imu_(imu) {}

  GyroAgreement Solve() {
    agreement_.samples = static_cast<int>(imu_.size());
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      Step();
    }
    Measure();
    return agreement_;
  }

 private:
  [[nodiscard]] Eigen::Vector3d RateAt(const ImuSample& sample, double shift_s) const {
    return motion_.At(SecondsBetween(start_ns_, sample.stamp_ns) + agreement_.time_offset_s + shift_s)
        .angular_rate_B;
  }

  /// One Gauss-Newton step over (bias, offset).
  void Step() {
    Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
    Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
    for (const ImuSample& sample : imu_) {
      const Eigen::Vector3d residual = sample.gyro - RateAt(sample, 0) - agreement_.bias;
      Eigen::Matrix<double, 3, 4> jacobian;
      jacobian.leftCols<3>().setIdentity();
      jacobian.col(3) = (RateAt(sample, kDifferenceSeconds) - RateAt(sample, -kDifferenceSeconds)) /
                        (2 * kDifferenceSeconds);
      information += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * residual;
    }
    // A body at rest does not determine the offset: the faint prior (1 s for a rate of 1 rad/s) keeps it at
    // 0.
    information(3, 3) += 1;
    gradient(3) -= agreement_.time_offset_s;
    const Eigen::Vector4d step = SymmetricSolver(information).Solve(gradient);
    agreement_.bias += step.head<3>();
    agreement_.time_offset_s = std::clamp(agreement_.time_offset_s + step(3), -0.4, 0.4);
  }

  void Measure() {
    const double count = static_cast<double>(imu_.size());
    Eigen::Vector3d mean_motion = Eigen::Vector3d::Zero();
    Eigen::Vector3d mean_gyro = Eigen::Vector3d::Zero();
    for (const ImuSample& sample : imu_) {
      mean_motion += RateAt(sample, 0) / count;
      mean_gyro += sample.gyro / count;
    }
    double motion2 = 0;
    double gyro2 = 0;
    double product = 0;
    double residual2 = 0;
    for (const ImuSample& sample : imu_) {
      const Eigen::Vector3d rate = RateAt(sample, 0) - mean_motion;
      const Eigen::Vector3d gyro = sample.gyro - mean_gyro;
      motion2 += rate.squaredNorm();
      gyro2 += gyro.squaredNorm();
      product += rate.dot(gyro);
      residual2 += (gyro - rate).squaredNorm();
    }
    agreement_.motion_rms_radps = std::sqrt(motion2 / (3 * count));
    agreement_.residual_rms_radps = std::sqrt(residual2 / (3 * count));
    agreement_.correlation = motion2 > 0 && gyro2 > 0 ? product / std::sqrt(motion2 * gyro2) : 0;
  }

  const ContinuousTrajectory& motion_;
  TimeNs start_ns_;
  const std::vector<ImuSample>& imu_;
  GyroAgreement agreement_;
};

}  // namespace

Result<GyroAgreement> CompareGyro(const ContinuousTrajectory& motion, TimeNs start_ns,
                                  std::span<const ImuSample> imu) {
  const std::vector<ImuSample> picked = PickSamples(motion.DurationSeconds(), start_ns, imu);
  if (picked.size() < kMinSamples) {
    return Status::Input(std::to_string(picked.size()) +
                         " IMU samples within the recorded motion; expected " + std::to_string(kMinSamples) +
                         " or more");
  }
  return GyroFit(motion, start_ns, picked).Solve();
}

}  // namespace alidade
