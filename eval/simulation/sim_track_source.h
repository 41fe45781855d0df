#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/navigation_state.h"
#include "core/random.h"
#include "core/track_frame.h"
#include "eval/simulation/image_exposure.h"
#include "eval/simulation/sim_fault.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// A track that another camera of the rig has.
struct TrackedPoint {
  std::int64_t id = 0;
  int landmark = 0;
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  ///< where it is now
};

/// Keeps, drops and starts the tracks of one camera, frame by frame.
///
/// In every frame each landmark is dealt its numbers (loss, priority, noise), seen or not. So the fate of one
/// track moves no number of another, and an effect that is switched on leaves the draws of the others.
class TrackSource {
 public:
  /// `camera_name` names the random streams; ids start at `first_id`. Keeps references to the arguments.
  TrackSource(const SimulatorConfig& config, const CameraModel& camera,
              const std::vector<Eigen::Vector3d>& landmarks, std::uint64_t seed,
              const std::string& camera_name, std::int64_t first_id);

  /// The next frame. `elsewhere` are tracks of another camera: those in view are observed under their ids,
  /// without faults, and have precedence.
  TrackFrame Observe(TimeNs stamp_ns, const ImageExposure& exposure,
                     const std::vector<TrackedPoint>& elsewhere);

  /// The tracks alive after Observe.
  [[nodiscard]] std::vector<TrackedPoint> Tracked() const;
  /// Of track first_id + i.
  [[nodiscard]] const std::vector<int>& landmark_of_track() const { return landmark_of_track_; }
  [[nodiscard]] const std::vector<bool>& outlier_of_track() const { return outlier_of_track_; }

 private:
  struct LiveTrack {
    std::int64_t id = 0;
    int landmark = 0;
    int frames = 0;  ///< since the first
    TimeNs born_ns = 0;
    TrackFault fault;
    bool swapped = false;
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< without noise, with the track's fault
  };

  void Deal();
  void ProjectLandmarks();
  void TakeOver(const std::vector<TrackedPoint>& elsewhere, TrackFrame* frame);
  void DropLostTracks();
  void SwapTracks();
  void StartTracks(std::size_t places_taken);
  void MeasureTracks(TrackFrame* frame);
  void SwapObservations(const std::vector<std::size_t>& pool, TrackFrame* frame);

  [[nodiscard]] std::optional<Eigen::Vector2d> See(const Eigen::Vector3d& p_W) const;
  [[nodiscard]] Eigen::Vector3d PositionOf(const LiveTrack& track) const;
  /// Where the track appears, its fault included; none when that is out of view.
  [[nodiscard]] std::optional<Eigen::Vector2d> AppearanceOf(const LiveTrack& track) const;
  [[nodiscard]] Eigen::Vector2d Clamped(const Eigen::Vector2d& pixel) const;
  void MarkWrong(const LiveTrack& track);

  const SimulatorConfig& config_;
  const CameraModel& camera_;
  const std::vector<Eigen::Vector3d>& landmarks_;
  std::int64_t first_id_;
  RandomStream loss_;
  RandomStream selection_;
  RandomStream noise_;
  RandomStream ratio_;
  FaultSource faults_;
  // Of the frame at hand.
  int frame_ = -1;
  TimeNs stamp_ns_ = 0;
  const ImageExposure* exposure_ = nullptr;
  Pose T_CW_;  ///< when the middle row is exposed
  std::vector<double> loss_draw_, priority_;
  std::vector<Eigen::Vector2d> noise_px_;
  std::vector<double> noise_ratio_;
  std::vector<std::optional<Eigen::Vector2d>> pixels_;  ///< noise-free; empty for a landmark out of view
  std::vector<bool> is_tracked_;
  std::vector<LiveTrack> live_;  ///< by id
  std::vector<int> landmark_of_track_;
  std::vector<bool> outlier_of_track_;
};

}  // namespace alidade
