#pragma once

#include "core/time.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// When the fault of a simulation acts: [begin_ns, end_ns).
struct FaultSpan {
  /// `start_ns`: of the first IMU sample.
  FaultSpan(const SimulatorConfig& config, TimeNs start_ns)
      : begin_ns(start_ns + SecondsToNs(config.fault_start_s)),
        end_ns(begin_ns + SecondsToNs(config.fault_duration_s)) {}
  [[nodiscard]] bool Contains(TimeNs stamp_ns) const { return stamp_ns >= begin_ns && stamp_ns < end_ns; }

  TimeNs begin_ns;
  TimeNs end_ns;
};

}  // namespace alidade
