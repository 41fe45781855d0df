#include "eval/dataset/dataset_gnss.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/format.h"
#include "eval/dataset/sensor_table.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/dataset/stale_parts.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
#include "eval/files/strict_yaml.h"
#include "gnss/formats/rinex_observation.h"
#include "gnss/formats/rinex_writer.h"
#include "gnss/model/gnss_epoch.h"
#include "gnss/orbits/gnss_files.h"
#include "gnss/positioning/time_check.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

struct GnssSensor : GnssSheet {
  std::string observations = "obs.rnx";
  std::vector<std::string> navigation = {"nav.rnx"};
  std::vector<std::string> orbits;
  std::vector<std::string> clocks;
};

Status Fault(const std::string& path, const YAML::Node& node, const char* key, const std::string& expected) {
  return Status::Input(YamlPlace(path, node) + ": " + key + ": found " + YamlText(node) + ", expected " +
                       expected);
}

Status ReadVector(const std::string& path, const YAML::Node& root, const char* key, Eigen::Vector3d* value) {
  std::vector<double> numbers;
  if (const Status parsed = ParseYamlReals(root[key], 3, &numbers); !parsed.ok()) {
    return Fault(path, root[key], key, parsed.message());
  }
  *value = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
  return Status::Ok();
}

/// File names of the folder; a scalar or a list of scalars.
Status ReadNames(const std::string& path, const YAML::Node& root, const char* key,
                 std::vector<std::string>* names) {
  const YAML::Node node = root[key];
  if (!node.IsDefined()) {
    return Status::Ok();
  }
  names->clear();
  for (std::size_t i = 0; node.IsSequence() && i < node.size(); ++i) {
    if (!node[i].IsScalar()) {
      return Fault(path, node, key, "file names");
    }
    names->push_back(node[i].Scalar());
  }
  if (node.IsScalar()) {
    names->push_back(node.Scalar());
  }
  if (!std::all_of(names->begin(), names->end(), StaysInFolder)) {
    return Fault(path, node, key, "names of files in the folder of this sheet");
  }
  return names->empty() ? Fault(path, node, key, "a file name or a list of them") : Status::Ok();
}

/// A position on the Earth that may be left out.
Status ReadPosition(const std::string& path, const YAML::Node& root, const char* key,
                    std::optional<Eigen::Vector3d>* position_E) {
  if (!root[key].IsDefined()) {
    return Status::Ok();
  }
  Eigen::Vector3d found;
  ALIDADE_RETURN_IF_ERROR(ReadVector(path, root, key, &found));
  constexpr double kLeastRadiusM = 6.3e6;
  if (found.norm() < kLeastRadiusM || found.norm() > 1.1 * kLeastRadiusM) {
    return Fault(path, root[key], key, "ECEF coordinates [m] near the Earth's surface");
  }
  *position_E = found;
  return Status::Ok();
}

Result<GnssSensor> MakeGnssSensor(const Result<YAML::Node>& parsed, const std::string& path) {
  ALIDADE_RETURN_IF_ERROR(parsed.status());
  const YAML::Node& root = *parsed;
  GnssSensor sensor;
  if (root["sensor_type"].IsDefined() && root["sensor_type"].as<std::string>("") != "gnss") {
    return Fault(path, root["sensor_type"], "sensor_type", "'gnss'");
  }
  const YAML::Node arm = root["p_BA"];
  const bool unknown = arm.IsDefined() && arm.IsScalar() && arm.Scalar() == "unknown";
  if (!arm.IsDefined()) {
    return Status::Input(path + ": p_BA: is missing, expected the antenna in the body frame [m], or unknown");
  }
  if (!unknown) {
    ALIDADE_RETURN_IF_ERROR(ReadVector(path, root, "p_BA", &sensor.receiver.p_BA));
  }
  if (const YAML::Node offset = root["time_offset_s"]; offset.IsDefined()) {
    const Status number = ParseYamlReal(offset, &sensor.receiver.time_offset_s);
    if (!number.ok()) {
      return Fault(path, offset, "time_offset_s", number.message());
    }
    if (std::abs(sensor.receiver.time_offset_s) > kMaxClockOffsetS) {
      return Fault(path, offset, "time_offset_s", kClockOffsetExpected);
    }
  }
  ALIDADE_RETURN_IF_ERROR(ReadPosition(path, root, "anchor_E", &sensor.receiver.anchor_E));
  ALIDADE_RETURN_IF_ERROR(ReadPosition(path, root, "approximate_position_E", &sensor.approximate_position_E));
  std::vector<std::string> observations = {sensor.observations};
  ALIDADE_RETURN_IF_ERROR(ReadNames(path, root, "observations", &observations));
  sensor.observations = observations.front();
  ALIDADE_RETURN_IF_ERROR(ReadNames(path, root, "navigation", &sensor.navigation));
  ALIDADE_RETURN_IF_ERROR(ReadNames(path, root, "orbits", &sensor.orbits));
  ALIDADE_RETURN_IF_ERROR(ReadNames(path, root, "clocks", &sensor.clocks));
  return sensor;
}

std::vector<std::string> InFolder(const std::string& folder, std::vector<std::string> names) {
  for (std::string& name : names) {
    name = (fs::path(folder) / name).string();
  }
  return names;
}

/// What a reader passed over, such as an epoch that the end of a cut file tears.
void RemarkOn(const ReaderWarnings& warnings, Dataset* dataset) {
  if (warnings.count == 0) {
    return;
  }
  const std::string more =
      warnings.count > 1 ? Format("; and %lld more", static_cast<long long>(warnings.count - 1)) : "";
  dataset->remarks.push_back(warnings.first.front() + more);
}

}  // namespace

std::string GnssSensorYaml(const GnssReceiver& receiver,
                           const std::optional<Eigen::Vector3d>& approximate_position_E) {
  std::string text =
      "sensor_type: gnss\np_BA: " + VectorYaml(receiver.p_BA) +
      "  # antenna in the body frame [m]\ntime_offset_s: " + ShortestDouble(receiver.time_offset_s) +
      "  # t_imu = t_GPST + offset\n";
  if (receiver.anchor_E) {
    text += "anchor_E: " + VectorYaml(*receiver.anchor_E) + "  # origin of the truth's ENU frame, ECEF [m]\n";
  }
  if (approximate_position_E) {
    text +=
        "approximate_position_E: " + VectorYaml(*approximate_position_E) + "  # start of positioning [m]\n";
  }
  return text + "observations: obs.rnx\nnavigation: nav.rnx\n";
}

Result<GnssSheet> ParseGnssSheet(const std::string& text, const std::string& where) {
  const Result<GnssSensor> sensor = MakeGnssSensor(ParseYaml(text, where, StatusCode::kInput), where);
  ALIDADE_RETURN_IF_ERROR(sensor.status());
  return GnssSheet(*sensor);
}

Status ReadGnssFolder(const std::string& mav, const DatasetStorage& /*storage*/, Dataset* dataset) {
  const std::string folder = (fs::path(mav) / "gnss0").string();
  if (!MayBeFolder(folder)) {
    return Status::Ok();
  }
  const std::string sheet = (fs::path(folder) / "sensor.yaml").string();
  const Result<GnssSensor> sensor = MakeGnssSensor(ParseYamlFile(sheet, StatusCode::kInput), sheet);
  ALIDADE_RETURN_IF_ERROR(sensor.status());
  Result<ObservationFile> observations =
      ReadRinexObservation((fs::path(folder) / sensor->observations).string());
  ALIDADE_RETURN_IF_ERROR(observations.status());
  ReaderWarnings warnings;
  Result<std::shared_ptr<const SatelliteCatalog>> catalog =
      LoadSatelliteCatalog({InFolder(folder, sensor->navigation), InFolder(folder, sensor->orbits),
                            InFolder(folder, sensor->clocks)},
                           &warnings);
  ALIDADE_RETURN_IF_ERROR(catalog.status());
  RemarkOn(observations->warnings, dataset);
  RemarkOn(warnings, dataset);
  auto log = std::make_shared<GnssLog>();
  log->epochs = std::move(observations->epochs);
  log->glonass_channels = std::move(observations->glonass_channels);
  log->catalog = *catalog;
  log->approximate_position_E =
      sensor->approximate_position_E ? sensor->approximate_position_E : observations->approximate_position_E;
  if (const Status tags = CheckTags(*log); !tags.ok()) {
    return Status::Input((fs::path(folder) / sensor->observations).string() + ": " + tags.message());
  }
  for (const ObservationEpoch& epoch : log->epochs) {
    ALIDADE_RETURN_IF_ERROR(CheckStampWithOffset(sheet, epoch.stamp_ns, sensor->receiver.time_offset_s));
  }
  dataset->gnss = std::move(log);
  dataset->rig.gnss = sensor->receiver;
  dataset->rig.gnss.is_present = true;
  return Status::Ok();
}

Status WriteGnssFolder(const Dataset& dataset, const std::string& mav) {
  const fs::path path = fs::path(mav) / "gnss0";
  if (dataset.gnss == nullptr) {
    return IsItsOwnFolder(dataset, mav) ? Status::Ok() : RemoveStaleFolder(path.string());
  }
  ObservationFile file;
  file.marker = "ALIDADE";
  file.approximate_position_E = dataset.gnss->approximate_position_E;
  file.glonass_channels = dataset.gnss->glonass_channels;
  file.epochs = dataset.gnss->epochs;
  ALIDADE_RETURN_IF_ERROR(
      WriteFileAtomically((path / "sensor.yaml").string(), GnssSensorYaml(dataset.rig.gnss, std::nullopt)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically((path / "obs.rnx").string(), FormatRinexObservation(file)));
  return WriteFileAtomically((path / "nav.rnx").string(),
                             FormatRinexNavigation(dataset.gnss->catalog->navigation()));
}

}  // namespace alidade
