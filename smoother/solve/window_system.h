#pragma once

#include <Eigen/Core>

#include "core/error_convention.h"
#include "smoother/solve/window_term.h"

namespace alidade {

/// Information of a window on all of its frames together, canonical chart.
struct WindowInformation {
  ColumnMap columns;
  Eigen::MatrixXd root;  ///< R, upper triangular: R^T R is the information

  /// A square root of the covariance of rows * x over the poses of the window: W with W^T W that covariance,
  /// rows m x 6F in the order of the frames.
  [[nodiscard]] Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows) const;
};

/// Information of a window on its newest frame.
struct NewestEstimate {
  Matrix15d covariance = Matrix15d::Zero();      ///< of the state; canonical chart, phi dp dv dbg dba
  Matrix6d clock_covariance = Matrix6d::Zero();  ///< of the clock, in an aligned window
  Eigen::Matrix<double, 6, 15> clock_state_covariance = Eigen::Matrix<double, 6, 15>::Zero();
  Eigen::VectorXd calibration_deviations;  ///< of what of the calibration is estimated
  WindowInformation window;                ///< with the newest frame
  // Where asked for (CalibrationEstimate).
  Eigen::VectorXd calibration_error;
  Eigen::MatrixXd calibration_state_covariance;
};

/// The same from the whitened rows of `terms` over the frames at their present states, of which QR eliminates
/// the older frames; landmarks must be eliminated within the terms. With `calibration_error` also the
/// expected error of a watched calibration. False when the rows do not determine the unknowns, or a term is
/// undefined there.
bool NewestCovariance(const WindowFrames& frames, const WindowTerms& terms, NewestEstimate* newest,
                      bool calibration_error = false);

}  // namespace alidade
