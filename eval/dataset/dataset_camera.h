#pragma once

#include <string>

#include "core/status.h"
#include "eval/dataset/dataset.h"

namespace alidade {

class Findings;
class LogHasher;

// The cameras' part of a sequence: folders cam0, cam1, ... of `mav`.

/// Reads cam0, if it exists: sensor.yaml and those of tracks.csv, timestamps.csv and data.csv (with its
/// images) that exist; then cam1, cam2, ..., consecutively numbered, where they hold tracks.csv. A further
/// camera with images alone is skipped, because the front end tracks cam0 only. Errors (kInput) as
/// ReadDataset's.
Status ReadCameraFolders(const std::string& mav, const DatasetStorage& storage, Dataset* dataset);
/// Writes tracks and stamps; images are not written. Without camera and with GNSS there is no cam0.
Status WriteCameraFolders(const Dataset& dataset, const std::string& mav);

/// Whether there is a cam0: tracks, images or stamps.
[[nodiscard]] bool HasCamera(const Dataset& dataset);

/// sensor.yaml of extra_cameras[k].
[[nodiscard]] std::string ExtraCameraYaml(const Dataset& dataset, size_t k);

/// Model and extrinsics of a camera.
void DigestCamera(const CameraModel& camera, const Pose& T_BC, LogHasher* hasher);
/// The tracks of all cameras and the calibration of those after the first, which is part of the rig.
Status DigestTracks(const MeasurementLog& log, const LogTables& tables, LogHasher* hasher);

/// Rate, gaps, span and tracks of cam0.
void CheckCamera(const Dataset& dataset, Findings* findings);
/// What the further cameras are used for.
void CheckExtraCameras(const Dataset& dataset, Findings* findings);

}  // namespace alidade
