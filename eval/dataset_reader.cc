#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "eval/csv.h"
#include "eval/dataset.h"
#include "eval/sensor_yaml.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

Result<CsvReader> OpenTable(const std::string& path, const std::vector<CsvColumn>& header) {
  Result<CsvReader> csv = CsvReader::Open(path);
  if (csv.ok()) {
    csv->NextRow();
    if (Status matches = csv->ExpectHeader(header); !matches.ok()) {
      return matches;
    }
  }
  return csv;
}

/// Mean rate of the stamps [Hz]; 0 when there are fewer than two.
double MeasuredRate(TimeNs first, TimeNs last, size_t count) {
  return count < 2 ? 0 : static_cast<double>(count - 1) / SecondsBetween(first, last);
}

Result<std::vector<ImuSample>> ReadImu(const std::string& path) {
  // Units are required here: a gyroscope in deg/s or an accelerometer in g must not pass for SI.
  const std::vector<CsvColumn> header = {{"timestamp", "ns"},
                                         {"w_RS_S_x", "rad s^-1", true},
                                         {"w_RS_S_y", "rad s^-1", true},
                                         {"w_RS_S_z", "rad s^-1", true},
                                         {"a_RS_S_x", "m s^-2", true},
                                         {"a_RS_S_y", "m s^-2", true},
                                         {"a_RS_S_z", "m s^-2", true}};
  Result<CsvReader> csv = OpenTable(path, header);
  if (!csv.ok()) {
    return csv.status();
  }
  std::vector<ImuSample> imu;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(header.size()));
    ImuSample sample;
    ALIDADE_RETURN_IF_ERROR(
        csv->ReadStamp(imu.empty(), imu.empty() ? 0 : imu.back().stamp_ns, &sample.stamp_ns));
    for (int i = 0; i < 3; ++i) {
      const size_t column = static_cast<size_t>(i) + 1;
      ALIDADE_RETURN_IF_ERROR(csv->ReadReal(column, header[column].name, &sample.gyro[i]));
      ALIDADE_RETURN_IF_ERROR(csv->ReadReal(column + 3, header[column + 3].name, &sample.accel[i]));
    }
    imu.push_back(sample);
  }
  if (imu.size() < 2) {
    return Status::Input(path + ": holds " + std::to_string(imu.size()) + " samples, expected at least two");
  }
  return imu;
}

Status CloseFrame(TrackFrame* frame, const std::string& place) {
  std::vector<TrackObservation>& observations = frame->observations;
  const auto by_id = [](const TrackObservation& a, const TrackObservation& b) {
    return a.track_id < b.track_id;
  };
  if (!std::is_sorted(observations.begin(), observations.end(), by_id)) {
    std::stable_sort(observations.begin(), observations.end(), by_id);
  }
  for (size_t i = 1; i < observations.size(); ++i) {
    if (observations[i].track_id == observations[i - 1].track_id) {
      return Status::Input(place + ": track_id " + std::to_string(observations[i].track_id) +
                           " comes twice at stamp " + std::to_string(frame->stamp_ns) +
                           ", expected each track at most once a frame");
    }
  }
  return Status::Ok();
}

Result<std::vector<TrackFrame>> ReadTracks(const std::string& path) {
  const std::vector<CsvColumn> header = {{"timestamp", "ns"}, {"track_id", ""}, {"u", "px"}, {"v", "px"}};
  Result<CsvReader> csv = OpenTable(path, header);
  if (!csv.ok()) {
    return csv.status();
  }
  std::vector<TrackFrame> frames;
  std::string place;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(header.size()));
    TimeNs stamp = 0;
    ALIDADE_RETURN_IF_ERROR(csv->ReadInt64(0, "timestamp", &stamp));
    if (frames.empty() || stamp != frames.back().stamp_ns) {
      if (!frames.empty()) {
        ALIDADE_RETURN_IF_ERROR(csv->ReadStamp(false, frames.back().stamp_ns, &stamp));
        ALIDADE_RETURN_IF_ERROR(CloseFrame(&frames.back(), place));
      }
      frames.push_back({stamp, {}, 0});
      place = csv->Place();
    }
    TrackObservation observation;
    ALIDADE_RETURN_IF_ERROR(csv->ReadInt64(1, "track_id", &observation.track_id));
    if (observation.track_id < 0) {
      return csv->Fault(1, "track_id", "a number that is not negative");
    }
    ALIDADE_RETURN_IF_ERROR(csv->ReadReal(2, "u", &observation.pixel.x()));
    ALIDADE_RETURN_IF_ERROR(csv->ReadReal(3, "v", &observation.pixel.y()));
    frames.back().observations.push_back(observation);
  }
  if (frames.empty()) {
    return Status::Input(path + ": holds no track, expected at least one row");
  }
  ALIDADE_RETURN_IF_ERROR(CloseFrame(&frames.back(), place));
  return frames;
}

Result<std::vector<TimeNs>> ReadStamps(const std::string& path) {
  Result<CsvReader> csv = OpenTable(path, {{"timestamp", "ns"}});
  if (!csv.ok()) {
    return csv.status();
  }
  std::vector<TimeNs> stamps;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(1));
    TimeNs stamp = 0;
    ALIDADE_RETURN_IF_ERROR(csv->ReadStamp(stamps.empty(), stamps.empty() ? 0 : stamps.back(), &stamp));
    stamps.push_back(stamp);
  }
  if (stamps.empty()) {
    return Status::Input(path + ": holds no stamp, expected at least one row");
  }
  return stamps;
}

/// Width and height in the header of a PNG file: 8 bytes of signature, then the IHDR chunk with both as
/// big-endian integers (ISO/IEC 15948). Nothing when the file is no PNG: other formats are the decoder's
/// business.
std::optional<std::pair<int, int>> PngSize(const std::string& path) {
  unsigned char head[24] = {};
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(head), sizeof head) || head[0] != 0x89 || head[1] != 'P') {
    return std::nullopt;
  }
  const auto number = [&head](int at) {
    return (head[at] << 24) | (head[at + 1] << 16) | (head[at + 2] << 8) | head[at + 3];
  };
  return std::pair(number(16), number(20));
}

Status CheckImage(const CsvReader& csv, const ImageEntry& image, const CameraModel& camera) {
  std::error_code ignored;
  if (!fs::is_regular_file(image.path, ignored)) {
    return Status::Input(csv.Place() + ": image " + image.path + " is missing");
  }
  const std::optional<std::pair<int, int>> size = PngSize(image.path);
  if (size.has_value() && (size->first != camera.width_px() || size->second != camera.height_px())) {
    return Status::Input(image.path + ": image of " + std::to_string(size->first) + " x " +
                         std::to_string(size->second) + " px, expected the resolution " +
                         std::to_string(camera.width_px()) + " x " + std::to_string(camera.height_px()) +
                         " of sensor.yaml");
  }
  return Status::Ok();
}

Result<std::vector<ImageEntry>> ReadImages(const fs::path& folder, const CameraModel& camera) {
  const std::string path = (folder / "data.csv").string();
  Result<CsvReader> csv = OpenTable(path, {{"timestamp", "ns"}, {"filename"}});
  if (!csv.ok()) {
    return csv.status();
  }
  std::vector<ImageEntry> images;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(2));
    ImageEntry image;
    ALIDADE_RETURN_IF_ERROR(
        csv->ReadStamp(images.empty(), images.empty() ? 0 : images.back().stamp_ns, &image.stamp_ns));
    image.path = (folder / "data" / std::string(csv->field(1))).string();
    ALIDADE_RETURN_IF_ERROR(CheckImage(*csv, image, camera));
    images.push_back(std::move(image));
  }
  if (images.empty()) {
    return Status::Input(path + ": lists no image, expected at least one row");
  }
  return images;
}

/// tracks.csv cannot say that a frame saw nothing; timestamps.csv beside it can. Adds those frames.
Status AddEmptyFrames(const std::string& tracks_path, Dataset* dataset) {
  std::vector<TrackFrame> frames;
  size_t next = 0;
  for (const TimeNs stamp : dataset->camera_stamps) {
    if (next < dataset->tracks.size() && dataset->tracks[next].stamp_ns == stamp) {
      frames.push_back(std::move(dataset->tracks[next++]));
    } else {
      frames.push_back({stamp, {}, 0});
    }
  }
  if (next < dataset->tracks.size()) {
    return Status::Input(tracks_path + ": stamp " + std::to_string(dataset->tracks[next].stamp_ns) +
                         " is not in timestamps.csv beside it, expected every frame there");
  }
  dataset->tracks = std::move(frames);
  return Status::Ok();
}

Status ReadCamera(const fs::path& folder, Dataset* dataset) {
  const Result<CameraSensor> sensor = ReadCameraSensor((folder / "sensor.yaml").string());
  if (!sensor.ok()) {
    return sensor.status();
  }
  dataset->rig.camera = sensor->camera;
  dataset->rig.T_BC = sensor->T_BC;
  dataset->rig.camera_time_offset_s = sensor->time_offset_s;
  const std::string tracks_path = (folder / "tracks.csv").string();
  if (fs::exists(tracks_path)) {
    Result<std::vector<TrackFrame>> tracks = ReadTracks(tracks_path);
    ALIDADE_RETURN_IF_ERROR(tracks.status());
    dataset->tracks = std::move(tracks).value();
  }
  if (fs::exists(folder / "timestamps.csv")) {
    Result<std::vector<TimeNs>> stamps = ReadStamps((folder / "timestamps.csv").string());
    ALIDADE_RETURN_IF_ERROR(stamps.status());
    dataset->camera_stamps = std::move(stamps).value();
  }
  if (fs::exists(folder / "data.csv")) {
    Result<std::vector<ImageEntry>> images = ReadImages(folder, dataset->rig.camera);
    ALIDADE_RETURN_IF_ERROR(images.status());
    dataset->images = std::move(images).value();
  }
  if (dataset->tracks.empty() && dataset->camera_stamps.empty() && dataset->images.empty()) {
    return Status::Input(folder.string() +
                         ": expected tracks.csv, data.csv with images, or timestamps.csv; found none");
  }
  if (!dataset->tracks.empty() && !dataset->camera_stamps.empty()) {
    ALIDADE_RETURN_IF_ERROR(AddEmptyFrames(tracks_path, dataset));
  }
  if (sensor->rate_hz.has_value()) {
    dataset->camera_rate_hz = *sensor->rate_hz;
  } else if (!dataset->tracks.empty()) {
    const std::vector<TrackFrame>& frames = dataset->tracks;
    dataset->camera_rate_hz = MeasuredRate(frames.front().stamp_ns, frames.back().stamp_ns, frames.size());
  } else if (!dataset->images.empty()) {
    const std::vector<ImageEntry>& images = dataset->images;
    dataset->camera_rate_hz = MeasuredRate(images.front().stamp_ns, images.back().stamp_ns, images.size());
  } else {
    const std::vector<TimeNs>& stamps = dataset->camera_stamps;
    dataset->camera_rate_hz = MeasuredRate(stamps.front(), stamps.back(), stamps.size());
  }
  return Status::Ok();
}

Status ReadTruth(const fs::path& folder, Dataset* dataset) {
  for (const char* name : {"data.csv", "data_pose.csv"}) {
    const fs::path path = folder / name;
    if (!fs::exists(path)) {
      continue;
    }
    Result<Trajectory> truth = ReadTrajectory(path.string());
    ALIDADE_RETURN_IF_ERROR(truth.status());
    dataset->truth = std::move(truth).value();
    dataset->truth_path = path.string();
    return Status::Ok();
  }
  if (fs::is_directory(folder)) {
    return Status::Input(folder.string() + ": expected data.csv or data_pose.csv; found neither");
  }
  return Status::Ok();
}

Status CheckFolders(const std::string& path, const fs::path& mav) {
  if (!fs::is_directory(path)) {
    return Status::Input(path + ": no such folder, expected a sequence (a folder that holds mav0)");
  }
  if (!fs::is_directory(mav)) {
    const bool inside = fs::is_directory(fs::path(path) / "imu0");
    return Status::Input(path + ": expected a folder mav0 in it" +
                         (inside ? " (this looks like mav0 itself: give the folder that holds it)" : ""));
  }
  if (!fs::is_directory(mav / "cam0") && !fs::is_directory(mav / "gnss0")) {
    return Status::Input((mav / "cam0").string() +
                         ": no such folder, expected a camera (or gnss0 beside it)");
  }
  return Status::Ok();
}

}  // namespace

Result<Dataset> ReadDataset(const std::string& path) {
  const fs::path mav = fs::path(path) / "mav0";
  ALIDADE_RETURN_IF_ERROR(CheckFolders(path, mav));
  Dataset dataset;
  dataset.path = path;
  std::error_code ignored;
  const fs::path whole = fs::weakly_canonical(path, ignored);
  dataset.name = whole.has_filename() ? whole.filename().string() : whole.parent_path().filename().string();

  const Result<ImuSensor> imu_sensor = ReadImuSensor((mav / "imu0" / "sensor.yaml").string());
  ALIDADE_RETURN_IF_ERROR(imu_sensor.status());
  dataset.rig.imu_noise = imu_sensor->noise;
  Result<std::vector<ImuSample>> imu = ReadImu((mav / "imu0" / "data.csv").string());
  ALIDADE_RETURN_IF_ERROR(imu.status());
  dataset.imu = std::move(imu).value();
  dataset.imu_rate_hz = imu_sensor->rate_hz.value_or(
      MeasuredRate(dataset.imu.front().stamp_ns, dataset.imu.back().stamp_ns, dataset.imu.size()));
  if (fs::is_directory(mav / "cam0")) {
    ALIDADE_RETURN_IF_ERROR(ReadCamera(mav / "cam0", &dataset));
  }
  ALIDADE_RETURN_IF_ERROR(ReadTruth(mav / "state_groundtruth_estimate0", &dataset));
  return dataset;
}

}  // namespace alidade
