#pragma once

#include <vector>

#include "core/estimator/estimator.h"
#include "core/estimator_config.h"
#include "core/gate_noise.h"
#include "core/imu_buffer.h"
#include "core/outlying_observations.h"
#include "core/pixel_noise.h"
#include "core/rest_detector.h"
#include "core/rig_calibration.h"
#include "core/robust.h"
#include "filter/feature_update.h"
#include "filter/filter_state.h"
#include "filter/gnss_update.h"
#include "filter/measurement_update.h"
#include "filter/scale_direction.h"
#include "filter/slam_features.h"
#include "filter/track_store.h"
#include "filter/window_shape.h"

namespace alidade {

/// The filter back end. One frame: propagate, clone, attach observations, choose the clone that will leave,
/// update with every track that is due (FilterConfig::update), let that clone go.
class FilterEstimator : public Estimator {
 public:
  FilterEstimator(const EstimatorConfig& config, const RigCalibration& rig);

  Status Initialize(const NavEstimate& initial) override;
  Status AddImu(const ImuSample& sample) override;
  Status AddFrame(const TrackFrame& frame) override;
  Status Align(const GnssAlignment& alignment) override;
  Status AddGnss(const GnssEpoch& epoch) override;
  Status AddMeasurement(const Measurement& measurement) override;
  [[nodiscard]] std::optional<ClockState> LatestClock() const override;
  [[nodiscard]] const AbsoluteCorrection* last_correction() const override {
    return absolute_ ? &*absolute_ : nullptr;
  }
  [[nodiscard]] const GnssResiduals* last_gnss() const override;
  [[nodiscard]] NavEstimate Latest() const override { return state_.Estimate(); }
  [[nodiscard]] std::optional<CalibrationEstimate> LatestCalibration() const override;
  [[nodiscard]] bool initialized() const override { return initialized_; }
  [[nodiscard]] const FrameStatistics& last_statistics() const override { return statistics_; }

  [[nodiscard]] const FilterState& state() const { return state_; }
  /// Null, the default, observes nothing. It must outlive the filter.
  void SetObserver(FilterObserver* observer);

 private:
  /// Which tracks may update; an active memory always may.
  enum class DueTracks {
    kUsual,    ///< by FilterConfig::update
    kAll,      ///< every one, whatever it waits for
    kLeaving,  ///< those whose first view leaves the window
  };

  Status PropagateTo(TimeNs stamp_ns);
  /// kDiverged: the state after the frame, or a row on the way, was not finite.
  Status EndFrame(TimeNs stamp_ns, bool finite);
  /// The same for a measurement between frames; `what` names it in messages. kDiverged: not aligned.
  Status BeginMeasurement(const char* what, TimeNs stamp_ns);
  /// The estimate, where what measurements do to it is of interest.
  [[nodiscard]] NavEstimate EstimateIfWatched() const;
  /// Corrects the state unless `finite` is false; kDiverged when the state is lost.
  Status EndMeasurement(const char* what, TimeNs stamp_ns, const NavEstimate& before, bool finite);
  /// Whether direction and length of the line between newest and oldest camera are known to a tenth.
  [[nodiscard]] bool ShapeIsKnown() const;
  /// Whether an update in single precision is as good as one in double, with FilterConfig::update_precision.
  [[nodiscard]] bool SingleSuffices() const;
  /// True when the track's views are to be used in this frame.
  [[nodiscard]] bool IsDue(const Track& track, int leaving_serial) const;
  /// Appends the rows of a track: of its landmark in the state, of its entry there, or of its due views.
  void AppendTrack(size_t index, int leaving_serial);
  /// While tracks determine the direction of the motion: a row for the volume that the start's density of the
  /// velocity has around that direction, s^2 over its length s; the most likely start alone would be too slow
  /// (docs/track_memory.md).
  void AppendScaleVolume();
  /// Appends the rows of all tracks that are due; where those of landmarks of the state begin.
  int AppendDueTracks(int leaving_serial);
  /// While the window's shape is less certain than FilterConfig::max_direction_deviation, all tracks update
  /// as soon as most of them can: a few would be those whose noise looks like parallax. While only its scale
  /// is uncertain, they wait. Returns as above.
  int ChooseAndAppendTracks(int leaving_serial);
  /// Updates the covariance with all tracks that are due, linearised again (FilterConfig::update_iterations)
  /// where they move the state far; what is left to correct the state by is then in Correction(). Nothing is
  /// left when appended_ is empty. False when a number is not finite; the state is then lost.
  bool CorrectWithDueTracks(int leaving_serial);
  /// The last pass of it. `corrected`: by the passes before.
  void CommitDueTracks(const Eigen::Ref<const Eigen::VectorXd>& corrected);
  /// False as above.
  bool UpdateWithDueTracks(int leaving_serial);
  /// Zero velocity and zero angular rate, where the rest detector finds them. False as above.
  bool UpdateAtRest(const TrackFrame& frame);
  /// Normalised innovation squared of every appended track, against the state before the update.
  void MeasureBlocks(const PreparedRows& rows);
  /// Adds to misfits_ the appended tracks that do not fit the state which the passes before have found,
  /// unless so many do not that it is suspect. The innovation's covariance is that of the state before the
  /// update: where it is large, as after a start, tracks that contradict the others pass the gate.
  void FindMisfits();
  [[nodiscard]] bool IsMisfit(size_t track) const;
  /// Marks the blocks that the gate accepts; whether so many are refused that the state is suspect.
  bool RefuseBlocks(const PreparedRows& rows);
  /// With GateUnit::kObservation, of tracks that are due with all their views.
  [[nodiscard]] bool MayTakeOutliersOut(const Track& track) const;
  /// Of the tracks that the gate refuses: the observations that contradict the others of their track, where
  /// the rest passes, in outliers_.
  void FindOutliers(const PreparedRows& rows);
  /// Whether outliers_ are most of the observations of one clone, so that its pose is suspect.
  bool OutliersMakeACloneSuspect();
  /// Takes the outliers out of their tracks, unless a clone is suspect. Whether there were any: the rows are
  /// then of views that are gone.
  bool TakeOutliersOut(const PreparedRows& rows);
  /// The same of a track that has no landmark; whether there were any.
  bool TakeOutliersOut(Track* track);
  /// Gates every appended track and weighs the accepted ones; a refused one has its rows zeroed. False where
  /// the tracks have lost observations: they must be appended again.
  bool GateBlocks(PreparedRows* rows);
  /// Appends the rows of a track's views, or those its newest view adds to its memory.
  TrackOutcome AppendViews(const Track& track, int leaving_serial);
  /// The part of correction_ that the present error dimension uses.
  [[nodiscard]] Eigen::Ref<Eigen::VectorXd> Correction() {
    return correction_.head(state_.covariance().dimension());
  }
  /// Corrects state and memories by Correction().
  void Correct();
  /// Whether the tracks' information must be kept blind to the scale (filter/scale_direction.h).
  [[nodiscard]] bool ScaleIsUncertain() const;
  /// Moves the state to the solution of the update at hand, or towards it, where its tracks are to be
  /// linearised again; false, with nothing moved, where that changes nothing. `corrected`: less the prior's
  /// mean, as an error of the state.
  bool MoveByTracks(Eigen::Ref<Eigen::VectorXd> corrected);
  /// Gates the rows at hand and factors the update with them, unless none is left in appended_; false when a
  /// number is not finite. `corrected`: by the passes before.
  bool FactorDueTracks(int landmark_rows, int leaving_serial,
                       const Eigen::Ref<const Eigen::VectorXd>& corrected);
  /// Whether the update that was factored leaves no more of the innovations than noise explains.
  [[nodiscard]] bool TracksFit() const;
  /// Takes the linearisations of this update back: the state is the prediction, and the due tracks wait.
  void GiveUp(Eigen::Ref<Eigen::VectorXd> corrected);
  /// Correct(), and what it does to the covariance while the scale is uncertain, and to `errors` likewise.
  void CorrectByTracks(Eigen::Ref<Eigen::VectorXd> errors);
  /// After the last CorrectByTracks: makes up for what carrying the scale's direction did to the IMU's share
  /// of the information on it. While the scale is known to less than a tenth, by its deviation alone.
  void CorrectScale();
  /// What the memories become when a clone leaves.
  void LeaveMemories(size_t leaving);
  /// What a track keeps after its views were used (base re-use) or refused.
  void RetireViews(Track* track, bool used);

  EstimatorConfig config_;
  RigCalibration rig_;
  ImuNoise noise_;
  Eigen::Vector3d gravity_W_;
  ChiSquareGate gate_;
  FilterState state_;
  FeatureUpdate update_;
  SlamFeatures slam_;
  TrackStore tracks_;
  GnssUpdate gnss_;
  MeasurementUpdate measurements_;
  RestDetector rest_;
  ImuBuffer imu_;
  double read_out_span_s_;
  PixelNoise pixel_noise_;
  GateNoise gate_noise_;
  FrameStatistics statistics_;
  FilterObserver* observer_ = nullptr;
  FilterRows observed_;  ///< rows of the update at hand; empty without an observer
  bool initialized_ = false;
  std::optional<AbsoluteCorrection> absolute_;  ///< the last one
  bool aligned_ = false;                        ///< W stands as Align turned it
  DueTracks due_ = DueTracks::kUsual;           ///< in this frame
  BaselineDeviation baseline_;                  ///< before the tracks of this frame
  ScaleDirection scale_direction_;
  bool carry_scale_ = false;           ///< whether corrections carry the direction that was taken
  int updated_serial_ = 0;             ///< of the newest frame when tracks last updated the state
  int serial_ = 0;                     ///< of the newest frame
  int first_serial_ = 1;               ///< of the first frame after the initialisation
  TimeNs frame_stamp_ns_ = INT64_MIN;  ///< IMU time of the last frame
  // Scratch kept between frames.
  std::vector<ImuSample> interval_;
  std::vector<size_t> appended_;
  std::vector<size_t> degenerate_;
  std::vector<bool> accepted_;
  std::vector<double> block_nis_;
  std::vector<size_t> misfits_;  ///< tracks that the passes of the present update refuse from now on
  std::vector<double> weights_;  ///< of the blocks; 0: refused
  /// An observation to take out: index of its track, serial of its clone.
  struct Outlier {
    size_t track = 0;
    int serial = 0;
  };
  std::vector<Outlier> outliers_;
  std::vector<int> outlying_;  ///< of one track
  FrameOutliers clone_outliers_;
  Eigen::VectorXd snooped_;         ///< innovation of one track, whitened
  std::vector<TrackMemory*> left_;  ///< memories that a leaving clone is part of
  CloneConditional conditional_;
  Eigen::VectorXd correction_;  ///< see Correction()
  Eigen::VectorXd corrected_;   ///< see MoveByTracks
  Eigen::VectorXd moved_;       ///< sum of an update's corrections so far
  Eigen::VectorXd whitened_;    ///< `corrected` of an update with all tracks, S times this
  Eigen::MatrixXd rest_rows_;
  Eigen::VectorXd rest_innovation_;
};

}  // namespace alidade
