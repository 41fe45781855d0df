#include "eval/dataset/dataset_check_imu.h"

#include <cmath>
#include <optional>
#include <vector>

#include "core/format.h"
#include "core/imu_gap.h"
#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/imu_units.h"
#include "eval/dataset/imu_values.h"
#include "eval/dataset/log_tables.h"
#include "eval/dataset/quiet_seconds.h"

namespace alidade {
namespace {

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
      limits.key, density, limits.unit, above_samples ? limits.grade : limits.most,
      quietest ? Format(" (the quietest second shows at most %.2g)", *quietest).c_str() : "",
      limits.wrong_unit));
}

/// What makes the least rate an error. rate_hz: of the median step, 0 when none is known.
void CheckSilences(double rate_hz, Findings* findings) {
  if (rate_hz > 0 && rate_hz < kImuRates.least_hz) {
    findings->Error(
        Format("imu0: a median step of %.1f ms, expected at most %.1f ms: steps above %.0f ms count as "
               "silences, %s",
               1e3 / rate_hz, 1e3 / kImuRates.least_hz, 1e3 * imu_gap::kMinGapS,
               rate_hz * imu_gap::kMinGapS < 1 ? "as most here do" : "and jitter makes some so long"));
  }
}

/// The accelerometer's scale and bias: against gravity at rest, or else in the mean, which motion may
/// explain.
void CheckScale(double mean_force, const QuietSeconds& quiet, Findings* findings) {
  // 40 mg: zero offsets of consumer accelerometers stay below it, and gravity varies by 0.3 % on the Earth.
  constexpr double kMostShare = 0.04;
  constexpr double kMostOfMean = 0.5;  // [m/s^2]
  const std::optional<double> force = quiet.SpecificForce();
  if (force && std::abs(*force / kStandardGravity - 1) > kMostShare) {
    findings->Warning(Format(
        "imu0: specific force at rest %.3f m/s^2 (median over %zu s) is %.3f of gravity, expected %.2f "
        "within %.0f %%: a scale error or a large bias of the accelerometer?",
        *force, quiet.count(), *force / kStandardGravity, kStandardGravity, 100 * kMostShare));
  } else if (std::abs(mean_force - kStandardGravity) > kMostOfMean) {
    findings->Warning(
        Format("imu0: mean specific force %.3f m/s^2 differs from %.2f: bias, scale error or strong motion",
               mean_force, kStandardGravity));
  }
}

}  // namespace

void CheckImu(const Dataset& dataset, Findings* findings) {
  std::vector<TimeNs> stamps;
  ImuValues values;
  QuietSeconds quiet;
  // A file that cannot be read again is reported by its next reader.
  static_cast<void>(TablesOf(dataset).imu.ForEach([&](const ImuSample& sample) {
    stamps.push_back(sample.stamp_ns);
    values.Add(sample);
    quiet.Add(sample);
  }));
  const std::optional<double> rate_hz = CheckStamps("imu0", stamps, dataset.imu_rate_hz, kImuRates, findings);
  CheckRate("imu0", rate_hz.value_or(0), kImuRates, findings);
  CheckSilences(rate_hz.value_or(0), findings);
  if (stamps.size() < 2) {
    return;
  }
  const SoundColumns sound = values.Check(findings);
  // The quiet seconds are seconds only of stamps in ns.
  if (sound.force) {
    CheckScale(values.MeanForce(), rate_hz ? quiet : QuietSeconds(), findings);
  }
  const ImuNoise& noise = dataset.rig.imu_noise;
  CheckDensity(kGyroDensity, noise.gyro_noise_density_radps_sqrthz,
               rate_hz && sound.rate ? quiet.gyro_density() : std::nullopt, findings);
  CheckDensity(kAccelDensity, noise.accel_noise_density_mps2_sqrthz,
               rate_hz && sound.force ? quiet.accel_density() : std::nullopt, findings);
}

}  // namespace alidade
