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

/// Of ImuAxisWatch::Axis::limits.
std::size_t Side(double value) {
  return value > 0 ? 1 : 0;
}

}  // namespace

ImuAxisWatch::ImuAxisWatch(const ImpliedImu* implied)
    : implied_(implied),
      signals_{Signal{&ImuSample::gyro, &ImuSample::gyro_fault_density_radps_sqrthz, &ImpliedImu::Gyro,
                      "gyroscope", "rad/s", imu_gap::kMinGyroRadps},
               Signal{&ImuSample::accel, &ImuSample::accel_fault_density_mps2_sqrthz, &ImpliedImu::Accel,
                      "accelerometer", "m/s^2", imu_gap::kMinAccelMps2}} {}

void ImuAxisWatch::Begin(const ImuSample& sample, const Signal& other, Signal* signal) {
  signal->held.Restart(sample.stamp_ns, sample.*other.value);
  const Eigen::Vector3d& now = sample.*signal->value;
  for (int index = 0; index < 3; ++index) {
    Axis& axis = signal->axes[static_cast<std::size_t>(index)];
    axis.since_ns = sample.stamp_ns;
    axis.low = axis.high = {now[Other(index, 0)], now[Other(index, 1)]};
    axis.lowest = axis.highest = axis.mean = now[index];
    axis.mean_square = now[index] * now[index];
    axis.measured = 1;
    axis.recent.emplace_back(sample.stamp_ns, now[index]);
  }
}

void ImuAxisWatch::CountShare(bool changed, Axis* axis) {
  constexpr double kKept = 1 - 1 / kMemory;
  const double kept = std::pow(kKept, static_cast<double>(axis->equal - 1));
  axis->counted = kKept * (kept * axis->counted + kMemory * (1 - kept)) + 1;
  axis->changed = kKept * kept * axis->changed + (changed ? 1 : 0);
}

bool ImuAxisWatch::OthersMove(const Axis& axis, double resolution) {
  const double span = std::max(axis.high[0] - axis.low[0], axis.high[1] - axis.low[1]);
  return resolution > 0 && span >= kSpan * resolution;
}

void ImuAxisWatch::CheckLimits(double value, TimeNs stamp_ns, Axis* axis) {
  for (std::optional<Level>& limit : axis->limits) {
    if (!limit) {
      continue;
    }
    const double inside = limit->value > 0 ? limit->value - value : value - limit->value;
    if (inside < 0) {
      limit.reset();
    } else if (inside >= kSteps * axis->resolution) {
      limit->since_ns = stamp_ns;
    } else if (SecondsBetween(limit->since_ns, stamp_ns) > kConstantS &&
               !OthersMove(*axis, axis->resolution)) {
      limit.reset();
      axis->came_from = value;
    }
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
    axis->came_from = value;
    axis->came_from_s = 0;
    for (const auto& [stamp_ns, recent] : axis->recent) {
      if (axis->recent.size() == kSaturated && std::abs(value - recent) > std::abs(value - axis->came_from)) {
        axis->came_from = recent;
        axis->came_from_s = SecondsBetween(stamp_ns, sample.stamp_ns);
      }
    }
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
  CheckLimits(value, sample.stamp_ns, axis);
  axis->recent.emplace_back(sample.stamp_ns, value);
  if (axis->recent.size() > kSaturated) {
    axis->recent.pop_front();
  }
  axis->lowest = std::min(axis->lowest, value);
  axis->highest = std::max(axis->highest, value);
  ++axis->measured;
  if (axis->equal == 1) {
    const double share = 1 / std::min(kMemory, static_cast<double>(axis->measured));
    axis->mean += share * (value - axis->mean);
    axis->mean_square += share * (value * value - axis->mean_square);
  }
}

bool ImuAxisWatch::IsRestless(const Axis& axis) {
  return 2 * axis.changed >= axis.counted;
}

bool ImuAxisWatch::IsExtreme(double value, const Axis& axis) {
  return value >= axis.highest || value <= axis.lowest;
}

double ImuAxisWatch::Resolution(const Signal& signal, int index) {
  const double own = signal.axes[static_cast<std::size_t>(index)].resolution;
  if (own > 0) {
    return own;
  }
  const double first = signal.axes[static_cast<std::size_t>(Other(index, 0))].resolution;
  const double second = signal.axes[static_cast<std::size_t>(Other(index, 1))].resolution;
  return first > 0 && second > 0 ? std::min(first, second) : std::max(first, second);
}

int ImuAxisWatch::StuckRun(const Axis& axis) {
  constexpr double kChance = 1e-10;
  const double share = (axis.counted - axis.changed + 1) / (axis.counted + 1);
  const double run = share < 1 ? 1 + std::log(kChance) / std::log(share) : kStuck;
  return static_cast<int>(std::clamp(run, double{kSaturated}, double{kStuck}));
}

ImuAxisWatch::Fault ImuAxisWatch::Classify(double value, double floor, double resolution, const Axis& axis) {
  const bool arrived = axis.came_from_s > 0 && std::abs(value - axis.came_from) >= kSteps * resolution;
  const std::optional<Level>& limit = axis.limits[Side(value)];
  const std::optional<Level>& stuck_at = axis.stuck_at[Side(value)];
  const bool back = stuck_at && value == stuck_at->value && axis.since_ns != stuck_at->since_ns;
  if ((limit && value == limit->value) || (back && arrived && axis.equal >= kReturned)) {
    return Fault::kSaturated;
  }
  const bool settled = axis.measured >= kLeastMeasurements;
  const bool restless = IsRestless(axis);
  const bool others_move = OthersMove(axis, resolution);
  const bool certain = std::abs(value) > floor && (settled || others_move);
  if (IsExtreme(value, axis) && (certain || (axis.equal >= kSaturatedInDoubt && restless && others_move)) &&
      (axis.resolution == 0 ? axis.equal >= kSaturatedInDoubt : arrived && axis.equal >= kSaturated)) {
    return Fault::kSaturated;
  }
  if (!settled || !restless || axis.resolution == 0) {
    return Fault::kNone;
  }
  const double span = std::min(axis.high[0] - axis.low[0], axis.high[1] - axis.low[1]);
  return (axis.equal >= kStuck && span >= kSpan * resolution) ||
                 (axis.equal >= kSaturated && arrived && others_move && axis.equal >= StuckRun(axis))
             ? Fault::kStuck
             : Fault::kNone;
}

double ImuAxisWatch::Sigma(Fault fault, double value, double floor, double seconds, const Axis& axis) {
  if (fault != Fault::kSaturated) {
    const double replaced = axis.faulty ? axis.mean : value;
    const double square = axis.mean_square - 2 * replaced * axis.mean + replaced * replaced;
    return std::max(floor, std::sqrt(std::max(0.0, square)));
  }
  floor = std::min(floor, std::abs(value));  // a small range is hardly exceeded by more than itself
  const double beyond = kBeyondRange * std::abs(value);
  if (axis.came_from_s == 0) {
    return std::max(floor, beyond);
  }
  const double rate = std::abs(value - axis.came_from) / axis.came_from_s;
  return std::max(floor, std::min(rate * seconds, beyond));
}

double ImuAxisWatch::Reading(Fault fault, double value, const Axis& axis,
                             std::optional<double> implied) const {
  if (fault != Fault::kSaturated || axis.resolution == 0) {
    return implied.value_or(axis.mean);
  }
  return value * std::max(1.0, implied.value_or(value) / value);
}

void ImuAxisWatch::CountHeld(const ImuSample& last, const ImuSample& sample, const Signal& other,
                             Signal* signal) {
  const Eigen::Vector3d& value = sample.*signal->value;
  HeldRows& held = signal->held;
  if (value != last.*signal->value || imu_gap::IsInside(last, sample)) {
    held.Restart(sample.stamp_ns, sample.*other.value);
    return;
  }
  held.Add(sample.*other.value);
  const double resolution = Resolution(other, 0);
  const bool other_moves = resolution > 0 && held.OtherSpan() >= kSpan * resolution;
  // This row of the other one may not be counted yet.
  const bool other_held = other.held.rows() + 1 >= held.rows();
  const bool active = std::any_of(signal->axes.begin(), signal->axes.end(), [](const Axis& axis) {
    return axis.measured >= kLeastMeasurements && IsRestless(axis);
  });
  const bool never_moved = std::all_of(signal->axes.begin(), signal->axes.end(),
                                       [](const Axis& axis) { return axis.resolution == 0; });
  const bool off_rest = value.cwiseAbs().maxCoeff() > signal->floor;
  held.Judge((active && (other_moves || other_held)) || (never_moved && off_rest && other_moves),
             sample.stamp_ns);
}

std::string ImuAxisWatch::AddAxis(const ImuSample& last, const ImuSample& measured, int index, Signal* signal,
                                  ImuSample* sample) {
  Axis& axis = signal->axes[static_cast<std::size_t>(index)];
  Count(*signal, index, last, measured, &axis);
  const double value = (measured.*signal->value)[index];
  const Fault fault = signal->held.frozen()
                          ? Fault::kFrozen
                          : Classify(value, signal->floor, Resolution(*signal, index), axis);
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
  std::optional<Level>& limit = axis.limits[Side(value)];
  if (fault == Fault::kSaturated && (!limit || limit->value != value)) {
    limit = {value, axis.since_ns};
  } else if (fault == Fault::kStuck) {
    axis.stuck_at[Side(value)] = {value, axis.since_ns};
  }
  Eigen::Vector3d axes = Eigen::Vector3d::Unit(index);
  if (fault == Fault::kSaturated || IsExtreme(value, axis)) {
    axes.setOnes();
  }
  Eigen::Vector3d& densities = sample->*signal->fault_density;
  densities = (densities.cwiseAbs2() + density * density * axes).cwiseSqrt();
  const char* const text = fault == Fault::kSaturated ? "the %s's %c axis is saturated at %.4g %s"
                           : fault == Fault::kStuck
                               ? "the %s's %c axis repeats %.4g %s while the others change"
                               : "the %s's %c axis repeats %.4g %s, and so do the others";
  reason_ = Format(text, signal->name, "xyz"[index], value, signal -> unit);
  const bool reported = sample->stamp_ns <= axis.reported_until_ns;
  axis.reported_until_ns = sample->stamp_ns + SecondsToNs(kSameFaultS);
  return reported ? std::string() : reason_ + " from " + FormatSeconds(axis.since_ns) + " s on";
}

std::string ImuAxisWatch::Add(ImuSample* sample) {
  std::string reported;
  const ImuSample measured = *sample;
  reason_.clear();
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const Signal& other = signals_[1 - i];
    if (any_) {
      CountHeld(last_, measured, other, &signals_[i]);
    } else {
      Begin(measured, other, &signals_[i]);
    }
  }
  for (Signal& signal : signals_) {
    for (int index = 0; any_ && index < 3; ++index) {
      const std::string one = AddAxis(last_, measured, index, &signal, sample);
      reported += one.empty() || reported.empty() ? one : "; " + one;
    }
  }
  any_ = true;
  last_ = measured;
  return reported;
}

}  // namespace alidade
