#include "eval/run/make_estimator.h"

#include "filter/filter.h"
#include "smoother/sliding/smoother.h"

namespace alidade {

std::string_view ToString(Backend backend) {
  switch (backend) {
    case Backend::kFilter:
      return "filter";
    case Backend::kSmoother:
      return "smoother";
    case Backend::kBatch:
      break;
  }
  return "batch";
}

std::unique_ptr<Estimator> MakeEstimator(const EstimatorConfig& config, const RigCalibration& rig) {
  switch (config.backend) {
    case Backend::kFilter:
      return MakeFilter(config, rig);
    case Backend::kSmoother:
      return MakeSmoother(config, rig);
    case Backend::kBatch:
      break;
  }
  return MakeBatch(
      config, rig,
      config.batch.initial == BatchInitial::kFilter ? MakeFilter(config, rig) : MakeSmoother(config, rig));
}

}  // namespace alidade
