#pragma once

#include <optional>

#include "core/estimator.h"
#include "core/measurement_log.h"
#include "eval/run/gnss_feed.h"
#include "eval/run/run_result.h"
#include "gnss/alignment/alignment.h"
#include "gnss/alignment/inertial_start.h"

namespace alidade {

/// What a run does with the epochs of its log: before the alignment they go to the aligner (or, without a
/// camera, to the start), after it to the estimator. Writes the GNSS part of the result, and its status when
/// the estimator is lost.
class GnssRun {
 public:
  /// All must outlive the object; log.gnss is not null.
  GnssRun(const EstimatorConfig& config, const MeasurementLog& log, Estimator* estimator, RunResult* result);

  /// The epoch that TakeEpoch or TryStart will take, at its IMU time; nullptr at the end.
  [[nodiscard]] const GnssEpoch* NextEpoch() { return feed_.Next(); }
  /// The IMU reaches the epoch when the run is aligned.
  void TakeEpoch();
  /// Hands the aligner the state after the frame at `stamp_ns`, and the estimator the alignment as soon as
  /// there is one. `gyro_radps`: of that time.
  void Align(TimeNs stamp_ns, const Eigen::Vector3d& gyro_radps);

  /// The estimator has begun anew with a state that stands in the ENU frame already.
  void Realign();

  // Without a camera.
  void AddImuBeforeStart(const ImuSample& sample) { start_.AddImu(sample); }
  /// Takes an epoch; the start once it is known.
  std::optional<GnssInertialStart::Start> TryStart();
  /// The estimator has begun there.
  void AlignAtStart(const GnssInertialStart::Start& start);

  /// Adds what the epochs since the last call did.
  void Tell(FrameStatistics* statistics);

 private:
  void AddEpoch(const GnssEpoch& epoch);
  void CollectResiduals();
  void SetGlobal(const GnssAlignment& alignment, TimeNs stamp_ns);

  const MeasurementLog& log_;
  Estimator& estimator_;
  RunResult& result_;
  GnssFeed feed_;
  GnssAligner aligner_;
  GnssInertialStart start_;
  std::optional<GnssAlignment> alignment_;  ///< the one in use
  FrameStatistics epochs_;                  ///< of the epochs since the last record
};

}  // namespace alidade
