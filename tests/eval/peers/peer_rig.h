#pragma once

#include <vector>

#include "core/lie.h"
#include "core/rig_calibration.h"

namespace alidade::test {

/// A rig whose lens and extrinsics no default has.
inline RigCalibration PeerRig(DistortionModel model) {
  RigCalibration rig;
  std::vector<double> coefficients = {-0.28, 0.07, 5e-5, -1e-4};
  if (model == DistortionModel::kMei) {
    coefficients.insert(coefficients.begin(), 1.8);
  }
  rig.camera =
      CameraModel::Create(model, Eigen::Vector4d(461.6, 460.3, 363, 248.1), coefficients, 752, 480).value();
  rig.T_BC = {so3::Exp(Eigen::Vector3d(-1.2, 1.2, -1.2)), Eigen::Vector3d(0.1, -0.05, 0.04)};
  rig.camera_time_offset_s = -0.0125;
  return rig;
}

}  // namespace alidade::test
