#pragma once

#include <string>

#include "core/batch_config.h"
#include "core/calibration_config.h"
#include "core/config_schema.h"
#include "core/filter_config.h"
#include "core/fix_config.h"
#include "core/frontend_config.h"
#include "core/gnss_config.h"
#include "core/imu_config.h"
#include "core/init_config.h"
#include "core/recovery_config.h"
#include "core/smoother_config.h"
#include "core/status.h"
#include "core/vision_config.h"

namespace alidade {

enum class Backend { kFilter, kSmoother, kBatch };

/// Everything that turns a measurement log into a trajectory. One per estimator of a comparison.
struct EstimatorConfig {
  std::string name = "unnamed";
  Backend backend = Backend::kFilter;
  VisionConfig vision;
  ImuConfig imu;
  InitConfig init;
  FrontendConfig frontend;
  FilterConfig filter;
  SmootherConfig smoother;
  BatchConfig batch;
  CalibrationConfig calibration;
  RecoveryConfig recovery;
  GnssConfig gnss;
  FixConfig fix;

  /// Lists every key with unit, range and reason; the order is the order of configs/base.yaml.
  void Describe(ConfigVisitor& visitor);
  /// Relations between keys that no single range can state.
  [[nodiscard]] Status Validate() const;
};

}  // namespace alidade
