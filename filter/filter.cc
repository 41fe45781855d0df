#include "filter/filter.h"

#include "filter/filter_estimator.h"

namespace alidade {

std::unique_ptr<Estimator> MakeFilter(const EstimatorConfig& config, const RigCalibration& rig,
                                      FilterObserver* observer) {
  auto filter = std::make_unique<FilterEstimator>(config, rig);
  filter->SetObserver(observer);
  return filter;
}

}  // namespace alidade
