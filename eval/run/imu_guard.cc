#include "eval/run/imu_guard.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr double kRatio = 10;
constexpr double kUnconfirmedRatio = 25;
constexpr double kUnconfirmedFloor = 10;  // of the floor
constexpr int kMemorySamples = 100;
constexpr double kMaxStepS = 0.05;

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
  // The root mean square of few samples says little.
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

std::string ImuGuard::Mend(const ImuSample* next, ImuSample* sample) {
  std::string fault;
  const bool judged =
      last_ && AreNeighbours(*last_, *sample) && (next == nullptr || AreNeighbours(*sample, *next));
  if (judged) {
    MendSignal(last_->gyro, next != nullptr ? &next->gyro : nullptr, "gyroscope", "rad/s", &sample->gyro,
               &gyro_, &fault);
    MendSignal(last_->accel, next != nullptr ? &next->accel : nullptr, "accelerometer", "m/s^2",
               &sample->accel, &accel_, &fault);
    ++judged_;
  }
  last_ = *sample;
  return fault;
}

}  // namespace alidade
