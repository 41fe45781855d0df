#include "eval/dataset/dataset_writer.h"

#include <charconv>
#include <filesystem>

#include "eval/dataset/dataset_fix.h"
#include "eval/dataset/dataset_gnss.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/files/output_file.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

void Append(std::string* text, double value) {
  char buffer[40];
  const std::to_chars_result result = std::to_chars(buffer, buffer + sizeof buffer, value);
  text->push_back(',');
  text->append(buffer, result.ptr);
}

void Append(std::string* text, const Eigen::Vector3d& vector) {
  for (int i = 0; i < 3; ++i) {
    Append(text, vector[i]);
  }
}

std::string ImuCsv(const std::vector<ImuSample>& imu) {
  std::string text =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  text.reserve(imu.size() * 140);
  for (const ImuSample& sample : imu) {
    text += std::to_string(sample.stamp_ns);
    Append(&text, sample.gyro);
    Append(&text, sample.accel);
    text.push_back('\n');
  }
  return text;
}

std::string TruthCsv(const Trajectory& truth) {
  std::string text =
      truth.has_velocity
          ? "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],"
            "q_RS_z [],v_RS_R_x [m s^-1],v_RS_R_y [m s^-1],v_RS_R_z [m s^-1],b_w_RS_S_x [rad s^-1],"
            "b_w_RS_S_y [rad s^-1],b_w_RS_S_z [rad s^-1],b_a_RS_S_x [m s^-2],b_a_RS_S_y [m s^-2],"
            "b_a_RS_S_z [m s^-2]\n"
      : truth.has_orientation ? "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z\n"
                              : "#timestamp [ns],p_x,p_y,p_z\n";
  text.reserve(truth.points.size() * 340);
  for (const TrajectoryPoint& point : truth.points) {
    const Eigen::Quaterniond q(point.nav.R_WB);
    text += std::to_string(point.stamp_ns);
    Append(&text, point.nav.p_WB);
    if (truth.has_orientation) {
      Append(&text, q.w());
      Append(&text, Eigen::Vector3d(q.vec()));
    }
    if (truth.has_velocity) {
      Append(&text, point.nav.v_WB);
      Append(&text, point.bias.gyro);
      Append(&text, point.bias.accel);
    }
    text.push_back('\n');
  }
  return text;
}

std::string StampsCsv(const std::vector<TimeNs>& stamps) {
  std::string text = "#timestamp [ns]\n";
  for (const TimeNs stamp : stamps) {
    text += std::to_string(stamp) + "\n";
  }
  return text;
}

/// The stamps that timestamps.csv must hold: those given, or all frames when some frame saw nothing and
/// tracks.csv alone would lose it.
std::vector<TimeNs> StampsToWrite(const Dataset& dataset) {
  if (!dataset.camera_stamps.empty()) {
    return dataset.camera_stamps;
  }
  std::vector<TimeNs> stamps;
  bool some_empty = false;
  for (const TrackFrame& frame : dataset.tracks) {
    stamps.push_back(frame.stamp_ns);
    some_empty = some_empty || frame.observations.empty();
  }
  return some_empty ? stamps : std::vector<TimeNs>();
}

bool HasCamera(const Dataset& dataset) {
  return !dataset.tracks.empty() || !dataset.images.empty() || !dataset.camera_stamps.empty();
}

}  // namespace

std::string ExtraCameraYaml(const Dataset& dataset, size_t k) {
  const ExtraCamera& extra = dataset.extra_cameras[k];
  RigCalibration rig = dataset.rig;
  rig.camera = extra.camera;
  rig.T_BC = extra.T_BC;
  rig.camera_time_offset_s = extra.camera_time_offset_s;
  return CameraSensorYaml(rig, dataset.camera_rate_hz);
}

Status WriteTracks(const std::vector<TrackFrame>& tracks, const std::string& csv_path) {
  std::string text = "#timestamp [ns],track_id,u [px],v [px]\n";
  for (const TrackFrame& frame : tracks) {
    const std::string stamp = std::to_string(frame.stamp_ns) + ",";
    for (const TrackObservation& observation : frame.observations) {
      text += stamp;
      text += std::to_string(observation.track_id);
      Append(&text, observation.pixel.x());
      Append(&text, observation.pixel.y());
      text.push_back('\n');
    }
  }
  return WriteFileAtomically(csv_path, text);
}

Status WriteDataset(const Dataset& dataset, const std::string& path) {
  const fs::path mav = fs::path(path) / "mav0";
  const fs::path camera = mav / "cam0";
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically((mav / "imu0" / "sensor.yaml").string(),
                                              ImuSensorYaml(dataset.rig.imu_noise, dataset.imu_rate_hz)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically((mav / "imu0" / "data.csv").string(), ImuCsv(dataset.imu)));
  if (HasCamera(dataset) || dataset.gnss == nullptr) {
    ALIDADE_RETURN_IF_ERROR(WriteFileAtomically((camera / "sensor.yaml").string(),
                                                CameraSensorYaml(dataset.rig, dataset.camera_rate_hz)));
  }
  if (!dataset.tracks.empty()) {
    ALIDADE_RETURN_IF_ERROR(WriteTracks(dataset.tracks, (camera / "tracks.csv").string()));
  }
  if (const std::vector<TimeNs> stamps = StampsToWrite(dataset); !stamps.empty()) {
    ALIDADE_RETURN_IF_ERROR(WriteFileAtomically((camera / "timestamps.csv").string(), StampsCsv(stamps)));
  }
  for (size_t k = 0; k < dataset.extra_cameras.size(); ++k) {
    const ExtraCamera& extra = dataset.extra_cameras[k];
    const fs::path folder = mav / ("cam" + std::to_string(k + 1));
    ALIDADE_RETURN_IF_ERROR(
        WriteFileAtomically((folder / "sensor.yaml").string(), ExtraCameraYaml(dataset, k)));
    ALIDADE_RETURN_IF_ERROR(WriteTracks(extra.frames, (folder / "tracks.csv").string()));
  }
  if (dataset.gnss != nullptr) {
    ALIDADE_RETURN_IF_ERROR(WriteGnssFolder(dataset, (mav / "gnss0").string()));
  }
  ALIDADE_RETURN_IF_ERROR(WriteFixFolders(dataset, mav.string()));
  if (dataset.truth.has_value()) {
    const char* name = dataset.truth->has_velocity      ? "data.csv"
                       : dataset.truth->has_orientation ? "data_pose.csv"
                                                        : "data_position.csv";
    ALIDADE_RETURN_IF_ERROR(
        WriteFileAtomically((mav / "state_groundtruth_estimate0" / name).string(), TruthCsv(*dataset.truth)));
  }
  return Status::Ok();
}

}  // namespace alidade
