#include "eval/run/session_options.h"

namespace alidade {

Status SessionOptions::Validate(const EstimatorConfig& config) const {
  if (config.init.method == InitMethod::kTruth && camera && !start_state) {
    return Status::Config(
        "init.method: found truth, but no state was given; expected static, dynamic or auto, or "
        "SessionOptions::start_state");
  }
  if (!camera && (!config.gnss.enabled || !gnss)) {
    return Status::Config("gnss.enabled: a session without a camera needs GNSS; expected true, and a setup");
  }
  if (!camera && config.backend == Backend::kBatch) {
    return Status::Config(
        "backend: batch, but a session without a camera has no frames; expected filter or smoother");
  }
  return Status::Ok();
}

}  // namespace alidade
