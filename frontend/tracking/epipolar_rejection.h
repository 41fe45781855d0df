#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "frontend/tracking/epipolar_term.h"

namespace alidade {

/// Which pairs agree with one rigid motion of the camera: those within threshold_px of their epipolar line
/// and, where the displacement decides, on the side of positive depth. Deterministic: the sampling sequence
/// is fixed and owned.
///
/// With R_21 (p_2 = R_21 p_1 + t, from the gyroscope) two pairs determine the direction of t: with g = R_21
/// x_1, t . (g x x_2) = 0 for each pair, so t ~ n_a x n_b, n = g x x_2. The best of these starts a
/// Gauss-Newton refinement of t and of a rotation correction delta, R = Exp(delta) R_21, because a gyroscope
/// without bias correction is wrong by about kGyroError dt; the correction has this as prior, so low parallax
/// stays well-posed. Where the inliers scatter more than the threshold expects (rolling shutter, poor
/// calibration), it grows to three of their robust standard deviations, three times at most. Without R_21, or
/// when fewer than half the pairs agree with it, a fundamental matrix by RANSAC decides instead (Hartley and
/// Zisserman 2004, ch. 11); on the sphere it decides about the pairs within 80 degrees of the camera's axis
/// alone. With fewer than kMinPairs pairs none is rejected.
[[nodiscard]] std::vector<bool> FindEpipolarInliers(const std::vector<BearingPair>& pairs,
                                                    const std::optional<Eigen::Matrix3d>& R_21,
                                                    const EpipolarOptions& options);

inline constexpr int kMinPairs = 8;
/// Rate error of an uncorrected consumer gyroscope, one sigma [rad/s].
inline constexpr double kGyroError = 0.05;

}  // namespace alidade
