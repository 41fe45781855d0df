#include "core/observation_plane.h"

namespace alidade {

RigCalibration OnPlane(const RigCalibration& rig, PlaneChoice choice) {
  RigCalibration placed = rig;
  switch (choice) {
    case PlaneChoice::kLens:
      break;
    case PlaneChoice::kNormalized:
      placed.camera = rig.camera.WithPlane(ObservationPlane::kNormalized);
      break;
    case PlaneChoice::kTangent:
      placed.camera = rig.camera.WithPlane(ObservationPlane::kTangent);
      break;
  }
  return placed;
}

}  // namespace alidade
