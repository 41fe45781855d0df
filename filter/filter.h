#pragma once

#include <memory>

#include "core/estimator/estimator.h"
#include "core/estimator_config.h"
#include "core/rig_calibration.h"
#include "filter/filter_observer.h"

namespace alidade {

/// The sliding-window EKF: error convention, landmark strategy and update timing by configuration
/// (FilterConfig). `observer` may be null and must outlive the filter.
[[nodiscard]] std::unique_ptr<Estimator> MakeFilter(const EstimatorConfig& config, const RigCalibration& rig,
                                                    FilterObserver* observer = nullptr);

}  // namespace alidade
