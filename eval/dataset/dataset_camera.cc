#include "eval/dataset/dataset_camera.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "eval/dataset/sensor_yaml.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

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
                           " occurs twice at stamp " + std::to_string(frame->stamp_ns) +
                           ", expected each track at most once a frame");
    }
  }
  return Status::Ok();
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

/// The three sources a camera folder may hold; at least one must be there.
Status ReadSources(const fs::path& folder, Dataset* dataset) {
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
  return Status::Ok();
}

double MeasuredCameraRate(const Dataset& dataset) {
  if (!dataset.tracks.empty()) {
    return MeasuredRate(dataset.tracks.front().stamp_ns, dataset.tracks.back().stamp_ns,
                        dataset.tracks.size());
  }
  if (!dataset.images.empty()) {
    return MeasuredRate(dataset.images.front().stamp_ns, dataset.images.back().stamp_ns,
                        dataset.images.size());
  }
  return MeasuredRate(dataset.camera_stamps.front(), dataset.camera_stamps.back(),
                      dataset.camera_stamps.size());
}

}  // namespace

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

Status ReadCameraFolder(const std::string& folder, Dataset* dataset) {
  const Result<CameraSensor> sensor = ReadCameraSensor((fs::path(folder) / "sensor.yaml").string());
  if (!sensor.ok()) {
    return sensor.status();
  }
  dataset->rig.camera = sensor->camera;
  dataset->rig.T_BC = sensor->T_BC;
  dataset->rig.camera_time_offset_s = sensor->time_offset_s;
  ALIDADE_RETURN_IF_ERROR(ReadSources(folder, dataset));
  dataset->camera_rate_hz = sensor->rate_hz.value_or(MeasuredCameraRate(*dataset));
  return Status::Ok();
}

Status ReadExtraCameras(const std::string& mav, Dataset* dataset) {
  for (int k = 1; fs::is_directory(fs::path(mav) / ("cam" + std::to_string(k))); ++k) {
    const fs::path folder = fs::path(mav) / ("cam" + std::to_string(k));
    if (!fs::exists(folder / "tracks.csv")) {
      continue;
    }
    const Result<CameraSensor> sensor = ReadCameraSensor((folder / "sensor.yaml").string());
    ALIDADE_RETURN_IF_ERROR(sensor.status());
    Result<std::vector<TrackFrame>> frames = ReadTracks((folder / "tracks.csv").string());
    ALIDADE_RETURN_IF_ERROR(frames.status());
    dataset->extra_cameras.push_back(
        {sensor->camera, sensor->T_BC, sensor->time_offset_s, std::move(frames).value()});
  }
  return Status::Ok();
}

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

}  // namespace alidade
