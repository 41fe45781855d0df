#include "core/estimator/estimator.h"

#include <string>

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

Status Estimator::AddMeasurement(const Measurement& measurement) {
  const Sensor sensor = SensorOf(measurement);
  return Status::Config(std::string(ToString(sensor)) + ".enabled: this back end takes no " +
                        PluralNameOf(sensor) + "; expected false");
}

Result<std::vector<FinalizedFrame>> Estimator::TakeFinalized(const std::atomic<bool>* /*stop*/) {
  return std::vector<FinalizedFrame>();
}

}  // namespace alidade
