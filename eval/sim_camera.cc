#include "eval/sim_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/random.h"
#include "eval/sensor_yaml.h"

namespace alidade {
namespace {

/// One track that is alive.
struct LiveTrack {
  std::int64_t id = 0;
  int landmark = 0;
  TimeNs born_ns = 0;
  Eigen::Vector2d drift_px_per_s = Eigen::Vector2d::Zero();
};

/// Draws the wrongness of observations and tracks; streams of its own, so that outliers change no other
/// number.
class OutlierSource {
 public:
  OutlierSource(const SimulatorConfig& config, std::uint64_t seed)
      : config_(config), stream_(seed, "camera.outliers") {}

  Eigen::Vector2d Drift() {
    return config_.outlier_kind == SimOutlierKind::kDrift ? MaybeVector() : Eigen::Vector2d(0, 0);
  }
  Eigen::Vector2d Jump() {
    return config_.outlier_kind == SimOutlierKind::kJump ? MaybeVector() : Eigen::Vector2d(0, 0);
  }

 private:
  /// Zero, or with probability outlier_rate a vector of random direction.
  Eigen::Vector2d MaybeVector() {
    if (!stream_.Chance(config_.outlier_rate)) {
      return Eigen::Vector2d::Zero();
    }
    const double angle = stream_.Uniform(0, 2 * std::numbers::pi);
    const double size = config_.outlier_px * stream_.Uniform(0.5, 1.5);
    return {size * std::cos(angle), size * std::sin(angle)};
  }

  const SimulatorConfig& config_;
  RandomStream stream_;
};

/// Keeps, drops and starts tracks frame by frame.
class TrackSimulator {
 public:
  TrackSimulator(const SimulatorConfig& config, const CameraModel& camera,
                 const std::vector<Eigen::Vector3d>& landmarks, std::uint64_t seed)
      : config_(config),
        camera_(camera),
        landmarks_(landmarks),
        loss_(seed, "camera.track_loss"),
        selection_(seed, "camera.selection"),
        noise_(seed, "camera.pixel_noise"),
        outliers_(config, seed) {}

  TrackFrame Observe(TimeNs stamp_ns, const Pose& T_WC) {
    ProjectLandmarks(T_WC);
    DropLostTracks();
    StartTracks(stamp_ns);
    TrackFrame frame;
    frame.stamp_ns = stamp_ns;
    frame.observations.reserve(live_.size());
    for (const LiveTrack& track : live_) {
      frame.observations.push_back({track.id, Measure(track, stamp_ns)});
    }
    return frame;
  }

  SimulatedTracks TakeResult() { return std::move(result_); }

 private:
  void ProjectLandmarks(const Pose& T_WC) {
    const Pose T_CW = T_WC.Inverse();
    pixels_.assign(landmarks_.size(), std::nullopt);
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      const Eigen::Vector3d p_C = T_CW * landmarks_[i];
      Eigen::Vector2d pixel;
      if (p_C.squaredNorm() <= config_.max_range_m * config_.max_range_m && camera_.Project(p_C, &pixel) &&
          camera_.InImage(pixel, config_.border_px)) {
        pixels_[i] = pixel;
      }
    }
  }

  void DropLostTracks() {
    is_tracked_.assign(landmarks_.size(), false);
    std::vector<LiveTrack> kept;
    for (const LiveTrack& track : live_) {
      const auto landmark = static_cast<std::size_t>(track.landmark);
      const bool lost = loss_.Chance(config_.mean_track_loss);
      if (pixels_[landmark].has_value() && !lost) {
        kept.push_back(track);
        is_tracked_[landmark] = true;
      }
    }
    live_ = std::move(kept);
  }

  void StartTracks(TimeNs stamp_ns) {
    std::vector<int> candidates;
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      if (pixels_[i].has_value() && !is_tracked_[i]) {
        candidates.push_back(static_cast<int>(i));
      }
    }
    selection_.Shuffle(&candidates);
    for (const int landmark : candidates) {
      if (live_.size() >= static_cast<std::size_t>(config_.max_features)) {
        break;
      }
      // Ids grow with birth, so live_ stays sorted by id.
      LiveTrack track;
      track.id = static_cast<std::int64_t>(result_.landmark_of_track.size());
      track.landmark = landmark;
      track.born_ns = stamp_ns;
      track.drift_px_per_s = outliers_.Drift();
      result_.landmark_of_track.push_back(landmark);
      result_.outlier_of_track.push_back(!track.drift_px_per_s.isZero());
      live_.push_back(track);
    }
  }

  Eigen::Vector2d Measure(const LiveTrack& track, TimeNs stamp_ns) {
    const double noise_u = noise_.Normal();
    const double noise_v = noise_.Normal();
    const Eigen::Vector2d noise_px = config_.pixel_noise_px * Eigen::Vector2d(noise_u, noise_v);
    Eigen::Vector2d pixel = *pixels_[static_cast<std::size_t>(track.landmark)] + noise_px;
    const Eigen::Vector2d wrong_px =
        track.drift_px_per_s * SecondsBetween(track.born_ns, stamp_ns) + outliers_.Jump();
    if (!wrong_px.isZero()) {
      result_.outlier_of_track[static_cast<std::size_t>(track.id)] = true;
      pixel += wrong_px;
      pixel.x() = std::clamp(pixel.x(), 0.0, camera_.width_px() - 1.0);
      pixel.y() = std::clamp(pixel.y(), 0.0, camera_.height_px() - 1.0);
    }
    return pixel;
  }

  const SimulatorConfig& config_;
  const CameraModel& camera_;
  const std::vector<Eigen::Vector3d>& landmarks_;
  RandomStream loss_;
  RandomStream selection_;
  RandomStream noise_;
  OutlierSource outliers_;
  std::vector<LiveTrack> live_;
  std::vector<std::optional<Eigen::Vector2d>> pixels_;  ///< noise-free; empty for a landmark out of view
  std::vector<bool> is_tracked_;
  SimulatedTracks result_;
};

/// The rig with the camera of a dataset folder.
Result<RigCalibration> RigOfDataset(const SimulatorConfig& config) {
  const Result<CameraSensor> sensor = ReadCameraSensor(config.trajectory_file + "/mav0/cam0/sensor.yaml");
  ALIDADE_RETURN_IF_ERROR(sensor.status());
  RigCalibration rig;
  rig.camera = sensor->camera;
  rig.T_BC = sensor->T_BC;
  rig.imu_noise = config.imu_noise;
  rig.camera_time_offset_s = sensor->time_offset_s;
  return rig;
}

}  // namespace

Result<RigCalibration> MakeSimRig(const SimulatorConfig& config) {
  if (config.camera_view == SimCameraView::kDataset) {
    return RigOfDataset(config);
  }
  std::vector<double> coefficients;
  for (int i = 0; i < CoefficientCount(config.distortion); ++i) {
    coefficients.push_back(config.distortion_coefficients[i]);
  }
  const Eigen::Vector4d intrinsics(config.focal_px, config.focal_px, 0.5 * config.width_px,
                                   0.5 * config.height_px);
  Result<CameraModel> camera =
      CameraModel::Create(config.distortion, intrinsics, coefficients, config.width_px, config.height_px);
  if (!camera.ok()) {
    return Status::Config("simulated camera: " + camera.message());
  }
  RigCalibration rig;
  rig.camera = *camera;
  // Columns: the camera's right, down and forward axes in the body frame (forward, left, up).
  if (config.camera_view == SimCameraView::kForward) {
    rig.T_BC.rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  } else {
    rig.T_BC.rotation << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  }
  rig.T_BC.translation = config.camera_lever_arm_m;
  rig.imu_noise = config.imu_noise;
  rig.camera_time_offset_s = config.camera_time_offset_s;
  return rig;
}

SimulatedTracks SimulateTracks(const SimulatorConfig& config, const ContinuousTrajectory& trajectory,
                               const RigCalibration& rig, const std::vector<Eigen::Vector3d>& landmarks,
                               TimeNs start_ns, const std::vector<TimeNs>& stamps, std::uint64_t seed) {
  TrackSimulator simulator(config, rig.camera, landmarks, seed);
  std::vector<TrackFrame> frames;
  frames.reserve(stamps.size());
  for (const TimeNs stamp_ns : stamps) {
    const double exposure_s = SecondsBetween(start_ns, stamp_ns) + rig.camera_time_offset_s;
    frames.push_back(simulator.Observe(stamp_ns, trajectory.At(exposure_s).nav.T_WB() * rig.T_BC));
  }
  SimulatedTracks tracks = simulator.TakeResult();
  tracks.frames = std::move(frames);
  return tracks;
}

}  // namespace alidade
