#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "core/absolute_correction.h"
#include "core/calibration.h"
#include "core/clock_state.h"
#include "core/estimator/measurement.h"
#include "core/imu_sample.h"
#include "core/navigation_state.h"
#include "core/status.h"
#include "core/track_frame.h"
#include "gnss/alignment/alignment.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {

/// What became of the measurements of one sensor since the frame before.
struct SensorStatistics {
  int used = 0;
  int gated = 0;
  double nis = 0;  ///< normalised innovation squared of the used ones
  int nis_dof = 0;
};

/// What one frame did to an estimator: what was used, refused and why, and how well the innovations fit.
struct FrameStatistics {
  int tracks_in = 0;             ///< observations handed over
  int observations_invalid = 0;  ///< outside the camera model's domain
  int features_used = 0;         ///< tracks that updated the state
  int features_gated = 0;        ///< refused by the chi-square gate
  int features_waiting = 0;      ///< refused by the parallax gate, kept for later
  int features_degenerate = 0;   ///< depth negative or out of range
  int satellites_used = 0;
  int satellites_gated = 0;
  int iterations = 0;    ///< of the smoother's solver
  bool at_rest = false;  ///< the frame was used as a zero-velocity measurement
  bool suspect = false;  ///< the gate refused more than vision.max_gated_share; they were used nonetheless
  double nis = 0;        ///< normalised innovation squared of the applied rows
  int nis_dof = 0;       ///< rows applied, vision's
  double gnss_nis = 0;   ///< the same of the epochs since the frame before
  int gnss_nis_dof = 0;
  PerSensor<SensorStatistics> sensors;  ///< of SensorEntries; IMU, camera and GNSS are counted above
  bool clock_jump = false;              ///< the receiver clock was set anew
  double propagate_ms = 0;
  double update_ms = 0;
  /// Standard deviation that the frame's observations were given.
  double pixel_noise_px = 0;
};

/// Revised estimate of one frame, available after the sequence (batch estimate).
struct FinalizedFrame {
  NavEstimate estimate;
  FrameStatistics statistics;
  /// Covariance of the state given the data up to its frame alone, canonical chart like
  /// NavEstimate::covariance; empty when it was not asked for.
  std::optional<Matrix15d> filtering_covariance;
};

/// A back end: consumes one measurement log in time order and reports state and covariance after each frame.
///
/// Single-threaded and deterministic: equal calls give equal bits (the *_ms statistics aside). Before
/// AddFrame(f) the caller has added every IMU sample up to and including the first one at or after the
/// frame's IMU time.
class Estimator {
 public:
  virtual ~Estimator() = default;

  /// Starts (or restarts) at `initial`; its covariance is in the canonical chart. The first frame may carry
  /// the same stamp. Errors (kInput): not finite, not a rotation, covariance not symmetric positive
  /// semi-definite.
  virtual Status Initialize(const NavEstimate& initial) = 0;
  /// Buffers a sample. Samples may arrive out of order or twice; a non-finite one is kInput and is dropped.
  virtual Status AddImu(const ImuSample& sample) = 0;
  /// Propagates to the frame and updates with its tracks; a track that a frame lacks has ended, unless the
  /// frame is `repeated`. kInput: the frame was skipped (not after the last one, or no IMU reaches it) and
  /// the state is as before. kDiverged: the state is lost; Initialize restarts.
  virtual Status AddFrame(const TrackFrame& frame) = 0;

  /// Turns the local world into the ENU frame of `alignment`: states, covariance (with the alignment's own)
  /// and what later frames refer to. Called once, before the first AddGnss or AddMeasurement, at
  /// the time of the state.
  /// kConfig: the back end takes no GNSS.
  virtual Status Align(const GnssAlignment& alignment);
  /// Updates with an epoch; the same rules as AddFrame. A frame may follow at the same stamp or later.
  virtual Status AddGnss(const GnssEpoch& epoch);
  /// Updates with a measurement of IMU time that stands in W as Align turned it; the same rules as AddGnss.
  /// kInput also: see Whiten. kConfig: the back end takes none of this sensor.
  virtual Status AddMeasurement(const Measurement& measurement);
  /// Receiver clock after the last epoch; nothing before Align.
  [[nodiscard]] virtual std::optional<ClockState> LatestClock() const { return std::nullopt; }
  /// What the last epoch or measurement did to the estimate, where calibration.watch asks for it; null: none.
  [[nodiscard]] virtual const AbsoluteCorrection* last_correction() const { return nullptr; }
  /// What became of the last epoch's satellites; null before Align.
  [[nodiscard]] virtual const GnssResiduals* last_gnss() const { return nullptr; }

  /// State after the last accepted frame or epoch. Precondition: initialised.
  [[nodiscard]] virtual NavEstimate Latest() const = 0;
  [[nodiscard]] virtual bool initialized() const = 0;
  [[nodiscard]] virtual const FrameStatistics& last_statistics() const = 0;

  /// The camera's calibration after the last accepted frame; nothing when none is estimated. Frames are
  /// placed in IMU time by its time offset, and IMU samples must have been added up to that time.
  [[nodiscard]] virtual std::optional<CalibrationEstimate> LatestCalibration() const { return std::nullopt; }

  /// Called once, when the log is at its end: revised estimates of all accepted frames, in their order; empty
  /// for an online estimator. `stop` (may be null) is polled: when it is set the result is empty. kDiverged:
  /// no estimate was found; those of Latest remain valid.
  virtual Result<std::vector<FinalizedFrame>> TakeFinalized(const std::atomic<bool>* stop);
};

}  // namespace alidade
