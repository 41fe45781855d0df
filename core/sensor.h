#pragma once

namespace alidade {

/// Who sends a message. The sensors of SensorEntries (core/estimator/measurement.h) follow, in their order.
enum class Sensor { kImu, kCamera, kGnss };

}  // namespace alidade
