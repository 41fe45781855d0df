#include "smoother/window/window_calibration.h"

namespace alidade {

using Eigen::MatrixXd;
using Eigen::Vector3d;

const WindowCalibration& NotCalibrated() {
  static const WindowCalibration calibration;
  return calibration;
}

bool WindowCalibration::At(const double* block, CameraCalibration* calibration) const {
  *calibration = mean;
  return Retract(layout, Eigen::Map<const Eigen::VectorXd>(block, size()), calibration);
}

MatrixXd WindowCalibration::BlockJacobian(const double* block) const {
  MatrixXd jacobian = MatrixXd::Identity(size(), size());
  if (layout.extrinsics() >= 0) {
    const Vector3d phi = Eigen::Map<const Vector3d>(block + layout.extrinsics());
    jacobian.block<3, 3>(layout.extrinsics(), layout.extrinsics()) = so3::RightJacobian(phi);
  }
  return jacobian;
}

MatrixXd LocalJacobian(const CalibrationLayout& layout, const CameraCalibration& origin,
                       const CameraCalibration& estimate) {
  MatrixXd jacobian = MatrixXd::Identity(layout.size(), layout.size());
  if (layout.extrinsics() >= 0) {
    const Vector3d phi = so3::Log(origin.T_BC.rotation.transpose() * estimate.T_BC.rotation);
    jacobian.block<3, 3>(layout.extrinsics(), layout.extrinsics()) = so3::RightJacobianInverse(phi);
  }
  return jacobian;
}

}  // namespace alidade
