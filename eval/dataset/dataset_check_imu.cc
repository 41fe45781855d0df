#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/format.h"
#include "core/lie.h"
#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/dataset_imu.h"
#include "eval/dataset/log_tables.h"
#include "eval/dataset/quiet_seconds.h"

namespace alidade {
namespace {

constexpr double kStandardGravity = 9.80665;

/// What all samples together say.
class ImuValues {
 public:
  void Add(const ImuSample& sample) {
    Vector6d values;
    values << sample.gyro, sample.accel;
    repeated_ += count_ > 0 && values == last_ ? 1 : 0;
    last_ = values;
    low_ = low_.cwiseMin(values);
    high_ = high_.cwiseMax(values);
    force_ += sample.accel.norm();
    rate_square_ += sample.gyro.squaredNorm();
    fastest_ = std::max(fastest_, sample.gyro.norm());
    quiet_.Add(sample);
    ++count_;
  }

  void CheckUnits(Findings* findings) const;
  void CheckAxes(Findings* findings) const;
  void CheckRepeated(Findings* findings) const;
  [[nodiscard]] const QuietSeconds& quiet() const { return quiet_; }

 private:
  size_t count_ = 0;
  size_t repeated_ = 0;
  Vector6d last_ = Vector6d::Zero();
  Vector6d low_ = Vector6d::Constant(INFINITY), high_ = Vector6d::Constant(-INFINITY);
  double force_ = 0;
  double rate_square_ = 0;
  double fastest_ = 0;
  QuietSeconds quiet_;
};

/// Specific force averages to gravity on any path that returns to its starting speed; the gyroscope stays
/// below what motion a camera can follow.
void ImuValues::CheckUnits(Findings* findings) const {
  const double force = force_ / static_cast<double>(count_);
  const double rate_rms = std::sqrt(rate_square_ / static_cast<double>(count_));
  findings->Fact(
      Format("imu0: mean specific force %.3f m/s^2, angular rate rms %.3f rad/s, largest %.3f rad/s", force,
             rate_rms, fastest_));
  if (std::abs(force - 1) < 0.3) {
    findings->Error(
        Format("imu0: mean specific force %.3f: the accelerometer seems to be in g, expected m/s^2", force));
  } else if (std::abs(force - 1000) < 300) {
    findings->Error(
        Format("imu0: mean specific force %.0f: the accelerometer seems to be in mg, expected m/s^2", force));
  } else if (std::abs(force - kStandardGravity) > 2.5) {
    findings->Error(
        Format("imu0: mean specific force %.3f m/s^2, expected about %.2f: unit or gravity removed?", force,
               kStandardGravity));
  } else if (std::abs(force - kStandardGravity) > 0.5) {
    findings->Warning(
        Format("imu0: mean specific force %.3f m/s^2 differs from %.2f: bias, scale error or strong motion",
               force, kStandardGravity));
  }
  if (rate_rms > 8 || fastest_ > 40) {
    findings->Error(Format(
        "imu0: angular rate rms %.2f, largest %.2f: the gyroscope seems to be in deg/s, expected rad/s",
        rate_rms, fastest_));
  }
}

/// An axis that never changes is not connected.
void ImuValues::CheckAxes(Findings* findings) const {
  constexpr std::array<const char*, 6> kAxes = {"gyroscope x",     "gyroscope y",     "gyroscope z",
                                                "accelerometer x", "accelerometer y", "accelerometer z"};
  for (int axis = 0; axis < 6; ++axis) {
    if (low_[axis] == high_[axis]) {
      findings->Warning(Format("imu0: %s is %g in all samples: a dead axis?",
                               kAxes[static_cast<std::size_t>(axis)], low_[axis]));
    }
  }
}

void ImuValues::CheckRepeated(Findings* findings) const {
  const double share = static_cast<double>(repeated_) / static_cast<double>(count_ - 1);
  if (repeated_ > 0 && share > 0.01) {
    findings->Warning(
        Format("imu0: %zu rows (%.1f %%) repeat the values of the row before; the real rate is lower",
               repeated_, 100 * share));
  }
}

/// One density of the sheet, and what sensors have.
struct DensityLimits {
  const char* key;
  const char* unit;
  double grade;  ///< twice that of the noisiest consumer sensors on the market
  double most;   ///< ten times that: no sensor, however much a sheet is enlarged to be safe
  const char* wrong_unit;
};
// Data sheets: gyroscopes have 0.003 to 0.03 deg/s/sqrt(Hz), 5e-5 to 5e-4 rad/s/sqrt(Hz); accelerometers 50
// to 400 ug/sqrt(Hz), 5e-4 to 4e-3 m/s^2/sqrt(Hz), and sheets of 0.1 m/s^2/sqrt(Hz) are in use.
constexpr DensityLimits kGyroDensity = {"gyroscope_noise_density", "rad/s/sqrt(Hz)", 1e-3, 5e-3, "deg"};
constexpr DensityLimits kAccelDensity = {"accelerometer_noise_density", "m/s^2/sqrt(Hz)", 2e-2, 0.5,
                                         "mg or ug"};

/// `quietest`: a bound on the true density from the samples; motion only raises it.
void CheckDensity(const DensityLimits& limits, double density, const std::optional<double>& quietest,
                  Findings* findings) {
  // 57.3 is the factor from rad to deg; sheets that are enlarged to be safe stay below half of it.
  constexpr double kEnlarged = 30;
  const bool above_samples = quietest && density > limits.grade && density > kEnlarged * *quietest;
  if (!(density > limits.most) && !above_samples) {
    return;
  }
  findings->Warning(Format(
      "imu0/sensor.yaml: %s: found %.3g %s, expected below %.0e%s: in %s, or a standard deviation of the "
      "samples?",
      limits.key, density, limits.unit, limits.grade,
      quietest ? Format(" (the quietest second shows at most %.2g)", *quietest).c_str() : "",
      limits.wrong_unit));
}

/// The accelerometer's scale and bias against gravity.
void CheckForceAtRest(const QuietSeconds& quiet, Findings* findings) {
  // 40 mg: zero offsets of consumer accelerometers stay below it, and gravity varies by 0.3 % on the Earth.
  constexpr double kMostShare = 0.04;
  constexpr double kUnit = 0.3;  // beyond it CheckUnits tells another unit
  const std::optional<double> force = quiet.SpecificForce();
  const double off = std::abs(force.value_or(kStandardGravity) / kStandardGravity - 1);
  if (off > kMostShare && off < kUnit) {
    findings->Warning(Format(
        "imu0: specific force at rest %.3f m/s^2 (median over %zu s) is %.3f of gravity, expected %.2f "
        "within %.0f %%: a scale error or a large bias of the accelerometer?",
        *force, quiet.count(), *force / kStandardGravity, kStandardGravity, 100 * kMostShare));
  }
}

// Motion of a body that carries a camera reaches 10 to 20 Hz, so sampling begins to lose it below 50 Hz. No
// MEMS sensor samples faster than 32 kHz.
constexpr RateLimits kImuRates = {5, 50, 1e4, 1e5};

}  // namespace

void CheckImu(const Dataset& dataset, Findings* findings) {
  std::vector<TimeNs> stamps;
  ImuValues values;
  // A file that cannot be read again is reported by its next reader.
  static_cast<void>(TablesOf(dataset).imu.ForEach([&](const ImuSample& sample) {
    stamps.push_back(sample.stamp_ns);
    values.Add(sample);
  }));
  CheckRate("imu0", CheckStamps("imu0", stamps, dataset.imu_rate_hz, findings), kImuRates, findings);
  if (stamps.size() < 2) {
    return;
  }
  values.CheckUnits(findings);
  values.CheckAxes(findings);
  values.CheckRepeated(findings);
  CheckForceAtRest(values.quiet(), findings);
  const ImuNoise& noise = dataset.rig.imu_noise;
  CheckDensity(kGyroDensity, noise.gyro_noise_density_radps_sqrthz, values.quiet().gyro_density(), findings);
  CheckDensity(kAccelDensity, noise.accel_noise_density_mps2_sqrthz, values.quiet().accel_density(),
               findings);
}

}  // namespace alidade
