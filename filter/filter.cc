#include "filter/filter.h"

#include "filter/filter_estimator.h"

namespace alidade {

std::unique_ptr<Estimator> MakeFilter(const EstimatorConfig& config, const RigCalibration& rig) {
  return std::make_unique<FilterEstimator>(config, rig);
}

}  // namespace alidade
