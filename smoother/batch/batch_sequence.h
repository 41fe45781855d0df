#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "core/estimator_config.h"
#include "core/rest_detector.h"
#include "core/rig_calibration.h"
#include "core/robust.h"
#include "gnss/alignment/alignment.h"
#include "smoother/batch/batch_gnss.h"
#include "smoother/factors/prior_factor.h"
#include "smoother/window/frame_geometry.h"

namespace alidade {

/// A track of a whole sequence. `used.views` are the observations that the gate lets pass.
struct BatchTrack {
  std::vector<WindowView> views;  ///< all observations, in time order
  WindowTrack used;
  bool selected = false;  ///< enters the estimate
};

/// A measurement between frames of a whole sequence, in W as it was aligned.
struct BatchMeasurement {
  FrameMeasurement attached;  ///< with its own noise, before its weight
  int frame = 0;              ///< index of the frame that it is attached to
  double weight = 0;          ///< of its information; 0: refused
};

/// Counts of one selection.
struct TrackSelection {
  int tracks = 0;         ///< selected
  int observations = 0;   ///< of the selected tracks
  int without_depth = 0;  ///< tracks of two views or more whose depth is not determined
  int gated = 0;          ///< tracks refused as a whole
  int outliers = 0;       ///< single observations refused
  int measurements = 0;   ///< between frames, used; without GNSS
  bool changed = false;   ///< against the selection before
};

/// All frames and tracks of a sequence, for the batch estimate.
class BatchSequence {
 public:
  BatchSequence(const EstimatorConfig& config, const RigCalibration& rig);

  /// Starts anew at an initial state, which is the prior. False: its covariance is not positive
  /// semi-definite.
  bool Start(const NavEstimate& initial);
  /// Appends a frame: its initial values and the IMU samples since the frame before. `around`: all samples
  /// that there are, from before that frame until after this one.
  void AddFrame(const NavEstimate& estimate, std::vector<ImuSample> imu, std::span<const ImuSample> around);
  /// Adds the observations of the newest frame, whose initial values are `estimate`.
  void AddTracks(const NavEstimate& estimate, const TrackFrame& frame);
  /// Turns the initial values and the prior into the frame of the alignment; yaw and position of the prior
  /// are free then. False: the prior's covariance is not positive semi-definite.
  bool Align(const GnssAlignment& alignment);
  /// Hangs a measurement on the newest frame; `imu` leads there from the frame, empty at the frame itself.
  /// `accepted`: the verdict of the initial estimator. kInput: see Whiten.
  Status AddMeasurement(const Measurement& measurement, bool accepted, std::vector<ImuSample> imu);

  /// The same for a GNSS epoch, whose rows are gated at the present states alone.
  void AddGnss(const GnssEpoch& epoch, std::vector<ImuSample> imu);

  /// Which tracks and observations enter, gated at the present states. With `gate` off only the parallax
  /// counts: a depth known to kMaxDepthDeviation, in front of every view. With it on, an observation must lie
  /// in the chi-square gate (2 degrees of freedom) around a robustly estimated landmark, then its track
  /// (2N-3). The verdicts on one track do not depend on earlier ones. Measurements between frames: the
  /// verdicts of the initial estimator, then MeasurementGates at the present states.
  TrackSelection Select(bool gate);
  /// Integrates the IMU of every interval anew at the present biases.
  void Preintegrate();

  [[nodiscard]] const WindowFrames& frames() const { return frames_; }
  [[nodiscard]] const std::vector<BatchTrack>& tracks() const { return tracks_; }
  [[nodiscard]] const std::vector<BatchMeasurement>& measurements() const { return measurements_; }
  [[nodiscard]] const BatchGnss& gnss() const { return gnss_; }
  [[nodiscard]] const LinearPrior& prior() const { return prior_; }
  /// The camera; the batch estimates nothing of it.
  [[nodiscard]] const WindowCalibration& calibration() const { return calibration_; }
  /// The tracks that Select chose, in order of first observation.
  [[nodiscard]] std::vector<WindowTrack*> SelectedTracks();
  [[nodiscard]] int invalid_observations(int frame) const { return invalid_[static_cast<size_t>(frame)]; }

 private:
  void AddObservations(const TrackFrame& frame, const WindowFrame& node);
  /// Puts the measurements of positive weight on their frames.
  void SelectMeasurements(bool gate, TrackSelection* selection);
  bool SelectTrack(const std::vector<FrameGeometry>& geometry, bool gate, TrackSelection* selection,
                   BatchTrack* track) const;
  [[nodiscard]] std::vector<WindowView> Inliers(const std::vector<FrameGeometry>& geometry,
                                                const BatchTrack& track) const;

  EstimatorConfig config_;
  RigCalibration rig_;
  ObservationKernel kernel_;  ///< of the final estimate
  ChiSquareGate gate_;
  RestDetector rest_;
  WindowCalibration calibration_;
  NavEstimate initial_;  ///< of the prior
  LinearPrior prior_;
  WindowFrames frames_;
  std::vector<int> invalid_;  ///< observations outside the camera model's domain, a frame
  std::vector<BatchTrack> tracks_;
  std::vector<BatchMeasurement> measurements_;  ///< in order of time
  BatchGnss gnss_;
  std::map<std::int64_t, size_t> track_of_id_;
};

/// The kernel that a first solve, and the judgement of single observations, use whatever the final estimate
/// does: Huber, convex, so that outliers cannot trap it.
[[nodiscard]] ObservationKernel GuardKernel(const VisionConfig& vision);

}  // namespace alidade
