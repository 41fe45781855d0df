#include "frontend/initialization/middle_row.h"

#include "core/lie.h"
#include "core/visual_observation.h"

namespace alidade {

TrackFrame AtMiddleRow(const RigCalibration& rig, const Eigen::Vector3d& gyro_radps, TrackFrame frame) {
  if (rig.line_delay_s == 0) {
    return frame;
  }
  const Eigen::Vector3d rate_C = rig.T_BC.rotation.transpose() * gyro_radps;
  for (TrackObservation& observation : frame.observations) {
    const double later_s = rig.line_delay_s * (observation.pixel.y() - 0.5 * rig.camera.height_px());
    Eigen::Vector3d ray;
    Eigen::Vector2d pixel;
    if (PixelRay(rig.camera, observation.pixel, &ray) &&
        rig.camera.Project(so3::Exp(Eigen::Vector3d(later_s * rate_C)) * ray, &pixel)) {
      observation.pixel = pixel;
    }
  }
  return frame;
}

}  // namespace alidade
