#include "eval/dataset/imu_values.h"

#include <algorithm>

#include "core/format.h"
#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/imu_units.h"

namespace alidade {
namespace {

/// Specific force averages to gravity on any path that returns to its starting speed.
constexpr double kMostForceError = 2.5;  // [m/s^2]

}  // namespace

void ImuValues::Add(const ImuSample& sample) {
  Vector6d values;
  values << sample.gyro, sample.accel;
  repeated_ += count_ > 0 && values == last_ ? 1 : 0;
  last_ = values;
  low_ = low_.cwiseMin(values);
  high_ = high_.cwiseMax(values);
  const double rate = sample.gyro.norm();
  force_ += sample.accel.norm();
  rate_ += rate;
  rate_square_ += rate * rate;
  fastest_ = std::max(fastest_, rate);
  ++count_;
}

SoundColumns ImuValues::Check(Findings* findings) const {
  findings->Fact(
      Format("imu0: mean specific force %.3f m/s^2, angular rate rms %.3f rad/s, largest %.3f rad/s",
             MeanForce(), std::sqrt(rate_square_ / Count()), fastest_));
  CheckRepeated(findings);
  if (GroupsSeemExchanged()) {
    findings->Error(
        Format("imu0: the gyroscope's columns have the norm of gravity (mean %.2f) and the accelerometer's "
               "are small (mean %.2f): the two groups of columns seem to be exchanged, expected angular rate "
               "[rad/s] first, then specific force [m/s^2]",
               rate_ / Count(), MeanForce()));
    return {false, false};
  }
  const bool force = CheckForce(findings);
  return {CheckRate(findings), force};
}

bool ImuValues::GroupsSeemExchanged() const {
  constexpr double kMostSpread = 0.3;  // of the norm; a rate's spreads by about its mean
  const double mean = rate_ / Count();
  const double spread = std::sqrt(std::max(0.0, rate_square_ / Count() - mean * mean));
  return std::abs(mean - kStandardGravity) < kMostForceError && spread < kMostSpread * mean &&
         MeanForce() < kStandardGravity / 2;
}

std::string ImuValues::DeadAxes(int first, int last) const {
  constexpr std::array<const char*, 6> kAxes = {"gyroscope x",     "gyroscope y",     "gyroscope z",
                                                "accelerometer x", "accelerometer y", "accelerometer z"};
  std::string text;
  for (int axis = first; axis < last; ++axis) {
    if (low_[axis] == high_[axis]) {
      text +=
          Format("%s%s is %g", text.empty() ? "" : ", ", kAxes[static_cast<std::size_t>(axis)], low_[axis]);
    }
  }
  return text;
}

bool ImuValues::CheckForce(Findings* findings) const {
  constexpr double kUnitBand = 1.3;  // a sensor in its unit is much nearer, the units are further apart
  const double force = MeanForce();
  const double error = std::abs(force - kStandardGravity);
  const std::string dead = DeadAxes(3, 6);
  const ImuUnit* unit = force > 0 ? NearestUnit(kAccelUnits, force, kStandardGravity, kUnitBand) : nullptr;
  if (error > kMostForceError && !dead.empty()) {
    findings->Error(
        Format("imu0: mean specific force %.3f m/s^2, expected about %.2f: %s in all samples, a "
               "dead axis?",
               force, kStandardGravity, dead.c_str()));
    return false;
  }
  if (!dead.empty()) {
    findings->Warning("imu0: " + dead + " in all samples: a dead axis?");
  }
  if (error <= kMostForceError) {
    return true;
  }
  if (unit != nullptr && unit != kAccelUnits) {
    findings->Error(
        Format("imu0: mean specific force %.*f: the accelerometer seems to be in %s, expected "
               "m/s^2",
               force > 100 ? 0 : 3, force, unit->name));
  } else {
    findings->Error(
        Format("imu0: mean specific force %.3f m/s^2, expected about %.2f: unit or gravity removed?", force,
               kStandardGravity));
  }
  return false;
}

bool ImuValues::CheckRate(Findings* findings) const {
  if (const std::string dead = DeadAxes(0, 3); !dead.empty()) {
    findings->Warning("imu0: " + dead + " in all samples: a dead axis?");
  }
  const double rate_rms = std::sqrt(rate_square_ / Count());
  if (rate_rms <= kMostRateRms && fastest_ <= kMostRate) {
    return true;
  }
  const std::string units = PlausibleGyroUnits(rate_rms, fastest_);
  findings->Error(Format("imu0: angular rate rms %.2f, largest %.2f: ", rate_rms, fastest_) +
                  (units.empty()
                       ? Format("more than a camera can follow (%.0f and %.0f rad/s) and none of deg/s, "
                                "mrad/s and mdeg/s explains it",
                                kMostRateRms, kMostRate)
                       : "the gyroscope seems to be in " + units + ", expected rad/s"));
  return false;
}

void ImuValues::CheckRepeated(Findings* findings) const {
  const double share = static_cast<double>(repeated_) / (Count() - 1);
  if (repeated_ > 0 && share > 0.01) {
    findings->Warning(
        Format("imu0: %zu rows (%.1f %%) repeat the values of the row before; the real rate is lower",
               repeated_, 100 * share));
  }
}

}  // namespace alidade
