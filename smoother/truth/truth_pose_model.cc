#include "smoother/truth/truth_pose_model.h"

#include "core/lever_arm.h"
#include "core/lie.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TruthConstants Retract(const TruthConstants& constants, const TruthConstantsError& error) {
  const Vector3d tilt(error[kTiltColumn], error[kTiltColumn + 1], 0);
  TruthConstants moved;
  moved.R_TW = so3::Between(Vector3d::UnitZ(), constants.R_TW * so3::Exp(tilt) * Vector3d::UnitZ());
  moved.T_BM.rotation = so3::Normalize(constants.T_BM.rotation * so3::Exp(error.segment<3>(kMarkerColumn)));
  moved.T_BM.translation = constants.T_BM.translation + error.segment<3>(kLeverColumn);
  moved.time_offset_s = constants.time_offset_s + error[kTimeColumn];
  return moved;
}

void TruthPoseModel::Evaluate(const NavState& state, const Vector3d& angular_rate_B,
                              const TruthConstants& constants, Vector6d* residual,
                              Eigen::Matrix<double, 6, 9>* jacobian_state,
                              Eigen::Matrix<double, 6, kTruthConstants>* jacobian_constants) const {
  const Matrix3d& R_BM = constants.T_BM.rotation;
  const Vector3d& p_BM = constants.T_BM.translation;
  const Matrix3d R_TB = constants.R_TW * state.R_WB;
  LeverArm::Jacobian marker;
  const Vector3d p_WM = LeverArm{p_BM}.Position(state, &marker);
  const Vector3d turn = so3::Log(T_TM_measured.rotation.transpose() * R_TB * R_BM);
  *residual << turn, constants.R_TW * p_WM - T_TM_measured.translation;
  const Matrix3d right_inverse = so3::RightJacobianInverse(turn);
  const Matrix3d of_phi = right_inverse * R_BM.transpose();
  if (jacobian_state != nullptr) {
    jacobian_state->setZero();
    jacobian_state->block<3, 3>(0, 0) = of_phi;
    jacobian_state->bottomRows<3>() = constants.R_TW * marker.leftCols<9>();
  }
  if (jacobian_constants != nullptr) {
    jacobian_constants->setZero();
    jacobian_constants->block<3, 2>(0, kTiltColumn) = (of_phi * state.R_WB.transpose()).leftCols<2>();
    jacobian_constants->block<3, 2>(3, kTiltColumn) = (-constants.R_TW * Skew(p_WM)).leftCols<2>();
    jacobian_constants->block<3, 3>(0, kMarkerColumn) = right_inverse;
    jacobian_constants->block<3, 3>(3, kLeverColumn) = R_TB;
    jacobian_constants->block<3, 1>(0, kTimeColumn) = of_phi * angular_rate_B;
    jacobian_constants->block<3, 1>(3, kTimeColumn) =
        constants.R_TW * LeverArm{p_BM}.Velocity(state, ImuBias{}, angular_rate_B);
  }
}

}  // namespace alidade
