#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>
#include <vector>

#include "core/status.h"

namespace alidade {

/// Lens model between the ideal normalised plane (x, y) = (X/Z, Y/Z) and the distorted one (x_d, y_d); then
/// u = fu x_d + cu, v = fv y_d + cv. With r^2 = x^2 + y^2:
///
///   none               x_d = x
///   radial-tangential  x_d = x (1 + k1 r^2 + k2 r^4) + 2 p1 x y + p2 (r^2 + 2 x^2), likewise y (Brown)
///   equidistant        t = atan(r), x_d = x/r t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8)
///   fov                r_d = atan(2 r tan(w/2)) / w, x_d = x/r r_d (Devernay, Faugeras 2001)
///   mei                m = x / (1 + xi sqrt(1 + r^2)), then radial-tangential of m (Mei, Rives 2007);
///                      xi: mirror parameter of the unified sphere; fu, fv: generalised focal lengths gamma
///   double-sphere      d1 = |p|, d2 = sqrt(X^2 + Y^2 + (xi d1 + Z)^2),
///                      x_d = X / (alpha d2 + (1 - alpha) (xi d1 + Z)) (Usenko, Demmel, Cremers 2018)
///   eucm               d = sqrt(beta (X^2 + Y^2) + Z^2), x_d = X / (alpha d + (1 - alpha) Z) (Khomutenko,
///                      Garcia, Martinet 2016)
///
/// Radial-tangential coefficients come in OpenCV's order k1 k2 p1 p2, mei's are xi k1 k2 p1 p2,
/// double-sphere's xi alpha, eucm's alpha beta; equidistant is Kannala, Brandt 2006, with t the angle off
/// axis. Double-sphere, eucm and equidistant with a wide field (CameraModel::is_spherical) hold for points
/// beside and behind the camera too; of the others, mei too, the half space before the camera alone is
/// modelled.
enum class DistortionModel { kNone, kRadialTangential, kEquidistant, kFov, kMei, kDoubleSphere, kEucm };
using LensCoefficients = Eigen::Matrix<double, 5, 1>;

[[nodiscard]] std::optional<DistortionModel> ParseDistortionModel(std::string_view name);
[[nodiscard]] std::string_view ToString(DistortionModel model);
/// Number of coefficients the model takes.
[[nodiscard]] int CoefficientCount(DistortionModel model);
/// Errors (kInput): a wrong number of coefficients, one that is not finite or outside its range
/// (CameraModel::Create).
Status CheckCoefficients(DistortionModel model, const std::vector<double>& coefficients);

}  // namespace alidade
