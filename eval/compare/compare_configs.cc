#include "eval/compare/compare_configs.h"

#include <string>
#include <utility>

#include "eval/config/config_json.h"
#include "eval/config/config_yaml.h"

namespace alidade {

Status CompareConfigs::Load(const Plan& plan) {
  for (const PlanSequence& sequence : plan.sequences) {
    for (const PlanEstimator& estimator : plan.estimators) {
      if (estimator.external()) {
        configs_[&sequence].push_back(nullptr);
        continue;
      }
      std::vector<std::string> settings = plan.settings;
      for (const std::vector<std::string>* more : {&estimator.settings, &sequence.estimator_settings}) {
        settings.insert(settings.end(), more->begin(), more->end());
      }
      Result<EstimatorConfig> config = LoadEstimatorConfig(estimator.config, settings);
      if (!config.ok()) {
        return Status(config.code(),
                      "estimator " + estimator.name + " on " + sequence.name + ": " + config.message());
      }
      config->name = estimator.name;
      configs_[&sequence].push_back(std::make_unique<EstimatorConfig>(std::move(*config)));
    }
  }
  return Status::Ok();
}

Status CompareConfigs::CommonFrontend(const PlanSequence& sequence, FrontendConfig* common) const {
  nlohmann::ordered_json expected;
  for (const std::unique_ptr<EstimatorConfig>& config : configs_.at(&sequence)) {
    if (config == nullptr) {
      continue;
    }
    FrontendConfig frontend = config->frontend;
    const nlohmann::ordered_json found =
        ConfigToJson([&](ConfigVisitor& visitor) { frontend.Describe(visitor); });
    if (expected.is_null()) {
      expected = found;
      *common = frontend;
    } else if (found != expected) {
      return Status::Config("estimator " + config->name +
                            ": frontend differs from that of the other estimators, but the "
                            "front end runs once for sequence " +
                            sequence.name + "; expected equal settings");
    }
  }
  return Status::Ok();
}

}  // namespace alidade
