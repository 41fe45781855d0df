#pragma once

#include "core/config_schema.h"
#include "core/status.h"
#include "eval/simulation/sim_fix_config.h"
#include "eval/simulation/sim_gnss_config.h"

namespace alidade {

/// The sections of the simulated sensors beside IMU and camera: a member, a section and a check each.
struct SimSensorConfig {
  SimGnssConfig gnss;
  SimFixConfig fix;

  void DescribeSensors(ConfigVisitor& visitor) {
    visitor.Section("gnss", "simulated GNSS receiver", [&] { gnss.Describe(visitor); });
    visitor.Section("fix", "simulated position fixes", [&] { fix.Describe(visitor); });
  }
  [[nodiscard]] Status ValidateSensors() const {
    ALIDADE_RETURN_IF_ERROR(gnss.Validate());
    ALIDADE_RETURN_IF_ERROR(fix.Validate());
    return Status::Ok();
  }
};

}  // namespace alidade
