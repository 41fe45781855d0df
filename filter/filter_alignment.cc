#include <Eigen/Cholesky>

#include "core/check.h"
#include "filter/filter_state.h"

// The step of FilterState from a local world into the ENU frame.

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

}  // namespace

void FilterState::Align(const YawShift& transform, const Eigen::Matrix4d& covariance,
                        const std::optional<Matrix6d>& clock_covariance) {
  CHECK(landmarks_.empty());
  const Index n = covariance_.dimension();
  MatrixXd factor = covariance_.factor().triangularView<Eigen::Upper>();
  MatrixXd alignment = MatrixXd::Zero(n, 4);
  const Matrix9d turn = transform.StateJacobian();
  MatrixXd maps = MatrixXd::Identity(n, n);
  const auto move = [&](const NavState& before, const NavState& after, Index offset, Index size) {
    const Matrix9d to_error = InverseChartJacobian(convention_, after);
    const Matrix9d map = to_error * turn * ChartJacobian(convention_, before);
    maps.block(offset, offset, size, size) = map.topLeftCorner(size, size);
    const MatrixXd rows = map.topLeftCorner(size, size) * factor.middleRows(offset, size);
    factor.middleRows(offset, size) = rows;
    alignment.middleRows(offset, size) = (to_error * transform.ParameterJacobian(after)).topRows(size);
  };
  const NavState moved = transform * nav_;
  move(nav_, moved, 0, 9);
  for (size_t i = 0; i < clones_.size(); ++i) {
    Clone& clone = clones_[i];
    const Pose after = transform * clone.T_WB;
    move({clone.T_WB.rotation, clone.T_WB.translation, Vector3d::Zero()},
         {after.rotation, after.translation, Vector3d::Zero()}, CloneOffset(i), 6);
    clone.T_WB = after;
    clone.T_WB_first = transform * clone.T_WB_first;
    RefreshClone(&clone);
  }
  strain_.Turn(transform.Rotation());
  nav_ = moved;
  nav_first_ = transform * nav_first_;
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
