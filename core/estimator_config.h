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

  /// Calls visit(name, purpose, section) for every section, in the order of configs/base.yaml.
  template <typename Visit>
  void ForEachSection(const Visit& visit) {
    visit("vision", "noise, gates and kernels, shared by both back ends", vision);
    visit("imu", "gravity and factors on the noise of the sensor sheet", imu);
    visit("init", "initialisation, shared by both back ends", init);
    visit("frontend", "images to tracks", frontend);
    visit("filter", "the sliding-window invariant EKF", filter);
    visit("smoother", "the Ceres sliding window", smoother);
    visit("batch", "estimate from the whole sequence at once; a bound", batch);
    visit("calibration", "camera parameters estimated online, by both back ends", calibration);
    visit("recovery", "detection of divergence and re-initialisation, shared by both back ends", recovery);
    visit("gnss", "raw GNSS", gnss);
    visit("fix", "position fixes", fix);
  }
  /// Lists every key with unit, range and reason.
  void Describe(ConfigVisitor& visitor);
  /// Relations between keys that no single range can state.
  [[nodiscard]] Status Validate() const;
};

}  // namespace alidade
