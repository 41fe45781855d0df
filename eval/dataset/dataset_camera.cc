#include "eval/dataset/dataset_camera.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "eval/dataset/dataset_images.h"
#include "eval/dataset/dataset_tracks.h"
#include "eval/dataset/log_hasher.h"
#include "eval/dataset/log_tables.h"
#include "eval/dataset/sensor_table.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/dataset/stale_parts.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

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

/// Adds the frames that saw nothing to those of tracks.csv.
Status CompleteFrames(const std::string& tracks_path, const DatasetStorage& storage, Dataset* dataset) {
  if (dataset->tables != nullptr) {
    const Table<TrackFrame> tracks =
        std::exchange(dataset->tables->frames, Table<TrackFrame>::InFile(storage.spool_folder));
    return AddEmptyFrames(tracks_path, dataset->camera_stamps, tracks,
                          [dataset](const TrackFrame& frame) { return dataset->tables->frames.Add(frame); });
  }
  std::vector<TrackFrame> frames;
  ALIDADE_RETURN_IF_ERROR(AddEmptyFrames(tracks_path, dataset->camera_stamps, Table(dataset->frames),
                                         [&frames](const TrackFrame& frame) {
                                           frames.push_back(frame);
                                           return Status::Ok();
                                         }));
  dataset->frames = std::move(frames);
  return Status::Ok();
}

/// The three sources a camera folder may hold; at least one must be there.
Status ReadSources(const fs::path& folder, const DatasetStorage& storage, Dataset* dataset) {
  const std::string tracks_path = (folder / "tracks.csv").string();
  if (MayExist(tracks_path) && dataset->tables != nullptr) {
    dataset->tables->frames = Table<TrackFrame>::InFile(storage.spool_folder);
    ALIDADE_RETURN_IF_ERROR(ReadTracks(tracks_path, &dataset->tables->frames));
  } else if (MayExist(tracks_path)) {
    Result<std::vector<TrackFrame>> tracks = ReadTracks(tracks_path);
    ALIDADE_RETURN_IF_ERROR(tracks.status());
    dataset->frames = std::move(tracks).value();
  }
  if (MayExist((folder / "timestamps.csv").string())) {
    Result<std::vector<TimeNs>> stamps = ReadStamps((folder / "timestamps.csv").string());
    ALIDADE_RETURN_IF_ERROR(stamps.status());
    dataset->camera_stamps = std::move(stamps).value();
  }
  if (MayExist((folder / "data.csv").string())) {
    Result<std::vector<ImageEntry>> images =
        ReadImages(folder.string(), dataset->rig.camera, storage.follow_links);
    ALIDADE_RETURN_IF_ERROR(images.status());
    dataset->images = std::move(images).value();
  }
  const bool has_tracks = !TablesOf(*dataset).frames.empty();
  if (!has_tracks && dataset->camera_stamps.empty() && dataset->images.empty()) {
    return Status::Input(folder.string() +
                         ": expected tracks.csv, data.csv with images, or timestamps.csv; found none");
  }
  return has_tracks && !dataset->camera_stamps.empty() ? CompleteFrames(tracks_path, storage, dataset)
                                                       : Status::Ok();
}

double MeasuredCameraRate(const Dataset& dataset) {
  if (const Table<TrackFrame> frames = TablesOf(dataset).frames; !frames.empty()) {
    return MeasuredRate(frames.front().stamp_ns, frames.back().stamp_ns, frames.size());
  }
  if (!dataset.images.empty()) {
    return MeasuredRate(dataset.images.front().stamp_ns, dataset.images.back().stamp_ns,
                        dataset.images.size());
  }
  return MeasuredRate(dataset.camera_stamps.front(), dataset.camera_stamps.back(),
                      dataset.camera_stamps.size());
}

Status ReadFirstCamera(const fs::path& folder, const DatasetStorage& storage, Dataset* dataset) {
  const Result<CameraSensor> sensor = ReadCameraSensor((folder / "sensor.yaml").string());
  ALIDADE_RETURN_IF_ERROR(sensor.status());
  dataset->rig.camera = sensor->camera;
  dataset->rig.T_BC = sensor->T_BC;
  dataset->rig.camera_time_offset_s = sensor->time_offset_s;
  dataset->rig.line_delay_s = sensor->line_delay_s;
  ALIDADE_RETURN_IF_ERROR(ReadSources(folder, storage, dataset));
  dataset->camera_rate_hz = sensor->rate_hz.value_or(MeasuredCameraRate(*dataset));
  return Status::Ok();
}

/// cam1, cam2, ... where they hold tracks.csv.
Status ReadExtraCameras(const std::string& mav, const DatasetStorage& storage, Dataset* dataset) {
  for (int k = 1; MayBeFolder(mav + "/cam" + std::to_string(k)); ++k) {
    const fs::path folder = fs::path(mav) / ("cam" + std::to_string(k));
    if (!MayExist((folder / "tracks.csv").string())) {
      continue;
    }
    const Result<CameraSensor> sensor = ReadCameraSensor((folder / "sensor.yaml").string());
    ALIDADE_RETURN_IF_ERROR(sensor.status());
    ExtraCamera& extra = dataset->extra_cameras.emplace_back();
    extra.camera = sensor->camera;
    extra.T_BC = sensor->T_BC;
    extra.camera_time_offset_s = sensor->time_offset_s;
    const std::string path = (folder / "tracks.csv").string();
    if (dataset->tables != nullptr) {
      Table<TrackFrame>& frames =
          dataset->tables->extra_frames.emplace_back(Table<TrackFrame>::InFile(storage.spool_folder));
      ALIDADE_RETURN_IF_ERROR(ReadTracks(path, &frames));
      continue;
    }
    Result<std::vector<TrackFrame>> frames = ReadTracks(path);
    ALIDADE_RETURN_IF_ERROR(frames.status());
    extra.frames = std::move(frames).value();
  }
  return Status::Ok();
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
  for (const TrackFrame& frame : dataset.frames) {
    stamps.push_back(frame.stamp_ns);
    some_empty = some_empty || frame.observations.empty();
  }
  return some_empty ? stamps : std::vector<TimeNs>();
}

/// True when the list of images in the folder is that of the dataset, whose images were put there.
bool HoldsItsImages(const Dataset& dataset, const fs::path& folder) {
  std::error_code error;
  return !dataset.images.empty() &&
         fs::equivalent(fs::path(dataset.images.front().path).parent_path(), folder / "data", error) &&
         !error;
}

/// What another sequence left in the camera folders: the reader would take its tracks, stamps and images for
/// those of this one. Images stay, which nothing lists any more.
Status RemoveStaleCameras(const Dataset& dataset, const std::string& mav) {
  const fs::path first = fs::path(mav) / "cam0";
  if (!HasCamera(dataset) && dataset.gnss != nullptr) {
    ALIDADE_RETURN_IF_ERROR(RemoveStaleFolder(first.string()));
  }
  if (dataset.frames.empty()) {
    ALIDADE_RETURN_IF_ERROR(RemoveStaleFiles(first.string(), {"tracks.csv"}));
  }
  if (StampsToWrite(dataset).empty()) {
    ALIDADE_RETURN_IF_ERROR(RemoveStaleFiles(first.string(), {"timestamps.csv"}));
  }
  if (!HoldsItsImages(dataset, first)) {
    // With the list goes what the renderer wrote beside it.
    ALIDADE_RETURN_IF_ERROR(
        RemoveStaleFiles(first.string(), {"data.csv", "hall.csv", "exposure.csv", "data_pose.csv"}));
  }
  for (const std::string& folder : NumberedFolders(mav, "cam", dataset.extra_cameras.size() + 1)) {
    if (MayExist((fs::path(folder) / "tracks.csv").string())) {  // without, it is no part of a sequence
      ALIDADE_RETURN_IF_ERROR(RemoveStaleFiles(folder, {"tracks.csv", "sensor.yaml"}));
      std::error_code not_empty;
      fs::remove(folder, not_empty);
    }
  }
  return Status::Ok();
}

/// Counts before lists: without them a sample could move between lists and leave the bytes unchanged.
Status AddFrames(const Table<TrackFrame>& frames, LogHasher* hasher) {
  hasher->Add(static_cast<std::uint64_t>(frames.size()));
  return frames.ForEach([hasher](const TrackFrame& frame) {
    hasher->Add(std::int64_t{frame.stamp_ns});
    hasher->Add(static_cast<std::uint64_t>(frame.observations.size()));
    for (const TrackObservation& observation : frame.observations) {
      hasher->Add(observation.track_id);
      hasher->Add(observation.pixel);
      if (observation.noise_ratio != 1) {
        hasher->Add(observation.noise_ratio);
      }
    }
  });
}

}  // namespace

bool HasCamera(const Dataset& dataset) {
  return !TablesOf(dataset).frames.empty() || !dataset.images.empty() || !dataset.camera_stamps.empty();
}

Status ReadCameraFolders(const std::string& mav, const DatasetStorage& storage, Dataset* dataset) {
  const fs::path first = fs::path(mav) / "cam0";
  if (!MayBeFolder(first.string())) {
    return Status::Ok();
  }
  ALIDADE_RETURN_IF_ERROR(ReadFirstCamera(first, storage, dataset));
  return ReadExtraCameras(mav, storage, dataset);
}

std::string ExtraCameraYaml(const Dataset& dataset, size_t k) {
  const ExtraCamera& extra = dataset.extra_cameras[k];
  RigCalibration rig = dataset.rig;
  rig.camera = extra.camera;
  rig.T_BC = extra.T_BC;
  rig.camera_time_offset_s = extra.camera_time_offset_s;
  rig.line_delay_s = 0;
  return CameraSensorYaml(rig, dataset.camera_rate_hz);
}

Status WriteCameraFolders(const Dataset& dataset, const std::string& mav) {
  const fs::path first = fs::path(mav) / "cam0";
  if (!IsItsOwnFolder(dataset, mav)) {
    ALIDADE_RETURN_IF_ERROR(RemoveStaleCameras(dataset, mav));
  }
  if (HasCamera(dataset) || dataset.gnss == nullptr) {
    ALIDADE_RETURN_IF_ERROR(WriteFileAtomically((first / "sensor.yaml").string(),
                                                CameraSensorYaml(dataset.rig, dataset.camera_rate_hz)));
  }
  if (!dataset.frames.empty()) {
    ALIDADE_RETURN_IF_ERROR(WriteTracks(dataset.frames, (first / "tracks.csv").string()));
  }
  if (const std::vector<TimeNs> stamps = StampsToWrite(dataset); !stamps.empty()) {
    ALIDADE_RETURN_IF_ERROR(WriteFileAtomically((first / "timestamps.csv").string(), StampsCsv(stamps)));
  }
  for (size_t k = 0; k < dataset.extra_cameras.size(); ++k) {
    const fs::path folder = fs::path(mav) / ("cam" + std::to_string(k + 1));
    ALIDADE_RETURN_IF_ERROR(
        WriteFileAtomically((folder / "sensor.yaml").string(), ExtraCameraYaml(dataset, k)));
    ALIDADE_RETURN_IF_ERROR(WriteTracks(dataset.extra_cameras[k].frames, (folder / "tracks.csv").string()));
  }
  return Status::Ok();
}

void DigestCamera(const CameraModel& camera, const Pose& T_BC, LogHasher* hasher) {
  hasher->Add(static_cast<std::int64_t>(camera.model()));
  hasher->Add(std::int64_t{camera.width_px()});
  hasher->Add(std::int64_t{camera.height_px()});
  hasher->Add(camera.intrinsics());
  hasher->Add(Eigen::Vector4d(camera.coefficients().head<4>()));
  if (camera.model() == DistortionModel::kMei) {
    hasher->Add(camera.coefficients()[4]);
  }
  hasher->Add(T_BC.rotation);
  hasher->Add(T_BC.translation);
}

Status DigestTracks(const MeasurementLog& log, const LogTables& tables, LogHasher* hasher) {
  ALIDADE_RETURN_IF_ERROR(AddFrames(tables.frames, hasher));
  for (size_t k = 0; k < log.extra_cameras.size(); ++k) {
    const ExtraCamera& extra = log.extra_cameras[k];
    DigestCamera(extra.camera, extra.T_BC, hasher);
    hasher->Add(extra.camera_time_offset_s);
    ALIDADE_RETURN_IF_ERROR(AddFrames(tables.extra_frames[k], hasher));
  }
  return Status::Ok();
}

}  // namespace alidade
