#include "eval/run/imu_guard.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/numbers.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr double kRatio = 10;
constexpr double kUnconfirmedRatio = 25;
constexpr double kUnconfirmedFloor = 10;  // of the floor
constexpr int kMemorySamples = 100;
constexpr double kMaxStepS = 0.05;
constexpr double kKnownRatio = 10;     // of a rate that reveals a unit to the root mean square of the steps
constexpr double kContinuesRatio = 4;  // of a step to that

bool AreNeighbours(const ImuSample& a, const ImuSample& b) {
  return SecondsBetween(a.stamp_ns, b.stamp_ns) <= kMaxStepS;
}

}  // namespace

bool ImuGuard::IsSpike(const Signal& signal, const Vector3d& before, const Vector3d& here,
                       const Vector3d* after) const {
  const double rms = std::sqrt(signal.mean_square);
  const double step = (here - before).norm();
  if (after == nullptr) {
    return !signal.held && step > std::max(kUnconfirmedFloor * signal.floor, kUnconfirmedRatio * rms);
  }
  // The root mean square of few samples is uncertain.
  const double floor = (judged_ < kMemorySamples ? kUnconfirmedFloor : 1) * signal.floor;
  const double least = std::min(step, (here - *after).norm());
  return least > std::max(floor, kRatio * rms) && (*after - before).norm() < 0.5 * least;
}

void ImuGuard::MendSignal(const Vector3d& before, const Vector3d* after, const char* name, const char* unit,
                          Vector3d* here, Signal* signal, std::string* fault) {
  const bool spike = IsSpike(*signal, before, *here, after);
  if (spike) {
    *fault = Format("%s jumps by %.3g %s in one sample", name, (*here - before).norm(), unit);
    *here = after != nullptr ? Vector3d(0.5 * (before + *after)) : before;
  }
  signal->held = spike && after == nullptr;
  signal->mean_square += ((*here - before).squaredNorm() - signal->mean_square) / kMemorySamples;
}

std::string ImuGuard::MendUnit(const ImuSample* next, ImuSample* sample) {
  std::string fault;
  const double rms = std::sqrt(gyro_.mean_square);
  if (last_ && judged_ >= kMemorySamples && last_->gyro.norm() > kKnownRatio * rms &&
      AreNeighbours(*last_, *sample) && (next == nullptr || AreNeighbours(*sample, *next))) {
    const auto continues = [&](const Vector3d& before, const Vector3d& gyro, double unit) {
      return (gyro / unit - before).norm() <= kContinuesRatio * rms;
    };
    const double other = unit_ == 1 ? kDegreesPerRadian : 1;
    const double jump = (sample->gyro / unit_ - last_->gyro).norm();
    // In rad/s the same jump is smaller by the ratio of the units.
    const double least = kUnconfirmedFloor * gyro_.floor / unit_;
    if (jump > std::max(least, kRatio * rms) && continues(last_->gyro, sample->gyro, other) &&
        (next == nullptr || continues(sample->gyro / other, next->gyro, other))) {
      unit_ = other;
      unit_changed_ns_ = sample->stamp_ns;
      fault = unit_ == 1 ? "the gyroscope is in rad/s again"
                         : "the gyroscope's rates are 57.3 times those before: in deg/s from here on";
    }
  }
  if (unit_ != 1) {
    sample->gyro = InRadians(sample->gyro);
  }
  return fault;
}

std::string ImuGuard::Mend(const ImuSample* next, ImuSample* sample) {
  std::string fault = MendUnit(next, sample);
  std::optional<ImuSample> after;
  if (next != nullptr) {
    after = *next;
    after->gyro = InRadians(next->gyro);
  }
  const bool judged = last_ && AreNeighbours(*last_, *sample) && (!after || AreNeighbours(*sample, *after));
  if (judged) {
    MendSignal(last_->gyro, after ? &after->gyro : nullptr, "gyroscope", "rad/s", &sample->gyro, &gyro_,
               &fault);
    MendSignal(last_->accel, after ? &after->accel : nullptr, "accelerometer", "m/s^2", &sample->accel,
               &accel_, &fault);
    ++judged_;
  }
  if (const std::string axis = axes_.Add(sample); !axis.empty()) {
    fault += (fault.empty() ? "" : "; ") + axis;
  }
  last_ = *sample;
  return fault;
}

}  // namespace alidade
