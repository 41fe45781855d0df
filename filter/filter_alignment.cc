#include <Eigen/Cholesky>

#include "core/check.h"
#include "filter/filter_state.h"

// The step of FilterState from a local world into the ENU frame.

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr int kClockSize = FilterState::kClockSize;

/// Turn and shift of a pose or a navigation state.
NavState Moved(const NavState& state, const Eigen::Matrix3d& R_NW, const Vector3d& p_NW) {
  return {R_NW * state.R_WB, R_NW * state.p_WB + p_NW, R_NW * state.v_WB};
}
Pose Moved(const Pose& pose, const Eigen::Matrix3d& R_NW, const Vector3d& p_NW) {
  return {R_NW * pose.rotation, R_NW * pose.translation + p_NW};
}

/// What a turn by yaw about W's origin and a shift do to a state that stands in N, canonical chart, 9 x 4.
Eigen::Matrix<double, 9, 4> AlignmentJacobian(const NavState& moved, const Vector3d& p_NW) {
  Eigen::Matrix<double, 9, 4> jacobian = Eigen::Matrix<double, 9, 4>::Zero();
  jacobian.block<3, 1>(0, 0) = moved.R_WB.transpose() * Vector3d::UnitZ();
  jacobian.block<3, 1>(3, 0) = Vector3d::UnitZ().cross(moved.p_WB - p_NW);
  jacobian.block<3, 1>(6, 0) = Vector3d::UnitZ().cross(moved.v_WB);
  jacobian.block<3, 3>(3, 1).setIdentity();
  return jacobian;
}

/// The canonical chart's error turns with the world where it is a vector of the world: dp and dv.
Matrix9d TurnOfChart(const Eigen::Matrix3d& R_NW) {
  Matrix9d turn = Matrix9d::Identity();
  turn.block<3, 3>(3, 3) = R_NW;
  turn.block<3, 3>(6, 6) = R_NW;
  return turn;
}

}  // namespace

void FilterState::Align(const Eigen::Matrix3d& R_NW, const Vector3d& p_NW, const Eigen::Matrix4d& covariance,
                        const std::optional<Matrix6d>& clock_covariance) {
  CHECK(landmarks_.empty());
  const Index n = covariance_.dimension();
  MatrixXd factor = covariance_.factor().triangularView<Eigen::Upper>();
  MatrixXd alignment = MatrixXd::Zero(n, 4);
  const Matrix9d turn = TurnOfChart(R_NW);
  MatrixXd maps = MatrixXd::Identity(n, n);
  const auto move = [&](const NavState& before, const NavState& after, Index offset, Index size) {
    const Matrix9d to_error = InverseChartJacobian(convention_, after);
    const Matrix9d map = to_error * turn * ChartJacobian(convention_, before);
    maps.block(offset, offset, size, size) = map.topLeftCorner(size, size);
    const MatrixXd rows = map.topLeftCorner(size, size) * factor.middleRows(offset, size);
    factor.middleRows(offset, size) = rows;
    alignment.middleRows(offset, size) = (to_error * AlignmentJacobian(after, p_NW)).topRows(size);
  };
  const NavState moved = Moved(nav_, R_NW, p_NW);
  move(nav_, moved, 0, 9);
  for (size_t i = 0; i < clones_.size(); ++i) {
    Clone& clone = clones_[i];
    const Pose after = Moved(clone.T_WB, R_NW, p_NW);
    move({clone.T_WB.rotation, clone.T_WB.translation, Vector3d::Zero()},
         {after.rotation, after.translation, Vector3d::Zero()}, CloneOffset(i), 6);
    clone.T_WB = after;
    clone.T_WB_first = Moved(clone.T_WB_first, R_NW, p_NW);
    RefreshClone(&clone);
  }
  nav_ = moved;
  nav_first_ = Moved(nav_first_, R_NW, p_NW);
  const Eigen::LLT<Eigen::Matrix4d> root(covariance);
  CHECK(root.info() == Eigen::Success) << "covariance of the alignment";
  const int clock = clock_covariance ? kClockSize : 0;
  MatrixXd stacked = MatrixXd::Zero(clock + n, clock + n + 4);
  if (clock_covariance) {
    const Eigen::LLT<Matrix6d> clock_root(*clock_covariance);
    CHECK(clock_root.info() == Eigen::Success) << "covariance of the clock";
    stacked.topLeftCorner<kClockSize, kClockSize>() = clock_root.matrixL();
  }
  stacked.block(clock, clock, n, n) = factor;
  stacked.bottomRightCorner(n, 4) = alignment * root.matrixL().toDenseMatrix();
  covariance_.Assign(clock, stacked);
  if (observer_ != nullptr) {
    observer_->OnAlign(maps, clock > 0);
  }
}

}  // namespace alidade
