#pragma once

#include "core/estimator/measurement_log.h"
#include "eval/calibrate/camera_gyro_fit.h"
#include "eval/dataset/dataset_findings.h"

namespace alidade {

/// The pairs of a log for a fit, with a motion that suits its camera; `most`: at most that many, spread
/// evenly.
[[nodiscard]] std::vector<FramePair> FramePairsOf(const MeasurementLog& log, std::size_t most);
/// The same of the log's long tables.
[[nodiscard]] std::vector<FramePair> FramePairsOf(const RigCalibration& rig, const LogTables& tables,
                                                  std::size_t most);

/// The camera of a sheet as a start for a fit.
[[nodiscard]] CameraGyroModel ModelOfSheet(const RigCalibration& rig);

/// Compares the rotation of the images with the gyroscope. First the norms of both (CorrelateGyro): clocks
/// that differ by more than 0.3 s, or rates in another unit than rad/s, are an error, and nothing else is
/// compared. Then the epipolar geometry: finds time offset, axes, rotation, focal length and readout time
/// where they differ from the sheet by more than five standard deviations and by more than matters (2 ms, 0.5
/// deg, 1 %, 3 ms), as warnings; other axes than the sheet's are an error. A fact names what was compared, or
/// why nothing was. most_pairs: of images, spread evenly over the recording.
void CheckCameraAgainstGyro(const MeasurementLog& log, std::size_t most_pairs, Findings* findings);
void CheckCameraAgainstGyro(const RigCalibration& rig, const LogTables& tables, std::size_t most_pairs,
                            Findings* findings);

}  // namespace alidade
