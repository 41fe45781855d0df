#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "eval/simulation/sim_camera.h"
#include "eval/simulation/sim_imu.h"
#include "eval/simulation/sim_trajectory.h"

namespace alidade::test {

/// Everything the cameras of a configuration see, with the truth beside it.
struct SimScene {
  SimulatorConfig config;
  std::unique_ptr<ContinuousTrajectory> trajectory;
  RigCalibration rig;
  std::vector<ExtraCamera> extra;
  std::vector<Eigen::Vector3d> landmarks;
  SimulatedTracks tracks;

  explicit SimScene(const SimulatorConfig& given, std::uint64_t seed = 3)
      : config(given), trajectory(MakeSimTrajectory(given)) {
    rig = MakeSimRig(config).value();
    extra = MakeExtraCameras(config, rig);
    landmarks = MakeLandmarks(config, *trajectory, seed).value();
    tracks = SimulateTracks(config, *trajectory, rig, landmarks, 0,
                            EvenStamps(0, config.duration_s, config.camera_rate_hz), seed, extra);
  }

  [[nodiscard]] int LandmarkOf(std::int64_t track) const {
    return tracks.landmark_of_track[static_cast<std::size_t>(track)];
  }
  [[nodiscard]] bool IsOutlier(std::int64_t track) const {
    return tracks.outlier_of_track[static_cast<std::size_t>(track)];
  }

  /// Where a camera with this T_BC sees a point at the exposure of a frame; far out when behind it.
  [[nodiscard]] Eigen::Vector2d PixelOf(const TrackFrame& frame, const Eigen::Vector3d& p_W,
                                        const Pose& T_BC) const {
    const double t = SecondsBetween(0, frame.stamp_ns) + config.camera_time_offset_s;
    Eigen::Vector2d pixel(1e9, 1e9);
    const bool visible = rig.camera.Project((trajectory->At(t).nav.T_WB() * T_BC).Inverse() * p_W, &pixel);
    return visible ? pixel : Eigen::Vector2d(1e9, 1e9);
  }
  [[nodiscard]] Eigen::Vector2d TruePixel(const TrackFrame& frame, int landmark) const {
    return PixelOf(frame, landmarks[static_cast<std::size_t>(landmark)], rig.T_BC);
  }
  /// Observed minus true pixel.
  [[nodiscard]] Eigen::Vector2d ErrorOf(const TrackFrame& frame, const TrackObservation& observation) const {
    return observation.pixel - TruePixel(frame, LandmarkOf(observation.track_id));
  }

  /// Frame number and pixel of each observation, by track.
  [[nodiscard]] std::map<std::int64_t, std::vector<std::pair<int, Eigen::Vector2d>>> ByTrack() const {
    std::map<std::int64_t, std::vector<std::pair<int, Eigen::Vector2d>>> list;
    for (std::size_t k = 0; k < tracks.frames.size(); ++k) {
      for (const TrackObservation& observation : tracks.frames[k].observations) {
        list[observation.track_id].emplace_back(static_cast<int>(k), observation.pixel);
      }
    }
    return list;
  }
};

/// A minute of the figure-8 of the paper's simulation.
inline SimulatorConfig MinuteConfig() {
  SimulatorConfig config;
  config.duration_s = 60;
  config.path_m = 78;
  return config;
}

}  // namespace alidade::test
