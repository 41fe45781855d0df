#include "eval/calibrate/camera_gyro_model.h"

#include <vector>

#include "core/lie.h"
#include "core/status.h"

namespace alidade {
namespace {

using Coordinate = CameraGyroCoordinate;

}  // namespace

bool Retract(const CameraGyroError& error, CameraGyroModel* model) {
  if (!error.allFinite()) {
    return false;
  }
  Eigen::Vector4d intrinsics = model->camera.intrinsics();
  intrinsics[0] *= 1 + error[Coordinate::kFocal] + error[Coordinate::kFocalRatio] / 2;
  intrinsics[1] *= 1 + error[Coordinate::kFocal] - error[Coordinate::kFocalRatio] / 2;
  intrinsics.tail<2>() += error.segment<2>(Coordinate::kCentre);
  const LensCoefficients lens = model->camera.coefficients() + error.segment<5>(Coordinate::kLens);
  const std::vector<double> coefficients(lens.data(), lens.data() + CoefficientCount(model->camera.model()));
  const Result<CameraModel> camera = CameraModel::Create(model->camera.model(), intrinsics, coefficients,
                                                         model->camera.width_px(), model->camera.height_px());
  if (!camera.ok()) {
    return false;
  }
  model->camera = *camera;
  model->gyro_bias += error.segment<3>(Coordinate::kGyroBias);
  model->R_BC = so3::Normalize(model->R_BC * so3::Exp(error.segment<3>(Coordinate::kRotation)));
  model->time_offset_s += error[Coordinate::kTimeOffset];
  model->readout_s += error[Coordinate::kReadout];
  return true;
}

CameraGyroError CameraGyroOffset(const CameraGyroModel& from, const CameraGyroModel& to) {
  CameraGyroError error = CameraGyroError::Zero();
  error.segment<3>(Coordinate::kGyroBias) = to.gyro_bias - from.gyro_bias;
  error.segment<3>(Coordinate::kRotation) = so3::Log(from.R_BC.transpose() * to.R_BC);
  error[Coordinate::kTimeOffset] = to.time_offset_s - from.time_offset_s;
  error[Coordinate::kReadout] = to.readout_s - from.readout_s;
  const Eigen::Vector4d& a = from.camera.intrinsics();
  const Eigen::Vector4d& b = to.camera.intrinsics();
  error[Coordinate::kFocal] = (b[0] / a[0] + b[1] / a[1]) / 2 - 1;
  error[Coordinate::kFocalRatio] = b[0] / a[0] - b[1] / a[1];
  error.segment<2>(Coordinate::kCentre) = b.tail<2>() - a.tail<2>();
  error.segment<5>(Coordinate::kLens) = to.camera.coefficients() - from.camera.coefficients();
  return error;
}

CameraGyroError CameraGyroPrior() {
  CameraGyroError prior = CameraGyroError::Zero();
  prior.segment<3>(Coordinate::kGyroBias).setConstant(0.1);
  prior.segment<3>(Coordinate::kRotation).setConstant(1);
  prior[Coordinate::kTimeOffset] = 0.3;
  return prior;
}

}  // namespace alidade
