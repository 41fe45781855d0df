#pragma once

#include <Eigen/Core>

#include "core/calibration.h"
#include "core/navigation_state.h"

namespace alidade {

/// Tests whether the given calibration of a camera holds, while the estimator takes it as given.
///
/// Each parameter theta is carried like an estimated one, but with a prior deviation eps so small that the
/// data do not move it: to first order in eps^2 the state is what it would be without. The expected error
/// d = E[theta] and its variance s^2 then hold the score and the Fisher information of the innovations with
/// respect to the parameter, all states being free:
///
///   I = 1 / s^2 - 1 / eps^2,   score = d / s^2,   z = score / sqrt(I),   theta^ = score / I
///
/// If the parameter is as given, z is standard normal (Rao's score test, which is the generalised likelihood
/// ratio test of a constant bias in a Kalman filter: Willsky and Jones, IEEE TAC 1976; Friedland, IEEE TAC
/// 1969). theta^ is its most likely error if it alone is wrong, and T theta^ with T = cov(state, theta) / s^2
/// is what that error has done to the state.
///
/// Neglected: terms of second order, and that several parameters may be wrong at once. The noise must be
/// independent from frame to frame: errors of a track that last, as those of templates, look like an error of
/// the camera, which is why a verdict also asks for `pose_sigmas`.
struct CalibrationDoubt {
  const char* parameter = "";  ///< as in a message: "the focal length of the camera"
  const char* unit = "";       ///< of `error`
  double sigmas = 0;           ///< |z|
  double error = 0;            ///< theta^, given - true, in `unit`: deg, m, ms or px
  /// Length of T theta^ of (phi, dp) in deviations of the estimate: root of its Mahalanobis square. Axes of a
  /// parameter are added up.
  double pose_sigmas = 0;
};

/// The parameter that most likely is not as given: that with the largest |z|. `covariance`: of the state, as
/// in NavEstimate. All zero while nothing is known.
[[nodiscard]] CalibrationDoubt FindCalibrationDoubt(const CalibrationEstimate& watched,
                                                    const Matrix15d& covariance);

}  // namespace alidade
