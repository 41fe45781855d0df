#pragma once

#include <deque>
#include <vector>

#include "core/estimator_config.h"
#include "core/imu_buffer.h"
#include "core/preintegration.h"
#include "core/track_frame.h"
#include "core/visual_observation.h"

namespace alidade {

/// Scale of the Cauchy kernel on every whitened residual of the dynamic start.
inline constexpr double kCauchyScale = 3.0;

/// One track over the frames of a window.
struct SharedTrack {
  std::int64_t track_id = 0;
  std::vector<int> frames;  ///< indices into DynamicWindow::stamps_ns, increasing
  std::vector<NormalizedObservation> observations;
};

/// The data one dynamic initialisation works on: a few frames spread over the newest seconds, the tracks that
/// two or more of them share, and the inertial samples between them.
struct DynamicWindow {
  std::vector<TimeNs> stamps_ns;            ///< in IMU time, increasing; M frames
  std::vector<std::vector<ImuSample>> imu;  ///< M-1 intervals, both ends interpolated
  std::vector<SharedTrack> tracks;          ///< longest first
};

/// Takes frames over at most `longest_s` up to the newest one, at least init.dynamic_min_frames of them
/// (sparse frames stretch the window), at most kMaxWindowFrames, evenly thinned. Stamps of `frames` are in
/// IMU time. Errors (kDiverged): too few frames, less than init.dynamic_window_s, or inertial samples that do
/// not cover them.
inline constexpr int kMaxWindowFrames = 30;
inline constexpr int kMaxWindowTracks = 150;
Status BuildDynamicWindow(const EstimatorConfig& config, const CameraModel& camera,
                          const std::deque<TrackFrame>& frames, double longest_s, ImuBuffer* imu,
                          DynamicWindow* window);

/// One preintegration an interval, about `bias`.
[[nodiscard]] std::vector<Preintegration> PreintegrateWindow(const DynamicWindow& window, const ImuBias& bias,
                                                             const ImuNoise& noise);

/// Bearing of an observation in its camera, unit length, and its angular deviation [rad].
[[nodiscard]] Eigen::Vector3d BearingOf(const NormalizedObservation& observation);
[[nodiscard]] double AngularDeviation(const NormalizedObservation& observation);

}  // namespace alidade
