#pragma once

#include <memory>
#include <vector>

#include "core/estimator_config.h"
#include "core/rig_calibration.h"
#include "eval/run/sensor_run.h"
#include "eval/run/session_event.h"
#include "eval/run/session_options.h"

namespace alidade {

/// One run for each of SensorEntries that the configuration enables and the rig has, in their order. All
/// arguments must outlive them. `with_gnss`: raw GNSS is in use too.
[[nodiscard]] std::vector<std::unique_ptr<MeasurementRun>> MakeMeasurementRuns(
    const EstimatorConfig& config, const RigCalibration& rig, const SessionOptions& options, bool with_gnss,
    Estimator* estimator, std::vector<SessionEvent>* events);

}  // namespace alidade
