#pragma once

#include <Eigen/Core>

#include "core/position_fix.h"
#include "core/yaw_shift.h"

// The rows of FixAligner's least squares.

namespace alidade {

/// A fix with the estimate at its time, as the fit takes it.
struct FixPoint {
  Eigen::Vector3d p_WA = Eigen::Vector3d::Zero();  ///< of the estimate
  Eigen::Vector3d p_NA = Eigen::Vector3d::Zero();  ///< measured
  double since_newest_s = 0;                       ///< not positive
  Eigen::Matrix3d sqrt_information = Eigen::Matrix3d::Identity();
  Eigen::Vector3d velocity_variance_W = Eigen::Vector3d::Zero();
};

/// The unknowns: yaw, p_NW and the correction of the estimate's velocity, added in this order.
struct FixGuess {
  YawShift transform;
  Eigen::Vector3d dv_W = Eigen::Vector3d::Zero();

  /// Whitened, predicted - measured.
  [[nodiscard]] Eigen::Vector3d Residual(const FixPoint& point) const;
  /// d Residual / d (yaw, p_NW, dv_W).
  [[nodiscard]] Eigen::Matrix<double, 3, 7> Jacobian(const FixPoint& point) const;
  void Move(const Eigen::Matrix<double, 7, 1>& step);
};

}  // namespace alidade
