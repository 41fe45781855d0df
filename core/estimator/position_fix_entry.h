#pragma once

#include <array>
#include <vector>

#include "core/estimator_config.h"
#include "core/position_fix.h"
#include "core/rig_calibration.h"

namespace alidade {

/// Position fixes in the list of sensors (SensorEntries in core/estimator/measurement.h). What every entry
/// needs of its types: stamp_ns and sensor (index of the sheet) of Raw; time_offset_s of a sheet, and p_BA
/// where the measurement depends on a lever arm; of the configuration enabled, gate_probability,
/// robust_kernel, max_interpolation_s and AssumeNoise.
struct PositionFixEntry {
  using Raw = PositionFix;
  using Whitened = FixMeasurement;

  /// Section of the configuration, and object of run.json.
  static constexpr const char* kKey = "fix";
  static constexpr const char* kName = "position fix";
  static constexpr const char* kPluralName = "position fixes";
  /// In status.csv, of SensorStatistics: used, gated, nis, nis_dof.
  static constexpr std::array<const char*, 4> kColumns = {"fixes_used", "fixes_gated", "fix_nis",
                                                          "fix_nis_dof"};

  template <typename Configuration>
  static auto& Config(Configuration& config) {
    return config.fix;
  }
  template <typename Rig>
  static auto& Sensors(Rig& rig) {
    return rig.fixes;
  }
  /// Of a MeasurementLog or of what has its fields.
  template <typename Log>
  static auto& Measurements(Log& log) {
    return log.fixes;
  }
  static Result<FixMeasurement> Whiten(const EstimatorConfig& config, const RigCalibration& rig,
                                       const PositionFix& fix) {
    return MakeFixMeasurement(config.fix, rig.fixes, fix);
  }
  static MeasurementGate MakeGate(const EstimatorConfig& config) { return MakeFixGate(config.fix); }
};

}  // namespace alidade
