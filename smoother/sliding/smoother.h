#pragma once

#include <memory>

#include "core/estimator/estimator.h"
#include "core/estimator_config.h"
#include "core/rig_calibration.h"

namespace alidade {

/// The sliding-window back end (config.backend smoother); see smoother/sliding/smoother_estimator.h. Keeps
/// Ceres out of its users.
[[nodiscard]] std::unique_ptr<Estimator> MakeSmoother(const EstimatorConfig& config,
                                                      const RigCalibration& rig);

/// The batch estimate (config.backend batch); see smoother/batch/batch_estimator.h. `initial` runs alongside
/// and gives the initial values.
[[nodiscard]] std::unique_ptr<Estimator> MakeBatch(const EstimatorConfig& config, const RigCalibration& rig,
                                                   std::unique_ptr<Estimator> initial);

}  // namespace alidade
