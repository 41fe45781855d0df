#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "eval/run/gnss_run.h"
#include "eval/run/measurement_runs.h"

namespace alidade {

/// The runs of all sensors beside camera and IMU that are in use: raw GNSS, then those of SensorEntries. One
/// of them aligns the estimator's world; the others follow it.
class SensorRuns {
 public:
  /// All must outlive the object.
  SensorRuns(const EstimatorConfig& config, const RigCalibration& rig, const SessionOptions& options,
             Estimator* estimator, std::vector<SessionEvent>* events);
  SensorRuns(const SensorRuns&) = delete;
  SensorRuns& operator=(const SensorRuns&) = delete;

  /// Null without GNSS.
  [[nodiscard]] GnssRun* gnss() { return gnss_ ? &*gnss_ : nullptr; }
  /// Of one of SensorEntries; null where it is not in use.
  [[nodiscard]] MeasurementRun* measurements(Sensor sensor);
  [[nodiscard]] const std::vector<SensorRun*>& all() const { return all_; }

  /// A frame was taken at `stamp_ns`: the alignment, when one of the runs has found it; the others have it
  /// then. `gyro_radps`: of that time.
  Result<std::optional<GnssAlignment>> Align(TimeNs stamp_ns, const Eigen::Vector3d& gyro_radps);
  /// The estimator has begun in the ENU frame with what GNSS found.
  Status AlignAtStart(const GnssInertialStart::Start& start);
  /// The estimator has restarted in the aligned world.
  Status Realign();

 private:
  /// To the measurements of sensors other than `by`, which aligned the run; null: GNSS did.
  void PassAlignment(const std::optional<EnuFrame>& enu, const MeasurementRun* by);

  std::optional<GnssRun> gnss_;
  std::vector<std::unique_ptr<MeasurementRun>> measurements_;
  std::vector<SensorRun*> all_;  ///< of the two above
};

}  // namespace alidade
