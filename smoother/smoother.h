#pragma once

#include <memory>

#include "core/estimator.h"

namespace alidade {

/// The sliding-window back end (config.backend smoother); see smoother/smoother_estimator.h. Keeps Ceres out
/// of its users.
[[nodiscard]] std::unique_ptr<Estimator> MakeSmoother(const EstimatorConfig& config,
                                                      const RigCalibration& rig);

}  // namespace alidade
