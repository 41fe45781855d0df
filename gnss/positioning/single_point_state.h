#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "gnss/base/satellite_id.h"
#include "gnss/base/system_index.h"

namespace alidade {

/// Where an epoch's iteration stands.
struct SinglePointState {
  Eigen::Vector3d position_E = Eigen::Vector3d::Zero();
  double clock_m = 0;
  std::array<double, kGnssSystems> bias_m{};
  std::array<int, kGnssSystems> column{};  ///< of a bias; -1 where the system is absent or the datum
  GnssSystem datum = GnssSystem::kGps;
  int unknowns = 4;
  bool biases_anew = false;        ///< the carried ones are not used
  bool located = false;            ///< direction and variances of the measurements are known
  std::vector<bool> active;        ///< by measurement
  std::vector<double> residual_m;  ///< by measurement, at the solution
  Eigen::MatrixXd covariance;
  double scale = 1;
};

}  // namespace alidade
