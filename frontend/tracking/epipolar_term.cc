#include "frontend/tracking/epipolar_term.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/turned_ray.h"

namespace alidade {

using Eigen::Vector3d;

EpipolarTerm EvaluateEpipolar(const BearingPair& pair, const CameraMotion& motion,
                              const EpipolarOptions& options) {
  EpipolarTerm term{.g = TurnedRay(motion.R_21, pair.first),
                    .x_2 = pair.second,
                    .error = 0,
                    .scale = 0,
                    .at_epipole = false};
  const Vector3d line = motion.t.cross(term.g);
  const double norm = options.on_sphere ? line.norm() : line.head<2>().norm();
  // Within half a pixel of the epipole the line's direction is noise.
  term.at_epipole = norm * options.focal_px < 0.5 * (options.on_sphere ? 1 : std::abs(term.g.z()));
  term.error = term.x_2.dot(line);
  term.scale = norm > 0 ? options.focal_px / norm : 0;
  return term;
}

double DisplacementPx(const EpipolarTerm& term, const EpipolarOptions& options) {
  const double displacement =
      options.on_sphere ? (term.x_2 - term.g).norm() : (term.x_2.head<2>() - term.g.hnormalized()).norm();
  return displacement * options.focal_px;
}

bool IsInlier(const EpipolarTerm& term, const EpipolarOptions& options) {
  if (!options.on_sphere && term.g.z() <= 0) {
    return false;
  }
  if (term.at_epipole) {
    return DisplacementPx(term, options) <= options.threshold_px;
  }
  return std::abs(term.error) * term.scale <= options.threshold_px;
}

}  // namespace alidade
