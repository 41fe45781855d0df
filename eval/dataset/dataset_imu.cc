#include "eval/dataset/dataset_imu.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "core/format.h"
#include "core/lie.h"
#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/imu_intake.h"
#include "eval/dataset/log_hasher.h"
#include "eval/dataset/sensor_table.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/files/output_file.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

/// Reads the current row; a NaN or an infinity is a value here, for the intake to drop.
Status ReadImuRow(const CsvReader& csv, const std::vector<CsvColumn>& header, ImuSample* sample) {
  ALIDADE_RETURN_IF_ERROR(csv.ExpectColumns(header.size()));
  ALIDADE_RETURN_IF_ERROR(csv.ReadInt64(0, header[0].name, &sample->stamp_ns));
  for (int i = 0; i < 3; ++i) {
    const size_t column = static_cast<size_t>(i) + 1;
    ALIDADE_RETURN_IF_ERROR(csv.ReadRealOrNotFinite(column, header[column].name, &sample->gyro[i]));
    ALIDADE_RETURN_IF_ERROR(csv.ReadRealOrNotFinite(column + 3, header[column + 3].name, &sample->accel[i]));
  }
  return Status::Ok();
}

Status ReadImuTable(const std::string& path, Dataset* dataset) {
  // Units are required here: a gyroscope in deg/s or an accelerometer in g must not pass for SI.
  const std::vector<CsvColumn> header = {{"timestamp", "ns"},
                                         {"w_RS_S_x", "rad s^-1", true},
                                         {"w_RS_S_y", "rad s^-1", true},
                                         {"w_RS_S_z", "rad s^-1", true},
                                         {"a_RS_S_x", "m s^-2", true},
                                         {"a_RS_S_y", "m s^-2", true},
                                         {"a_RS_S_z", "m s^-2", true}};
  Result<CsvReader> csv = OpenTable(path, header);
  ALIDADE_RETURN_IF_ERROR(csv.status());
  ImuIntake intake;
  std::string first_fault;
  size_t rows = 0;
  for (; csv->NextRow(); ++rows) {
    ImuSample sample;
    ALIDADE_RETURN_IF_ERROR(ReadImuRow(*csv, header, &sample));
    if (const std::optional<Status> fault = intake.Add(sample); fault && first_fault.empty()) {
      first_fault = csv->Place() + ": " + fault->message();
    }
  }
  const ImuRejections& rejections = intake.rejections();
  if (static_cast<double>(rejections.dropped()) > kMaxRejectedImuShare * static_cast<double>(rows)) {
    return Status::Input(first_fault + Format("; of %zu rows %s, expected at most %.0f %% dropped", rows,
                                              DescribeRejections(rejections).c_str(),
                                              100 * kMaxRejectedImuShare));
  }
  if (intake.samples().size() < 2) {
    return Status::Input(path +
                         Format(": holds %zu samples, expected at least two", intake.samples().size()));
  }
  dataset->imu = intake.samples();
  dataset->imu_rejections = rejections;
  if (const std::string told = DescribeRejections(rejections); !told.empty()) {
    dataset->remarks.push_back(path + Format(": of %zu rows ", rows) + told +
                               (first_fault.empty() ? "" : "; the first: " + first_fault));
  }
  return Status::Ok();
}

std::string ImuCsv(const std::vector<ImuSample>& imu) {
  std::string text =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  text.reserve(imu.size() * 140);
  for (const ImuSample& sample : imu) {
    text += std::to_string(sample.stamp_ns);
    AppendFields(sample.gyro, &text);
    AppendFields(sample.accel, &text);
    text.push_back('\n');
  }
  return text;
}

constexpr double kStandardGravity = 9.80665;

/// Specific force averages to gravity on any path that returns to its starting speed; the gyroscope stays
/// below what motion a camera can follow.
void CheckImuUnits(const std::vector<ImuSample>& imu, Findings* findings) {
  double force = 0;
  double rate_square = 0;
  double fastest = 0;
  for (const ImuSample& sample : imu) {
    force += sample.accel.norm() / static_cast<double>(imu.size());
    rate_square += sample.gyro.squaredNorm() / static_cast<double>(imu.size());
    fastest = std::max(fastest, sample.gyro.norm());
  }
  const double rate_rms = std::sqrt(rate_square);
  findings->Fact(
      Format("imu0: mean specific force %.3f m/s^2, angular rate rms %.3f rad/s, largest %.3f rad/s", force,
             rate_rms, fastest));
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
  if (rate_rms > 8 || fastest > 40) {
    findings->Error(Format(
        "imu0: angular rate rms %.2f, largest %.2f: the gyroscope seems to be in deg/s, expected rad/s",
        rate_rms, fastest));
  }
}

/// An axis that never changes is not connected.
void CheckImuAxes(const std::vector<ImuSample>& imu, Findings* findings) {
  constexpr std::array<const char*, 6> kAxes = {"gyroscope x",     "gyroscope y",     "gyroscope z",
                                                "accelerometer x", "accelerometer y", "accelerometer z"};
  Vector6d low = Vector6d::Constant(INFINITY), high = Vector6d::Constant(-INFINITY);
  for (const ImuSample& sample : imu) {
    Vector6d values;
    values << sample.gyro, sample.accel;
    low = low.cwiseMin(values);
    high = high.cwiseMax(values);
  }
  for (int axis = 0; axis < 6; ++axis) {
    if (low[axis] == high[axis]) {
      findings->Warning(Format("imu0: %s is %g in all samples: a dead axis?",
                               kAxes[static_cast<std::size_t>(axis)], low[axis]));
    }
  }
}

void CheckImuValues(const std::vector<ImuSample>& imu, const ImuNoise& noise, Findings* findings) {
  size_t repeated = 0;
  for (size_t i = 1; i < imu.size(); ++i) {
    repeated += imu[i].gyro == imu[i - 1].gyro && imu[i].accel == imu[i - 1].accel ? 1 : 0;
  }
  const double share = static_cast<double>(repeated) / static_cast<double>(imu.size() - 1);
  if (repeated > 0 && share > 0.01) {
    findings->Warning(
        Format("imu0: %zu rows (%.1f %%) repeat the values of the row before; the real rate is lower",
               repeated, 100 * share));
  }
  if (noise.gyro_noise_density_radps_sqrthz > 0.05 || noise.accel_noise_density_mps2_sqrthz > 0.5) {
    findings->Warning(
        "imu0: noise densities in sensor.yaml are large: are they discrete standard deviations or in deg?");
  }
}

}  // namespace

Status ReadImuFolder(const std::string& mav, Dataset* dataset) {
  const fs::path folder = fs::path(mav) / "imu0";
  const Result<ImuSensor> sensor = ReadImuSensor((folder / "sensor.yaml").string());
  ALIDADE_RETURN_IF_ERROR(sensor.status());
  dataset->rig.imu_noise = sensor->noise;
  ALIDADE_RETURN_IF_ERROR(ReadImuTable((folder / "data.csv").string(), dataset));
  dataset->imu_rate_hz = sensor->rate_hz.value_or(
      MeasuredRate(dataset->imu.front().stamp_ns, dataset->imu.back().stamp_ns, dataset->imu.size()));
  return Status::Ok();
}

Status WriteImuFolder(const Dataset& dataset, const std::string& mav) {
  const fs::path folder = fs::path(mav) / "imu0";
  const ImuNoise& noise = dataset.rig.imu_noise;
  if (!(noise.gyro_noise_density_radps_sqrthz > 0) || !(noise.accel_noise_density_mps2_sqrthz > 0)) {
    return Status::Config(
        Format("imu0: noise densities %g rad/s/sqrt(Hz) and %g m/s^2/sqrt(Hz), expected both "
               "greater than 0 in a sheet",
               noise.gyro_noise_density_radps_sqrthz, noise.accel_noise_density_mps2_sqrthz));
  }
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically((folder / "sensor.yaml").string(),
                                              ImuSensorYaml(dataset.rig.imu_noise, dataset.imu_rate_hz)));
  return WriteFileAtomically((folder / "data.csv").string(), ImuCsv(dataset.imu));
}

void DigestImu(const MeasurementLog& log, LogHasher* hasher) {
  hasher->Add(static_cast<std::uint64_t>(log.imu.size()));
  for (const ImuSample& sample : log.imu) {
    hasher->Add(std::int64_t{sample.stamp_ns});
    hasher->Add(sample.gyro);
    hasher->Add(sample.accel);
  }
}

void CheckImu(const Dataset& dataset, Findings* findings) {
  std::vector<TimeNs> stamps;
  for (const ImuSample& sample : dataset.imu) {
    stamps.push_back(sample.stamp_ns);
  }
  CheckStamps("imu0", stamps, dataset.imu_rate_hz, findings);
  if (stamps.size() < 2) {
    return;
  }
  CheckImuUnits(dataset.imu, findings);
  CheckImuAxes(dataset.imu, findings);
  CheckImuValues(dataset.imu, dataset.rig.imu_noise, findings);
}

}  // namespace alidade
