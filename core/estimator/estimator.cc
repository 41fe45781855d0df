#include "core/estimator/estimator.h"

namespace alidade {
namespace {

Status NoGnss() {
  return Status::Config("gnss.enabled: this back end takes no GNSS; expected false");
}

}  // namespace

Status Estimator::Align(const GnssAlignment& /*alignment*/) {
  return NoGnss();
}

Status Estimator::AddGnss(const GnssEpoch& /*epoch*/) {
  return NoGnss();
}

Status Estimator::AddFix(const PositionFix& /*fix*/) {
  return Status::Config("fix.enabled: this back end takes no position fixes; expected false");
}

Result<std::vector<FinalizedFrame>> Estimator::TakeFinalized(const std::atomic<bool>* /*stop*/) {
  return std::vector<FinalizedFrame>();
}

}  // namespace alidade
