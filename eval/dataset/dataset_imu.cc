#include "eval/dataset/dataset_imu.h"

#include <filesystem>
#include <utility>

#include "core/format.h"
#include "eval/dataset/imu_intake.h"
#include "eval/dataset/log_hasher.h"
#include "eval/dataset/log_tables.h"
#include "eval/dataset/sensor_table.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/files/output_file.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

/// Reads the current row; a NaN or an infinity is a value here, for the intake to drop.
Status ReadImuRow(const CsvReader& csv, const std::vector<CsvColumn>& header, ImuSample* sample) {
  ALIDADE_RETURN_IF_ERROR(csv.ExpectColumns(header.size()));
  ALIDADE_RETURN_IF_ERROR(csv.ReadTime(0, header[0].name, &sample->stamp_ns));
  for (int i = 0; i < 3; ++i) {
    const size_t column = static_cast<size_t>(i) + 1;
    ALIDADE_RETURN_IF_ERROR(csv.ReadRealOrNotFinite(column, header[column].name, &sample->gyro[i]));
    ALIDADE_RETURN_IF_ERROR(csv.ReadRealOrNotFinite(column + 3, header[column + 3].name, &sample->accel[i]));
  }
  return Status::Ok();
}

/// Where the samples of a table go.
class ImuSink {
 public:
  ImuSink(const DatasetStorage& storage, Dataset* dataset) : dataset_(*dataset) {
    if (dataset_.tables != nullptr) {
      dataset_.tables->imu = Table<ImuSample>::InFile(storage.spool_folder);
    }
  }

  /// To be called now and then: what is in order for good leaves memory.
  Status Settle(ImuIntake* intake) {
    constexpr size_t kMany = 4096;
    if (dataset_.tables == nullptr || intake->samples().size() < kMany) {
      return Status::Ok();
    }
    return Add(intake->TakeSettled());
  }
  /// The rest.
  Status Finish(const ImuIntake& intake) {
    if (dataset_.tables != nullptr) {
      return Add(intake.samples());
    }
    dataset_.imu = intake.samples();
    return Status::Ok();
  }

 private:
  Status Add(const std::vector<ImuSample>& samples) {
    for (const ImuSample& sample : samples) {
      ALIDADE_RETURN_IF_ERROR(dataset_.tables->imu.Add(sample));
    }
    return Status::Ok();
  }

  Dataset& dataset_;
};

Status ReadImuTable(const std::string& path, const DatasetStorage& storage, Dataset* dataset) {
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
  ImuSink sink(storage, dataset);
  std::string first_fault;
  size_t rows = 0;
  for (; csv->NextRow(); ++rows) {
    ImuSample sample;
    ALIDADE_RETURN_IF_ERROR(ReadImuRow(*csv, header, &sample));
    if (const std::optional<Status> fault = intake.Add(sample); fault && first_fault.empty()) {
      first_fault = csv->Place() + ": " + fault->message();
    }
    ALIDADE_RETURN_IF_ERROR(sink.Settle(&intake));
  }
  const ImuRejections& rejections = intake.rejections();
  if (static_cast<double>(rejections.dropped()) > kMaxRejectedImuShare * static_cast<double>(rows)) {
    return Status::Input(first_fault + Format("; of %zu rows %s, expected at most %.0f %% dropped", rows,
                                              DescribeRejections(rejections).c_str(),
                                              100 * kMaxRejectedImuShare));
  }
  if (rows - rejections.dropped() < 2) {
    return Status::Input(path +
                         Format(": holds %zu samples, expected at least two", rows - rejections.dropped()));
  }
  ALIDADE_RETURN_IF_ERROR(sink.Finish(intake));
  dataset->imu_rejections = rejections;
  if (const std::string rejected = DescribeRejections(rejections); !rejected.empty()) {
    dataset->remarks.push_back(path + Format(": of %zu rows ", rows) + rejected +
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

}  // namespace

Status ReadImuFolder(const std::string& mav, const DatasetStorage& storage, Dataset* dataset) {
  const fs::path folder = fs::path(mav) / "imu0";
  const Result<ImuSensor> sensor = ReadImuSensor((folder / "sensor.yaml").string());
  ALIDADE_RETURN_IF_ERROR(sensor.status());
  dataset->rig.imu_noise = sensor->noise;
  ALIDADE_RETURN_IF_ERROR(ReadImuTable((folder / "data.csv").string(), storage, dataset));
  const Table<ImuSample> imu = TablesOf(*dataset).imu;
  dataset->imu_rate_hz =
      sensor->rate_hz.value_or(MeasuredRate(imu.front().stamp_ns, imu.back().stamp_ns, imu.size()));
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

Status DigestImu(const MeasurementLog& /*log*/, const LogTables& tables, LogHasher* hasher) {
  hasher->Add(static_cast<std::uint64_t>(tables.imu.size()));
  return tables.imu.ForEach([hasher](const ImuSample& sample) {
    hasher->Add(std::int64_t{sample.stamp_ns});
    hasher->Add(sample.gyro);
    hasher->Add(sample.accel);
  });
}

}  // namespace alidade
