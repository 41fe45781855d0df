#include "eval/identify/linear_recorder.h"

#include <algorithm>

#include "core/dense_solvers.h"
#include "core/preintegration.h"
#include "eval/identify/innovation_likelihood.h"
#include "filter/filter_state.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The rows that are not zero; those of a refused track are.
void KeepRows(const FilterRows& all, MatrixXd* rows, VectorXd* innovation) {
  std::vector<Index> kept;
  for (Index i = 0; i < all.jacobian.rows(); ++i) {
    if (!all.jacobian.row(i).isZero(0)) {
      kept.push_back(i);
    }
  }
  rows->resize(static_cast<Index>(kept.size()), all.jacobian.cols());
  innovation->resize(rows->rows());
  for (Index i = 0; i < rows->rows(); ++i) {
    rows->row(i) = all.jacobian.row(kept[static_cast<std::size_t>(i)]);
    (*innovation)[i] = all.innovation[kept[static_cast<std::size_t>(i)]];
  }
}

int FirstColumn(const MatrixXd& rows) {
  int first = 0;
  while (first < rows.cols() && rows.col(first).isZero(0)) {
    ++first;
  }
  return first;
}

}  // namespace

LinearRecorder::LinearRecorder(const ImuNoise& noise, const Eigen::Vector3d& gravity_W)
    : noises_{{{noise.gyro_noise_density_radps_sqrthz, 0, 0, 0},
               {0, noise.accel_noise_density_mps2_sqrthz, 0, 0},
               {0, 0, noise.gyro_random_walk_radps2_sqrthz, 0},
               {0, 0, 0, noise.accel_random_walk_mps3_sqrthz}}},
      gravity_W_(gravity_W) {}

void LinearRecorder::AddRestart() {
  const SquareRootCovariance& covariance = state_->covariance();
  MatrixXd root = covariance.factor().triangularView<Eigen::Upper>();
  system_.capacity = std::max(system_.capacity, covariance.capacity());
  system_.max_leading = std::max(system_.max_leading, covariance.leading());
  system_.steps.emplace_back(LinearSystem::Restart{covariance.leading(), std::move(root)});
}

void LinearRecorder::OnReset(const FilterState& state) {
  state_ = &state;
  AddRestart();
}

void LinearRecorder::OnImu(const FilterState& state, std::span<const ImuSample> samples) {
  for (std::size_t j = 0; j < noises_.size(); ++j) {
    Preintegration preintegration(state.bias(), noises_[j]);
    preintegration.Add(samples);
    const NavState end = CarryState(preintegration, state.nav(), state.bias(), gravity_W_, nullptr);
    // The increments of position and velocity are in the body frame at the start.
    Matrix15d map = Matrix15d::Identity();
    map.block<3, 3>(3, 3) = map.block<3, 3>(6, 6) = state.nav().R_WB;
    map = InverseImuChartJacobian(state.convention(), end) * map;
    q_[j] = map * preintegration.covariance() * map.transpose();
  }
}

void LinearRecorder::OnPropagate(const Matrix15d& phi, const Matrix15d& /*q*/) {
  system_.steps.emplace_back(LinearSystem::Propagation{phi, q_});
}

void LinearRecorder::OnClone(int first, int size) {
  system_.steps.emplace_back(LinearSystem::Cloning{first, size});
}

void LinearRecorder::OnRemove(int first, int size) {
  system_.steps.emplace_back(LinearSystem::Removal{first, size});
}

void LinearRecorder::OnAlign(const MatrixXd& /*turn*/, bool /*has_clock*/) {
  // The alignment's own covariance does not depend on the noises in question: the filter's belief is kept.
  AddRestart();
}

void LinearRecorder::OnShear(const VectorXd& column, const VectorXd& row) {
  system_.steps.emplace_back(LinearSystem::Shear{column, row});
}

void LinearRecorder::OnPropagateClock(const Matrix6d& phi, const Matrix6d& q) {
  system_.steps.emplace_back(LinearSystem::ClockPropagation{phi, q});
}

void LinearRecorder::OnUpdate(const FilterState& /*state*/, const FilterRows& rows) {
  LinearSystem::Update update;
  update.source = rows.source;
  MatrixXd jacobian;
  KeepRows(rows, &jacobian, &update.innovation);
  if (jacobian.rows() == 0) {
    return;
  }
  system_.rows[static_cast<std::size_t>(rows.source)] += static_cast<std::size_t>(jacobian.rows());
  update.first = FirstColumn(jacobian);
  update.rows = jacobian.rightCols(jacobian.cols() - update.first);
  const Index columns = update.rows.cols();
  if (update.rows.rows() > columns) {
    update.discarded_rows = static_cast<int>(update.rows.rows() - columns);
    update.rows = UpperTriangle(MatrixXd(update.rows), &update.innovation);
    update.discarded = update.innovation.tail(update.discarded_rows).squaredNorm();
    update.innovation.conservativeResize(columns);
  }
  system_.steps.emplace_back(std::move(update));
}

void LinearRecorder::OnFrame(const FilterState& state) {
  ++system_.frames;
  system_.steps.emplace_back(LinearSystem::FrameEnd{state.stamp_ns()});
}

Result<LinearSystem> LinearRecorder::Take() {
  ALIDADE_RETURN_IF_ERROR(FillCorrections(&system_));
  return std::move(system_);
}

}  // namespace alidade
