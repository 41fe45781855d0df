#pragma once

#include <Eigen/Core>

namespace alidade {

/// One feature in two images, as directions in the camera: (x, y, 1) of the ideal normalised plane, or unit
/// vectors.
struct BearingPair {
  Eigen::Vector3d first = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d second = Eigen::Vector3d::UnitZ();
};

struct EpipolarOptions {
  double threshold_px = 1.0;  ///< distance to the epipolar line; grows with the scatter of the inliers
  double focal_px = 460.0;    ///< pixels per unit of the normalised plane, or per radian
  double dt_s = 0.05;         ///< between the images; bounds what an unknown gyroscope bias can do
  /// The directions are unit vectors, in front of the camera or not: distances are angles to the epipolar
  /// plane.
  bool on_sphere = false;
};

/// Relative motion of the camera, p_2 = R_21 p_1 + t with |t| = 1.
struct CameraMotion {
  Eigen::Matrix3d R_21 = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::UnitZ();
};

/// The information of one pair on a motion: the signed distance of x_2 to the epipolar line of x_1 is `error
/// * scale` [px].
struct EpipolarTerm {
  Eigen::Vector3d g;  // R_21 x_1
  Eigen::Vector3d x_2;
  double error;     // t . (g x x_2)
  double scale;     // px per unit of error
  bool at_epipole;  // x_1 lies on the epipole: its line is any line through it
};

[[nodiscard]] EpipolarTerm EvaluateEpipolar(const BearingPair& pair, const CameraMotion& motion,
                                            const EpipolarOptions& options);
/// Between where a pair was seen and where the rotation alone takes it.
[[nodiscard]] double DisplacementPx(const EpipolarTerm& term, const EpipolarOptions& options);
/// Within threshold_px of the epipolar line, and, on the plane, in front of the second image.
[[nodiscard]] bool IsInlier(const EpipolarTerm& term, const EpipolarOptions& options);

}  // namespace alidade
