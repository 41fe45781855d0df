#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/estimator/estimator.h"
#include "core/estimator_config.h"
#include "core/gate_noise.h"
#include "core/imu_buffer.h"
#include "core/pixel_noise.h"
#include "core/rest_detector.h"
#include "core/rig_calibration.h"
#include "core/robust.h"
#include "smoother/sliding/gnss_window.h"
#include "smoother/sliding/measurement_window.h"
#include "smoother/sliding/newest_update.h"
#include "smoother/solve/prior_terms.h"
#include "smoother/solve/sensor_terms.h"
#include "smoother/solve/vision_terms.h"
#include "smoother/solve/window_system.h"

namespace alidade {

/// Sliding-window smoother: least squares over the states of the last frames, their tracks and a prior that
/// holds what left.
///
/// A frame:  1. The previous frame is kept as a keyframe or taken out, its IMU joining the next interval and
///              its measurements the frame before; it is kept where that frame is too far from one of them.
///              Else the frame of a repeated image, which has no view, is always taken out.
///           2. When the window is full the oldest frame is marginalised together with every track based
///              there: all observations of such a track, in newer frames too, go into the prior, each exactly
///              once. A track still seen starts anew with its next observation. (Re-anchoring it and using
///              its observations again, as VINS-Mono does, would count them twice.) A track without parallax
///              only loses its oldest view.
///           3. IMU prediction of the new frame, rest measurement when it stands still, landmarks of new
///              tracks, solve.
///           4. Chi-square gate on each track at the solution: a refused track forgets its observations. When
///              the gate refuses more than vision.max_gated_share the state is suspect and not the tracks:
///              they stay, their information scaled down to the gate.
///           5. Covariance of the newest state.
/// A long track may keep its landmark instead (smoother.slam_features): a SLAM feature has columns in the
/// prior, only its view in the oldest frame goes there, and the rest of its views stay. Nothing about it is
/// lost until the track is. The first prior is the covariance of Initialize, which also fixes the gauge (yaw
/// and position).
class SmootherEstimator final : public Estimator {
 public:
  SmootherEstimator(const EstimatorConfig& config, const RigCalibration& rig);

  Status Initialize(const NavEstimate& initial) override;
  Status AddImu(const ImuSample& sample) override;
  Status AddFrame(const TrackFrame& frame) override;
  Status Align(const GnssAlignment& alignment) override;
  Status AddGnss(const GnssEpoch& epoch) override;
  Status AddMeasurement(const Measurement& measurement) override;
  [[nodiscard]] std::optional<ClockState> LatestClock() const override;
  [[nodiscard]] const GnssResiduals* last_gnss() const override;
  [[nodiscard]] const AbsoluteCorrection* last_correction() const override {
    return absolute_ ? &*absolute_ : nullptr;
  }
  [[nodiscard]] NavEstimate Latest() const override { return latest_; }
  [[nodiscard]] bool initialized() const override { return initialized_; }
  [[nodiscard]] const FrameStatistics& last_statistics() const override { return statistics_; }

  [[nodiscard]] std::optional<CalibrationEstimate> LatestCalibration() const override;

  [[nodiscard]] const Window& window() const { return window_; }

 private:
  /// Without the calibration's prior.
  Status Begin(const NavEstimate& initial);
  Status BeginFrame(TimeNs stamp_ns);
  /// The camera as it is known now.
  [[nodiscard]] const CameraCalibration& camera() const { return calibration_.mean; }
  [[nodiscard]] std::vector<FrameGeometry> Geometry() const { return MakeGeometry(window_, camera()); }
  /// How a measurement between frames is attached to the newest one.
  struct Attachment {
    bool own_state = false;      ///< the newest frame was made for it
    std::vector<ImuSample> imu;  ///< from the newest frame to it; the sample there where they coincide
  };
  /// Makes a frame at the stamp where the newest one lies more than `max_interpolation_s` before it. `what`
  /// names the measurement in messages. kDiverged: not aligned. kInput: older than the newest frame.
  Result<Attachment> ReachMeasurement(const char* what, TimeNs stamp_ns, double max_interpolation_s);
  /// Solves where the measurement has a state of its own.
  Status SolveWithMeasurement(const Attachment& attachment);
  [[nodiscard]] bool NewestIsKeyframe() const;
  /// Whether the frame before the newest one predicts its clock, and all measurements of the newest one lie
  /// within their max_interpolation_s after that frame. Precondition: two frames.
  [[nodiscard]] bool MayTakeOutNewest() const;
  void DetectRest(const TrackFrame& frame);
  Status MarginalizeOldestFrame();
  [[nodiscard]] std::vector<WindowTrack*> StayingFeatures(const std::vector<FrameGeometry>& geometry);
  /// Whether the rows of a track's landmark may be linearised for good.
  [[nodiscard]] bool DepthIsKnown(const std::vector<FrameGeometry>& geometry, const WindowTrack& track) const;
  [[nodiscard]] std::vector<WindowTrack*> NewFeatures(const std::vector<FrameGeometry>& geometry,
                                                      size_t free);
  /// Tracks without an anchor whose views begin in the oldest frame, with their landmarks solved for.
  [[nodiscard]] std::vector<const WindowTrack*> LeavingTracks(const std::vector<FrameGeometry>& geometry);
  [[nodiscard]] SensorContext Sensors() const { return {gravity_W_, gnss_.context(), &calibration_}; }
  /// The prior, first of a window's terms. Returns it where it has landmarks, else null.
  SlamPriorTerm* SetPriorTerm(WindowTerms* terms) const;
  [[nodiscard]] bool StartIsInWindow() const { return prior_.anchors.size() == 1; }
  /// Where its volume of scales counts: whether the shape of a window with the start is known.
  [[nodiscard]] bool StartShapeIsKnown() const;
  /// The volume of the scales that the start allows.
  void AppendScaleVolume(WindowTerms* terms) const;
  /// Takes out the observations of SLAM features that have the landmark behind them at the present states:
  /// the prior's landmarks have a solution only where every one of their views can see them.
  void DropViewsFromBehind();
  /// Landmarks of the prior at the states just solved for.
  Status TakeLandmarks(const SlamPriorTerm& slam);
  /// SLAM features that have views in the window.
  [[nodiscard]] std::vector<WindowTrack*> FeaturesInSight();
  /// Appends the term of the tracks for the solver. Null without any.
  PoseOnlyTerm* AddVision(const std::vector<WindowTrack*>& tracks, WindowTerms* terms) const;
  /// Gates what was solved for, and appends the term of the tracks whose views passed. `vision`: that of
  /// `tracks` for the solver, if it is of the present states.
  Status Gate(const std::vector<WindowTrack*>& tracks, bool has_features,
              std::unique_ptr<PoseOnlyTerm> vision, WindowTerms* terms);
  void PropagateToNewest(std::unique_ptr<WindowFrame> dropped, TimeNs stamp_ns);
  [[nodiscard]] std::vector<WindowTrack*> SelectTracks();
  enum class Landmark { kReady, kWaiting, kDegenerate };
  /// Largest deviation of the inverse depth of a track that the parallax gate lets pass; infinite where each
  /// track's own depth decides.
  [[nodiscard]] double MaxInverseDepthDeviation() const;
  /// Triangulates a track that has no landmark yet, once it has the parallax.
  Landmark PrepareLandmark(const std::vector<FrameGeometry>& geometry, double max_inverse_depth_deviation,
                           WindowTrack* track) const;
  /// With GateUnit::kObservation takes the views that leave a track no landmark out; whether there were any.
  bool TakeOutliersOut(const std::vector<FrameGeometry>& geometry, WindowTrack* track) const;
  [[nodiscard]] bool DepthInRange(const Eigen::Vector3d& landmark) const;
  /// Median of the tracks that have a landmark; that of kRoomDepth while they are few.
  [[nodiscard]] double TypicalInverseDepth() const;
  Status SolveAndGate(std::vector<WindowTrack*>* tracks);
  [[nodiscard]] bool IsSuspect(size_t refused, size_t tracks) const;
  /// Of a track that the gate accepts: whether its landmark is one, too; false: a SLAM feature was dropped.
  bool KeepTrack(WindowTrack* track);
  /// Solves for the landmark of a track that is none of the prior's, or takes it from `solved`, if it has the
  /// index. False: there is none.
  bool SolveOwnLandmark(const std::vector<FrameGeometry>& geometry,
                        std::span<const std::optional<Eigen::Vector3d>> solved, size_t index,
                        WindowTrack* track) const;
  /// A track that the gate refuses.
  struct RefusedTrack {
    WindowTrack* track = nullptr;
    double chi_square = 0;
    std::vector<int> outlying;  ///< its views that contradict the others
    bool passes = false;        ///< without these; none where it does at its landmark of least squares
  };
  /// The tracks beyond the gate. `landmarks`: of the first ones, solved for. *feature_refused becomes true
  /// when the landmark of a SLAM feature that passes is none.
  std::vector<RefusedTrack> RefuseTracks(const std::vector<FrameGeometry>& geometry,
                                         const std::vector<WindowTrack*>& tracks,
                                         std::span<const std::optional<Eigen::Vector3d>> landmarks,
                                         bool* feature_refused);
  /// With GateUnit::kObservation takes those out of `refused` that pass without their outlying views. None
  /// where so many of one frame's are outlying that its pose is suspect.
  std::vector<RefusedTrack> FindOutliers(const std::vector<FrameGeometry>& geometry,
                                         const std::vector<WindowTrack*>& tracks,
                                         std::vector<RefusedTrack>* refused) const;
  /// `solved`: the term of the first tracks at the present states, from which those that are refused are
  /// removed if it is used again, and those that lose views; null: none. True when a SLAM feature was refused
  /// or has lost views.
  bool GateTracks(const std::vector<FrameGeometry>& geometry, const std::vector<WindowTrack*>& tracks,
                  PoseOnlyTerm* solved);
  Status UpdateLatest(const WindowTerms& terms);
  /// Brings newest_update_ to the newest frame, which was made for a measurement.
  Status CarryNewestUpdate();
  [[nodiscard]] Status Lost(const std::string& message);

  // Two views already constrain the poses (2N-3 = 1 row), for explicit and for pose-only landmarks alike.
  static constexpr size_t kMinViews = 2;
  static constexpr int kMaxLandmarkIterations = 30;

  EstimatorConfig config_;
  RigCalibration rig_;
  ImuNoise noise_;
  Eigen::Vector3d gravity_W_;
  ObservationKernel kernel_;
  ChiSquareGate gate_;
  ImuBuffer imu_;
  double read_out_span_s_;
  PixelNoise pixel_noise_;
  GateNoise gate_noise_;
  RestDetector rest_;
  Window window_;
  GnssWindow gnss_;
  MeasurementWindow measurements_;
  LinearPrior prior_;
  CalibrationEstimate given_;  ///< the calibration a run starts with
  WindowCalibration calibration_;
  WindowCalibration fixed_;  ///< a watched one as the solver sees it: nothing to estimate
  Eigen::VectorXd calibration_deviations_;
  Eigen::VectorXd calibration_error_;             ///< of a watched one
  Eigen::MatrixXd calibration_state_covariance_;  ///< likewise
  NavEstimate latest_;
  ClockState latest_clock_;
  NewestUpdate newest_update_;                  ///< where measurements are watched
  std::optional<AbsoluteCorrection> absolute_;  ///< the last one
  WindowInformation window_information_;        ///< at the last solve
  bool start_shape_is_known_ = false;           ///< likewise
  bool has_frames_ = false;                     ///< a camera has been heard of
  FrameStatistics statistics_;
  std::vector<ImuSample> interval_;
  bool initialized_ = false;
  bool aligned_ = false;  ///< W stands as Align turned it
};

}  // namespace alidade
