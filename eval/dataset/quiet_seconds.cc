#include "eval/dataset/quiet_seconds.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"

namespace alidade {
namespace {

constexpr double kWindowS = 1;
constexpr double kLeastSamples = 10;
/// A bias of a consumer gyroscope at most, 3 deg/s, twice [rad/s].
constexpr double kMostBias = 0.1;

/// Of three axes, root mean square.
double Spread(const Eigen::Vector3d& square, double samples) {
  return std::sqrt(square.sum() / (3 * samples));
}

void Lower(double value, std::optional<double>* least) {
  *least = std::min(least->value_or(value), value);
}

}  // namespace

void QuietSeconds::Add(const ImuSample& sample) {
  if (samples_ > 0 && SecondsBetween(first_ns_, sample.stamp_ns) >= kWindowS) {
    Close();
  }
  if (samples_ == 0) {
    first_ns_ = sample.stamp_ns;
  }
  Vector6d values;
  values << sample.gyro, sample.accel;
  samples_ += 1;
  const Vector6d before = values - mean_;
  mean_ += before / samples_;
  square_ += before.cwiseProduct(values - mean_);
}

void QuietSeconds::Close() {
  constexpr double kLeastOfDensity = 50;
  const double gyro = Spread(square_.head<3>(), samples_);
  const double accel = Spread(square_.tail<3>(), samples_);
  const double root_period_s = std::sqrt(kWindowS / samples_);
  if (samples_ >= kLeastOfDensity && square_.head<3>().minCoeff() > 0) {
    Lower(gyro * root_period_s, &gyro_density_);
  }
  if (samples_ >= kLeastOfDensity && square_.tail<3>().minCoeff() > 0) {
    Lower(accel * root_period_s, &accel_density_);
  }
  judged_ += samples_ >= kLeastSamples ? 1 : 0;
  if (samples_ >= kLeastSamples && gyro < init_.static_max_gyro_std_radps &&
      accel < init_.static_max_accel_std_mps2 && mean_.head<3>().norm() < kMostBias) {
    forces_.push_back(mean_.tail<3>().norm());
  }
  samples_ = 0;
  mean_.setZero();
  square_.setZero();
}

std::optional<double> QuietSeconds::SpecificForce() const {
  constexpr std::size_t kLeastSeconds = 3;
  return forces_.size() < kLeastSeconds ? std::nullopt : std::optional(Median(forces_));
}

}  // namespace alidade
