#pragma once

#include <optional>
#include <string>

#include "core/estimator/estimator.h"
#include "eval/audit/observability.h"
#include "eval/record/calibration_record.h"
#include "eval/run/degradation_kind.h"

namespace alidade {

/// One processed frame of a run.
struct RunRecord {
  NavEstimate estimate;
  FrameStatistics statistics;
  double frontend_ms = 0;
  double backend_ms = 0;  ///< wall time of the estimator for this frame and the IMU samples before it
  std::string status = "ok";
  std::optional<ObservabilityRecord> observability;  ///< of an audited run
  /// Covariance of (phi, dp) given the data up to this frame alone; of the batch estimate.
  std::optional<Matrix6d> filtering_covariance;
  std::optional<ClockState> clock;                       ///< once aligned with GNSS
  std::optional<CalibrationEstimate> calibration;        ///< of an estimator that calibrates online
  std::string reason;                                    ///< of a status that is not ok
  DegradationKind degradation = DegradationKind::kData;  ///< of the status degraded; in no file of a run
};

}  // namespace alidade
