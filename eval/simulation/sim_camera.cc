#include "eval/simulation/sim_camera.h"

#include <deque>
#include <string>
#include <utility>

#include "eval/simulation/sim_track_source.h"

namespace alidade {

SimulatedTracks SimulateTracks(const SimulatorConfig& config, const ContinuousTrajectory& trajectory,
                               const RigCalibration& rig, const std::vector<Eigen::Vector3d>& landmarks,
                               TimeNs start_ns, const std::vector<TimeNs>& stamps, std::uint64_t seed,
                               const std::vector<ExtraCamera>& extra_cameras) {
  TrackSource first(config, rig.camera, landmarks, seed, "camera", 0);
  std::deque<TrackSource> others;
  for (std::size_t k = 0; k < extra_cameras.size(); ++k) {
    others.emplace_back(config, extra_cameras[k].camera, landmarks, seed, "camera" + std::to_string(k + 1),
                        static_cast<std::int64_t>(k + 1) * kExtraCameraIds);
  }
  SimulatedTracks tracks;
  tracks.frames.reserve(stamps.size());
  tracks.extra_frames.resize(extra_cameras.size());
  for (const TimeNs stamp_ns : stamps) {
    const double exposure_s = SecondsBetween(start_ns, stamp_ns) + rig.camera_time_offset_s;
    const auto body_after = [&](double later_s) { return trajectory.At(exposure_s + later_s).nav.T_WB(); };
    const ImageExposure exposure =
        rig.line_delay_s == 0 ? ImageExposure(body_after(0) * rig.T_BC)
                              : ImageExposure([&](double later_s) { return body_after(later_s) * rig.T_BC; },
                                              rig.line_delay_s, rig.camera.height_px());
    tracks.frames.push_back(first.Observe(stamp_ns, exposure, {}));
    const std::vector<TrackedPoint> tracked = others.empty() ? std::vector<TrackedPoint>() : first.Tracked();
    for (std::size_t k = 0; k < others.size(); ++k) {
      // Their sheets have no line delay.
      const ImageExposure at_once(body_after(0) * extra_cameras[k].T_BC);
      tracks.extra_frames[k].push_back(others[k].Observe(stamp_ns, at_once, tracked));
    }
  }
  tracks.landmark_of_track = first.landmark_of_track();
  tracks.outlier_of_track = first.outlier_of_track();
  return tracks;
}

void TakeTracks(SimulatedTracks tracks, Dataset* dataset) {
  dataset->frames = std::move(tracks.frames);
  for (std::size_t k = 0; k < dataset->extra_cameras.size(); ++k) {
    dataset->extra_cameras[k].frames = std::move(tracks.extra_frames[k]);
  }
}

Status AddSimulatedTracks(const SimulatorConfig& config, const ContinuousTrajectory& trajectory,
                          TimeNs start_ns, unsigned seed, Dataset* dataset) {
  const Result<std::vector<Eigen::Vector3d>> landmarks = MakeLandmarks(config, trajectory, seed);
  ALIDADE_RETURN_IF_ERROR(landmarks.status());
  dataset->extra_cameras = MakeExtraCameras(config, dataset->rig);
  TakeTracks(SimulateTracks(config, trajectory, dataset->rig, *landmarks, start_ns, dataset->camera_stamps,
                            seed, dataset->extra_cameras),
             dataset);
  return Status::Ok();
}

}  // namespace alidade
