#pragma once

#include <cstdint>
#include <vector>

#include "core/estimator/measurement_log.h"
#include "eval/dataset/dataset.h"
#include "eval/simulation/continuous_trajectory.h"
#include "eval/simulation/sim_landmarks.h"
#include "eval/simulation/sim_rig.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

struct SimulatedTracks {
  std::vector<TrackFrame> frames;      ///< one a camera stamp, in order; observations sorted by id
  std::vector<int> landmark_of_track;  ///< index of the landmark that track id i observed first
  std::vector<bool> outlier_of_track;  ///< whether track i has wrong observations
  /// Frames of each extra camera, at the same stamps.
  std::vector<std::vector<TrackFrame>> extra_frames;
};

/// Observations of the landmarks at the camera stamps (trajectory time 0 is start_ns; a frame is exposed at
/// its stamp plus rig.camera_time_offset_s). Tracks alive stay while their landmark is visible and
/// mean_track_loss spares them; free places up to max_features go to visible landmarks in random order. Ids
/// count up from 0 and are never used again: a landmark that comes back starts a new track. Pixels are raw
/// (distorted).
///
/// Faults (outlier_rate, sim_fault.h): the pixel of a single wrong observation is clamped into the image; a
/// track whose wrong pixel leaves the image ends, as does one whose moving landmark leaves the view. Tracks
/// that swap wait for the next one due to do so.
///
/// Extra cameras see every landmark that the first one tracks and that is in their view, right and under the
/// same id; places that are left go to tracks of their own, with ids from k * kExtraCameraIds on, which have
/// faults of their own.
[[nodiscard]] SimulatedTracks SimulateTracks(const SimulatorConfig& config,
                                             const ContinuousTrajectory& trajectory,
                                             const RigCalibration& rig,
                                             const std::vector<Eigen::Vector3d>& landmarks, TimeNs start_ns,
                                             const std::vector<TimeNs>& stamps, std::uint64_t seed,
                                             const std::vector<ExtraCamera>& extra_cameras = {});

/// Puts the frames into the data set, whose extra cameras are those that were simulated.
void TakeTracks(SimulatedTracks tracks, Dataset* dataset);

/// Throws landmarks (sim_landmarks.h) and puts the tracks that the rig and its extra cameras see of them at
/// the camera stamps into the data set. Errors: those of MakeLandmarks.
Status AddSimulatedTracks(const SimulatorConfig& config, const ContinuousTrajectory& trajectory,
                          TimeNs start_ns, unsigned seed, Dataset* dataset);

/// Ids of the tracks that camera k alone sees start at k times this.
inline constexpr std::int64_t kExtraCameraIds = 1'000'000'000;

}  // namespace alidade
