#include "eval/run/imu_axis_watch.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/imu_gap.h"

namespace alidade {
namespace {

constexpr double kMemory = 1000;      // measurements
constexpr double kBeyondRange = 0.5;  // share of the range by which a motion may exceed it

int Other(int axis, int which) {
  return (axis + 1 + which) % 3;
}

}  // namespace

ImuAxisWatch::ImuAxisWatch(const ImpliedImu* implied)
    : implied_(implied),
      signals_{Signal{&ImuSample::gyro, &ImuSample::gyro_fault_density_radps_sqrthz, &ImpliedImu::Gyro,
                      "gyroscope", "rad/s", imu_gap::kMinGyroRadps},
               Signal{&ImuSample::accel, &ImuSample::accel_fault_density_mps2_sqrthz, &ImpliedImu::Accel,
                      "accelerometer", "m/s^2", imu_gap::kMinAccelMps2}} {}

void ImuAxisWatch::CountShare(bool changed, Axis* axis) {
  constexpr double kKept = 1 - 1 / kMemory;
  const double kept = std::pow(kKept, static_cast<double>(axis->equal - 1));
  axis->counted = kKept * (kept * axis->counted + kMemory * (1 - kept)) + 1;
  axis->changed = kKept * kept * axis->changed + (changed ? 1 : 0);
}

bool ImuAxisWatch::OthersMove(const Axis& axis) {
  const double span = std::max(axis.high[0] - axis.low[0], axis.high[1] - axis.low[1]);
  return span >= kSpan * axis.resolution;
}

void ImuAxisWatch::CheckLimit(double value, TimeNs stamp_ns, Axis* axis) {
  if (axis->limit > 0 ? value > axis->limit : value < axis->limit) {
    axis->limit = 0;
  }
  if (axis->limit == 0 || std::abs(value - axis->limit) >= kSteps * axis->resolution) {
    axis->near_limit_since_ns = stamp_ns;
  } else if (SecondsBetween(axis->near_limit_since_ns, stamp_ns) > kConstantS && !OthersMove(*axis)) {
    axis->limit = 0;
    axis->came_from = value;
  }
}

void ImuAxisWatch::Count(const Signal& signal, int index, const ImuSample& last, const ImuSample& sample,
                         Axis* axis) {
  const Eigen::Vector3d& before = last.*signal.value;
  const Eigen::Vector3d& now = sample.*signal.value;
  const double value = now[index];
  const double step = std::abs(value - before[index]);
  const bool others =
      now[Other(index, 0)] != before[Other(index, 0)] || now[Other(index, 1)] != before[Other(index, 1)];
  if (step == 0 && !others) {
    return;
  }
  const bool starts = step > 0 || imu_gap::IsInside(last, sample);
  if (starts) {
    CountShare(step > 0, axis);
    axis->equal = 1;
    axis->since_ns = sample.stamp_ns;
    axis->faulty = false;
    const bool known = axis->recent.size() == kSaturated;
    axis->came_from = known ? axis->recent.front().second : value;
    axis->came_from_s = known ? SecondsBetween(axis->recent.front().first, sample.stamp_ns) : 0;
  } else {
    ++axis->equal;
  }
  if (step > 0) {
    axis->resolution = axis->resolution == 0 ? step : std::min(axis->resolution, step);
  }
  for (int i = 0; i < 2; ++i) {
    const double other = now[Other(index, i)];
    const auto k = static_cast<std::size_t>(i);
    axis->low[k] = starts ? other : std::min(axis->low[k], other);
    axis->high[k] = starts ? other : std::max(axis->high[k], other);
  }
  CheckLimit(value, sample.stamp_ns, axis);
  axis->recent.emplace_back(sample.stamp_ns, value);
  if (axis->recent.size() > kSaturated) {
    axis->recent.pop_front();
  }
  axis->lowest = axis->measured == 0 ? value : std::min(axis->lowest, value);
  axis->highest = axis->measured == 0 ? value : std::max(axis->highest, value);
  ++axis->measured;
  if (axis->equal == 1) {
    const double share = 1 / std::min(kMemory, static_cast<double>(axis->measured));
    axis->mean += share * (value - axis->mean);
    axis->mean_square += share * (value * value - axis->mean_square);
  }
}

bool ImuAxisWatch::IsExtreme(double value, const Axis& axis) {
  return value >= axis.highest || value <= axis.lowest;
}

ImuAxisWatch::Fault ImuAxisWatch::Classify(double value, double floor, const Axis& axis) {
  if (axis.limit != 0 && value == axis.limit) {
    return Fault::kSaturated;
  }
  if (axis.measured < kLeastMeasurements || axis.resolution == 0) {
    return Fault::kNone;
  }
  if (axis.equal >= kSaturated && IsExtreme(value, axis) && std::abs(value) > floor &&
      std::abs(value - axis.came_from) >= kSteps * axis.resolution) {
    return Fault::kSaturated;
  }
  if (2 * axis.changed < axis.counted) {
    return Fault::kNone;
  }
  const double span = std::min(axis.high[0] - axis.low[0], axis.high[1] - axis.low[1]);
  return axis.equal >= kStuck && span >= kSpan * axis.resolution ? Fault::kStuck : Fault::kNone;
}

double ImuAxisWatch::Sigma(Fault fault, double value, double floor, double seconds, const Axis& axis) {
  if (fault == Fault::kStuck) {
    const double replaced = axis.faulty ? axis.mean : value;
    const double square = axis.mean_square - 2 * replaced * axis.mean + replaced * replaced;
    return std::max(floor, std::sqrt(std::max(0.0, square)));
  }
  const double rate = axis.came_from_s > 0 ? std::abs(value - axis.came_from) / axis.came_from_s : 0;
  return std::max(floor, std::min(rate * seconds, kBeyondRange * std::abs(value)));
}

double ImuAxisWatch::Reading(Fault fault, double value, const Axis& axis,
                             std::optional<double> implied) const {
  if (fault == Fault::kStuck) {
    return implied.value_or(axis.mean);
  }
  return value * std::max(1.0, implied.value_or(value) / value);
}

std::string ImuAxisWatch::AddAxis(const ImuSample& last, const ImuSample& measured, int index, Signal* signal,
                                  ImuSample* sample) {
  Axis& axis = signal->axes[static_cast<std::size_t>(index)];
  Count(*signal, index, last, measured, &axis);
  const double value = (measured.*signal->value)[index];
  const Fault fault = Classify(value, signal->floor, axis);
  if (fault == Fault::kNone) {
    return {};
  }
  const double seconds = SecondsBetween(axis.since_ns, sample->stamp_ns);
  const double step_s = SecondsBetween(last.stamp_ns, sample->stamp_ns);
  const double sigma = Sigma(fault, value, signal->floor, seconds, axis);
  const double density = axis.faulty ? sigma * std::sqrt(2 * std::min(seconds, kConstantS))
                                     : sigma * seconds / std::sqrt(step_s);
  axis.faulty = true;
  const std::optional<double> implied =
      implied_ != nullptr ? (implied_->*signal->implied)(index, sample->stamp_ns) : std::nullopt;
  (sample->*signal->value)[index] = Reading(fault, value, axis, implied);
  axis.limit = fault == Fault::kSaturated ? value : axis.limit;
  Eigen::Vector3d axes = Eigen::Vector3d::Unit(index);
  if (fault == Fault::kSaturated || IsExtreme(value, axis)) {
    axes.setOnes();
  }
  Eigen::Vector3d& densities = sample->*signal->fault_density;
  densities = (densities.cwiseAbs2() + density * density * axes).cwiseSqrt();
  reason_ = Format(fault == Fault::kSaturated ? "the %s's %c axis is saturated at %.4g %s"
                                              : "the %s's %c axis repeats %.4g %s while the others change",
                   signal->name, "xyz"[index], value, signal -> unit);
  const bool reported = sample->stamp_ns <= axis.reported_until_ns;
  axis.reported_until_ns = sample->stamp_ns + SecondsToNs(kSameFaultS);
  return reported ? std::string() : reason_ + " from " + FormatSeconds(axis.since_ns) + " s on";
}

std::string ImuAxisWatch::Add(ImuSample* sample) {
  std::string reported;
  const ImuSample measured = *sample;
  reason_.clear();
  if (any_) {
    for (Signal& signal : signals_) {
      for (int index = 0; index < 3; ++index) {
        const std::string one = AddAxis(last_, measured, index, &signal, sample);
        reported += one.empty() || reported.empty() ? one : "; " + one;
      }
    }
  }
  any_ = true;
  last_ = measured;
  return reported;
}

}  // namespace alidade
