#pragma once

#include <memory>

#include "core/estimator.h"

namespace alidade {

/// The sliding-window EKF: error convention, landmark strategy and update timing by configuration
/// (FilterConfig).
[[nodiscard]] std::unique_ptr<Estimator> MakeFilter(const EstimatorConfig& config, const RigCalibration& rig);

}  // namespace alidade
