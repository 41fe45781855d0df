#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "core/time.h"
#include "gnss/base/system_index.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {

/// Position and velocity of the antenna from one epoch.
struct SinglePointSolution {
  TimeNs tag_ns = 0;    ///< the receiver's tag
  TimeNs stamp_ns = 0;  ///< true GPST: tag - clock
  Eigen::Vector3d position_E = Eigen::Vector3d::Zero();
  Eigen::Matrix3d position_covariance_E = Eigen::Matrix3d::Zero();
  bool has_velocity = false;
  Eigen::Vector3d velocity_E = Eigen::Vector3d::Zero();
  Eigen::Matrix3d velocity_covariance_E = Eigen::Matrix3d::Zero();
  double clock_m = 0;  ///< c dt_r against the datum system (GPS unless the first epoch had none)
  double drift_mps = 0;
  /// Bias of a system's clock against the datum [m]; empty where it had no satellite.
  std::array<std::optional<double>, kGnssSystems> inter_system_bias_m;
  std::vector<SatelliteResidual> satellites;
  int used = 0;
  double scale = 1;  ///< robust deviation of whitened residuals; the covariance holds its square
};

}  // namespace alidade
