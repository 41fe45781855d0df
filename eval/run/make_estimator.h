#pragma once

#include <memory>
#include <string_view>

#include "core/estimator/estimator.h"
#include "core/estimator_config.h"
#include "core/rig_calibration.h"

namespace alidade {

/// filter | smoother | batch
[[nodiscard]] std::string_view ToString(Backend backend);

/// The back end that `config.backend` names.
[[nodiscard]] std::unique_ptr<Estimator> MakeEstimator(const EstimatorConfig& config,
                                                       const RigCalibration& rig);

}  // namespace alidade
