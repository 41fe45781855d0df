#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/body_motion.h"
#include "core/clock_state.h"
#include "core/landmark_solver.h"
#include "core/pixel_noise.h"
#include "core/preintegration.h"
#include "core/rest_model.h"
#include "core/track_frame.h"
#include "core/visual_observation.h"
#include "smoother/manifold/first_estimate.h"
#include "smoother/window/frame_epoch.h"
#include "smoother/window/frame_measurement.h"
#include "smoother/window/window_calibration.h"

namespace alidade {

/// One frame of the window. `nav` and `bias` are the parameter blocks the solver works on
/// (smoother/manifold/nav_state_manifold.h).
struct WindowFrame {
  TimeNs stamp_ns = 0;
  int index = 0;  ///< position in the window, 0 the oldest
  std::array<double, 10> nav{};
  std::array<double, 6> bias{};
  std::vector<ImuSample> imu;                    ///< from the previous frame to this one; empty in the first
  std::optional<Preintegration> preintegration;  ///< of `imu`, at the previous frame's bias
  std::optional<RestMeasurement> rest;           ///< set when the rig stood still in this frame
  bool repeated = false;                         ///< TrackFrame::repeated: without an image of its own
  // With an estimated time offset: the camera saw from where the body is later by the present offset less
  // this one, moving on at these rates (core/calibration.h, BodyRates).
  double time_offset_s = 0;           ///< that placed the frame in IMU time
  std::optional<MeasuredTurn> turn;   ///< measured at the frame
  Vector6d rates = Vector6d::Zero();  ///< kept fixed in a solve
  BodyMotion motion;                  ///< likewise, for the rows of a rolling shutter
  /// With smoother.first_estimates, once the prior holds the frame.
  std::optional<FirstEstimate> first;
  // Once aligned with GNSS (smoother/sliding/gnss_window.h).
  std::optional<std::array<double, ClockState::kSize>> clock;  ///< a parameter block
  bool clock_anew = false;                                     ///< the clock before does not predict this one
  std::vector<FrameEpoch> epochs;                              ///< from this frame to the next
  std::vector<FrameMeasurement> measurements;                  ///< likewise, of the other sensors

  [[nodiscard]] NavState nav_state() const;
  [[nodiscard]] ImuBias imu_bias() const;
  /// Null unless the frame has one.
  [[nodiscard]] const FirstEstimate* first_estimate() const { return first ? &*first : nullptr; }
  /// Precondition: clock.
  [[nodiscard]] Vector6d clock_state() const { return Eigen::Map<const Vector6d>(clock->data()); }
};

/// What moves the frame's camera with the time offset and within the image, at its present state.
void UpdateRates(WindowFrame* frame);

/// Frames in time order; the index of each is its place.
using WindowFrames = std::vector<std::unique_ptr<WindowFrame>>;

/// One observation of a track inside the window.
struct WindowView {
  const WindowFrame* frame = nullptr;
  NormalizedObservation observation;
  // Whatever the intrinsics are:
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< what was seen
  double root_weight_per_px = 1;                    ///< whitens the pixel
};

/// A landmark seen in the window. The first view is its base. A SLAM feature instead has columns in the prior
/// (LinearPrior::Landmark) and is anchored in a frame of the window, seen there or not.
struct WindowTrack {
  std::int64_t id = 0;
  std::vector<WindowView> views;  ///< in time order
  /// (x, y, rho): bearing on plane() of the base, or of the anchor, and inverse depth [1/m]; set when
  /// has_landmark.
  Eigen::Vector3d landmark = Eigen::Vector3d::Zero();
  const WindowFrame* anchor = nullptr;  ///< of a SLAM feature
  BearingPlane anchor_plane;            ///< likewise
  bool has_landmark = false;            ///< its depth is known from parallax
  DepthPrior depth_prior;               ///< stands in for parallax while has_landmark is false
  bool alive = false;                   ///< seen in the newest frame with an image of its own
  bool degenerate = false;              ///< at the last solve its views had no depth

  /// Degrees of freedom of its residuals: a SLAM feature's landmark is mostly the prior's.
  [[nodiscard]] int dof() const { return 2 * static_cast<int>(views.size()) - (anchor != nullptr ? 0 : 3); }
  /// Of the landmark's coordinates: that of the base's observation, or of the anchor. Precondition: a view or
  /// an anchor.
  [[nodiscard]] const BearingPlane& plane() const {
    return anchor != nullptr ? anchor_plane : views.front().observation.plane;
  }
  /// Multiplies the information of all observations so far.
  void ScaleInformation(double factor);
  /// Forgets the observations of these indices.
  void RemoveViews(std::vector<int> indices);
  /// The landmark's coordinates were those of a view that is gone.
  void LoseBase() {
    has_landmark = false;
    depth_prior = {};
  }
  /// Forgets all observations; the next one starts the track anew.
  void Restart() {
    views.clear();
    anchor = nullptr;
    has_landmark = false;
    depth_prior = {};
  }
};

/// Frames and tracks of a sliding window, with the bookkeeping that keeps them consistent. Frames keep their
/// address for life.
class Window {
 public:
  void Clear();
  WindowFrame& AddFrame(std::unique_ptr<WindowFrame> frame);
  /// Adds the newest frame's observations to its tracks. Returns how many lay outside the camera model's
  /// domain or had no valid noise. Not for a frame without an image of its own, as that of a measurement: it
  /// neither ends nor extends tracks.
  int AddObservations(const CameraModel& camera, const PixelNoise& noise,
                      const std::vector<TrackObservation>& observations);
  /// UpdateRates of every frame.
  void UpdateRates();
  /// Rays of all views anew, after the camera's intrinsics have changed; see Renormalized.
  void Renormalize(const WindowCalibration& calibration);
  /// Takes the newest frame out, its observations with it, and returns it.
  std::unique_ptr<WindowFrame> RemoveNewest();
  /// Takes the oldest frame out. Tracks based there must have been restarted or lose that view: the next one
  /// becomes base. No SLAM feature may be anchored there.
  void RemoveOldest();
  /// Drops tracks that are not seen any more and have fewer than two views left; SLAM features stay.
  void Prune();

  [[nodiscard]] const WindowFrames& frames() const { return frames_; }
  [[nodiscard]] WindowFrame& frame(int index) { return *frames_[static_cast<size_t>(index)]; }
  [[nodiscard]] const WindowFrame& frame(int index) const { return *frames_[static_cast<size_t>(index)]; }
  [[nodiscard]] WindowFrame& newest() { return *frames_.back(); }
  [[nodiscard]] const WindowFrame& newest() const { return *frames_.back(); }
  [[nodiscard]] int size() const { return static_cast<int>(frames_.size()); }
  [[nodiscard]] std::map<std::int64_t, WindowTrack>& tracks() { return tracks_; }
  [[nodiscard]] const std::map<std::int64_t, WindowTrack>& tracks() const { return tracks_; }

 private:
  void Renumber();

  WindowFrames frames_;
  std::map<std::int64_t, WindowTrack> tracks_;  // ordered: iteration must not depend on addresses
};

/// A view with the ray that its pixel has in the camera of `calibration`, on the plane it had. It stays as it
/// is where the intrinsics are not estimated, and outside the camera's domain.
[[nodiscard]] WindowView Renormalized(const WindowCalibration& calibration, const WindowView& view);
/// Likewise: `views` themselves where the intrinsics are not estimated, or the camera is the one whose rays
/// they have; else what is computed in `scratch`.
[[nodiscard]] const std::vector<WindowView>& Renormalized(const WindowCalibration& calibration,
                                                          const CameraCalibration& of_views,
                                                          const std::vector<WindowView>& views,
                                                          std::vector<WindowView>* scratch);

/// Mean rotation-compensated motion of the tracks common to two frames, on the planes of the first frame's
/// observations, and their number.
struct FrameParallax {
  double mean = 0;
  int common = 0;
};
[[nodiscard]] FrameParallax ComputeParallax(const Window& window, const WindowFrame& first,
                                            const WindowFrame& second, const Pose& T_BC);

/// Epochs and measurements of a frame that was taken out move to the one before it, `frame`, which lies
/// within their limits of interpolation.
void MoveMeasurements(WindowFrame* dropped, WindowFrame* frame);

/// Integrates frame.imu anew at the bias `previous` holds now, when the preintegration is missing or the bias
/// has moved so far that its first-order correction no longer does.
void UpdatePreintegration(const WindowFrame& previous, const ImuNoise& noise, WindowFrame* frame);

}  // namespace alidade
