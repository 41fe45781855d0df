#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/distortion_model.h"
#include "core/status.h"

namespace alidade {

/// On which plane an estimator has a lens' observations (core/bearing_plane.h).
enum class ObservationPlane {
  kNormalized,  ///< z = 1
  kTangent,     ///< of the unit sphere, at each measured ray
};

/// Pinhole camera with a lens model. Immutable after Create, which bounds the domain to where the distortion
/// is one-to-one and at most half again as far from the principal point as the image's farthest corner;
/// outside it every call answers false instead of a plausible number.
class CameraModel {
 public:
  /// An ideal camera of focal length 1: pixels are normalised coordinates.
  CameraModel() = default;

  /// Errors (kInput): non-positive focal length or resolution, wrong number of coefficients, non-finite
  /// numbers, fov w outside (0, pi), mei xi outside [0, 10], double-sphere xi outside (-1, 1], its alpha or
  /// eucm's outside [0, 1], eucm beta outside (0, 100].
  static Result<CameraModel> Create(DistortionModel model, const Eigen::Vector4d& fu_fv_cu_cv,
                                    const std::vector<double>& coefficients, int width_px, int height_px);

  /// The same lens with another plane than the one chosen for it.
  [[nodiscard]] CameraModel WithPlane(ObservationPlane plane) const {
    CameraModel camera = *this;
    camera.plane_ = plane;
    return camera;
  }

  /// Point in the camera frame [m] -> pixel. jacobian: d pixel / d p_C, 2x3. False when the point is outside
  /// the lens model's domain, which for lenses that are not spherical ends before the camera; outputs are
  /// then untouched. The pixel may lie outside the image.
  bool Project(const Eigen::Vector3d& p_C, Eigen::Vector2d* pixel,
               Eigen::Matrix<double, 2, 3>* jacobian = nullptr) const;

  /// Pixel -> unit ray in the camera frame, wherever it points. False when no ray of the domain maps to this
  /// pixel.
  bool Bearing(const Eigen::Vector2d& pixel, Eigen::Vector3d* ray) const;

  /// Pixel -> normalised plane. pixel_jacobian: d pixel / d normalised at the answer, 2x2 (whitens pixel
  /// noise on the normalised plane). False when no point of the domain before the camera maps to this pixel.
  bool Unproject(const Eigen::Vector2d& pixel, Eigen::Vector2d* normalized,
                 Eigen::Matrix2d* pixel_jacobian = nullptr) const;

  /// Ideal -> distorted normalised coordinates, with the 2x2 Jacobian. False outside the domain.
  bool Distort(const Eigen::Vector2d& ideal, Eigen::Vector2d* distorted,
               Eigen::Matrix2d* jacobian = nullptr) const;

  /// A ray or point, of any length, to distorted coordinates, by a spherical lens (precondition). Jacobians,
  /// where not null: over p, 2x3, and over the lens coefficients, 2x4, zero behind the model's. False outside
  /// the domain.
  bool DistortRay(const Eigen::Vector3d& p, Eigen::Vector2d* distorted,
                  Eigen::Matrix<double, 2, 3>* jacobian = nullptr,
                  Eigen::Matrix<double, 2, 4>* by_coefficients = nullptr) const;

  [[nodiscard]] bool InImage(const Eigen::Vector2d& pixel, double border_px = 0) const {
    return pixel.x() >= border_px && pixel.y() >= border_px && pixel.x() <= width_px_ - 1 - border_px &&
           pixel.y() <= height_px_ - 1 - border_px;
  }

  [[nodiscard]] DistortionModel model() const { return model_; }
  [[nodiscard]] const Eigen::Vector4d& intrinsics() const { return intrinsics_; }  ///< fu, fv, cu, cv [px]
  [[nodiscard]] const LensCoefficients& coefficients() const {
    return coefficients_;
  }  ///< zeros behind the model's
  /// Pixels a radian at the image's centre, distortion aside.
  [[nodiscard]] double mean_focal_px() const {
    const bool has_mirror = model_ == DistortionModel::kMei || model_ == DistortionModel::kDoubleSphere;
    const double mirror = has_mirror ? 1 + coefficients_[0] : 1;
    return 0.5 * (intrinsics_[0] + intrinsics_[1]) / mirror;
  }
  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }
  /// Largest radius on the ideal normalised plane for which the lens model is one-to-one.
  [[nodiscard]] double max_radius() const { return max_radius_; }
  /// True of lenses whose domain may reach beyond 90 degrees off axis.
  [[nodiscard]] bool is_spherical() const { return spherical_; }
  /// Largest angle off axis of the domain [rad].
  [[nodiscard]] double max_angle_rad() const { return max_angle_; }
  /// Angle off axis of the image's farthest corner, or where the domain ends before it [rad].
  [[nodiscard]] double field_angle_rad() const { return field_angle_; }
  /// Tangent where field_angle_rad() is beyond kMaxPlaneAngle of a lens that models it (equidistant,
  /// double-sphere, eucm), else normalised.
  [[nodiscard]] ObservationPlane plane() const { return plane_; }
  /// 80 degrees [rad]. There an angle's error is 1 / cos^2 = 33 times as large on the plane z = 1, and of one
  /// pixel at 250 pixels a radian the projection's second-order term, tan x error, 2 % of the first.
  static constexpr double kMaxPlaneAngle = 1.3962634015954636;

 private:
  /// A direction off axis.
  struct Angle {
    double sine, cosine;
  };
  /// Distorted radius of a spherical lens, its derivative by the angle, negative where the map has turned
  /// back or none is, and, unless null, by the coefficients.
  double RadialOfAngle(const Angle& angle, double* derivative,
                       Eigen::RowVector4d* by_coefficients = nullptr) const;
  bool UndistortToSphere(const Eigen::Vector2d& distorted, Eigen::Vector3d* ray) const;
  /// Inverse of RadialOfAngle of equidistant, the angle [rad].
  [[nodiscard]] double AngleOfRadius(double radius) const;
  void BoundSphere(double farthest, double corner);
  bool Undistort(const Eigen::Vector2d& distorted, Eigen::Vector2d* ideal) const;
  /// Distorted radius r_d(r) of the radial part and its derivative; tangential terms are left out.
  double RadialDistortion(double radius, double* derivative) const;
  void BoundDomain();
  /// The domain on the plane z = 1: up to the distorted radius `farthest`; the field, up to `corner`.
  void BoundPlane(double farthest, double corner);
  /// Distort of mei; the Jacobian may be null.
  void DistortMei(const Eigen::Vector2d& ideal, Eigen::Vector2d* distorted, Eigen::Matrix2d* jacobian) const;

  DistortionModel model_ = DistortionModel::kNone;
  Eigen::Vector4d intrinsics_ = Eigen::Vector4d(1, 1, 0, 0);
  LensCoefficients coefficients_ = LensCoefficients::Zero();
  int width_px_ = 1;
  int height_px_ = 1;
  double max_radius_ = 1e3;
  double max_distorted_radius_ = 1e3;
  bool spherical_ = false;
  double max_angle_ = 1.5697963271282298;  // atan(max_radius_)
  double field_angle_ = 1.5697963271282298;
  ObservationPlane plane_ = ObservationPlane::kNormalized;
};

}  // namespace alidade
