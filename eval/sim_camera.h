#pragma once

#include <cstdint>
#include <vector>

#include "core/measurement_log.h"
#include "eval/continuous_trajectory.h"
#include "eval/sim_landmarks.h"
#include "eval/simulator.h"

namespace alidade {

/// The simulated rig: camera model, T_BC, IMU noise and camera time offset, all exactly known to the
/// estimators. camera_view: dataset takes camera model, T_BC and time offset from cam0/sensor.yaml of the
/// dataset folder in trajectory_file. Errors: a lens model that CameraModel::Create refuses (kConfig), a
/// folder without calibration (kInput).
Result<RigCalibration> MakeSimRig(const SimulatorConfig& config);

struct SimulatedTracks {
  std::vector<TrackFrame> frames;      ///< one a camera stamp, in order; observations sorted by id
  std::vector<int> landmark_of_track;  ///< index of the landmark that track id i observes
  std::vector<bool> outlier_of_track;  ///< whether track i has wrong observations
};

/// Observations of the landmarks at the camera stamps (trajectory time 0 is start_ns; a frame is exposed at
/// its stamp plus rig.camera_time_offset_s). Tracks alive stay while their landmark is visible and
/// mean_track_loss spares them; free places up to max_features go to visible landmarks in random order. Ids
/// count up from 0 and are never used again: a landmark that comes back starts a new track. Pixels are raw
/// (distorted). Outlier pixels are clamped into the image.
[[nodiscard]] SimulatedTracks SimulateTracks(const SimulatorConfig& config,
                                             const ContinuousTrajectory& trajectory,
                                             const RigCalibration& rig,
                                             const std::vector<Eigen::Vector3d>& landmarks, TimeNs start_ns,
                                             const std::vector<TimeNs>& stamps, std::uint64_t seed);

}  // namespace alidade
