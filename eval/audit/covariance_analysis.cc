#include "eval/audit/covariance_analysis.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/error_convention.h"
#include "filter/filter_state.h"

namespace alidade {

using Eigen::Index;
using Eigen::MatrixXd;

void CovarianceAnalysis::OnReset(const FilterState& state) {
  actual_ = state.covariance().Covariance();
  cross_.resize(actual_.rows(), 0);
  kept_.clear();
  used_.clear();
  met_landmark_ = false;
}

void CovarianceAnalysis::Transform(const MatrixXd& map) {
  actual_ = (map * actual_ * map.transpose()).eval();
  cross_ = (map * cross_).eval();
}

void CovarianceAnalysis::OnPropagate(const Matrix15d& phi, const Matrix15d& q) {
  if (met_landmark_) {
    return;
  }
  actual_.topRows<15>() = (phi * actual_.topRows<15>()).eval();
  actual_.leftCols<15>() = (actual_.leftCols<15>() * phi.transpose()).eval();
  actual_.topLeftCorner<15, 15>() += q;
  cross_.topRows<15>() = (phi * cross_.topRows<15>()).eval();
}

void CovarianceAnalysis::OnClone(int first, int size) {
  if (met_landmark_) {
    return;
  }
  const Index old = actual_.rows();
  MatrixXd map = MatrixXd::Zero(old + size, old);
  map.topLeftCorner<15, 15>().setIdentity();
  map.block(15, first, size, size).setIdentity();
  map.bottomRightCorner(old - 15, old - 15).setIdentity();
  Transform(map);
}

void CovarianceAnalysis::OnAddLandmark(int /*first*/, const MatrixXd& /*rows*/) {
  met_landmark_ = true;
}

void CovarianceAnalysis::OnRemove(int first, int size) {
  if (met_landmark_) {
    return;
  }
  const Index left = actual_.rows() - size;
  MatrixXd map = MatrixXd::Zero(left, left + size);
  map.topLeftCorner(first, first).setIdentity();
  map.bottomRightCorner(left - first, left - first).setIdentity();
  Transform(map);
}

int CovarianceAnalysis::FindKept(std::int64_t track_id, int serial) const {
  for (size_t i = 0; i < kept_.size(); ++i) {
    if (kept_[i].track_id == track_id && kept_[i].serial == serial) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

void CovarianceAnalysis::OnShear(const Eigen::VectorXd& column, const Eigen::VectorXd& row) {
  if (!met_landmark_) {
    Transform(MatrixXd::Identity(actual_.rows(), actual_.rows()) + column * row.transpose());
  }
}

void CovarianceAnalysis::OnUpdate(const FilterState& state, const FilterRows& rows) {
  if (met_landmark_) {
    return;
  }
  if (std::any_of(rows.blocks.begin(), rows.blocks.end(),
                  [](const TracedBlock& block) { return block.serials.empty(); })) {
    met_landmark_ = true;  // a track's memory carries one past its views
    return;
  }
  const MatrixXd& h = rows.jacobian;
  const MatrixXd projected = h * state.covariance().Covariance();
  MatrixXd innovation = projected * h.transpose();
  innovation.diagonal().array() += 1;
  const MatrixXd gain = innovation.llt().solve(projected).transpose();
  // Covariance of V n: tracks share no observation, so it is block-diagonal. Rows without a track are as the
  // filter assumes.
  MatrixXd noise = MatrixXd::Identity(h.rows(), h.rows());
  MatrixXd reused = MatrixXd::Zero(h.rows(), cross_.cols());
  for (const TracedBlock& block : rows.blocks) {
    noise.block(block.first, block.first, block.rows, block.rows) = block.noise * block.noise.transpose();
    for (size_t k = 0; k < block.serials.size(); ++k) {
      const int kept = FindKept(block.track_id, block.serials[k]);
      if (kept >= 0) {
        reused.block(block.first, 2 * kept, block.rows, 2) =
            block.noise.middleCols(2 * static_cast<Index>(k), 2);
      } else if (!used_.emplace(block.track_id, block.serials[k]).second) {
        ++unmodelled_reuse_;
      }
    }
  }
  const MatrixXd keeps = MatrixXd::Identity(actual_.rows(), actual_.rows()) - gain * h;
  const MatrixXd correlated = keeps * (cross_ * reused.transpose()) * gain.transpose();
  actual_ = (keeps * actual_ * keeps.transpose() + gain * noise * gain.transpose()).eval();
  actual_ -= correlated + correlated.transpose();
  actual_ = (0.5 * (actual_ + actual_.transpose())).eval();
  cross_ = (keeps * cross_ - gain * reused).eval();
  KeepBases(gain, rows);
}

void CovarianceAnalysis::KeepBases(const MatrixXd& gain, const FilterRows& rows) {
  std::vector<const TracedBlock*> fresh;
  for (const TracedBlock& block : rows.blocks) {
    if (FindKept(block.track_id, block.serials.front()) < 0) {
      fresh.push_back(&block);
    }
  }
  Index column = cross_.cols();
  cross_.conservativeResize(Eigen::NoChange, column + 2 * static_cast<Index>(fresh.size()));
  for (const TracedBlock* block : fresh) {
    cross_.middleCols<2>(column) = -gain.middleCols(block->first, block->rows) * block->noise.leftCols<2>();
    kept_.push_back({block->track_id, block->serials.front()});
    column += 2;
  }
}

void CovarianceAnalysis::OnFrame(const FilterState& state) {
  if (met_landmark_) {
    return;
  }
  CovarianceRecord record;
  record.stamp_ns = state.stamp_ns();
  const Matrix6d reported = state.covariance().CoreCovariance().topLeftCorner<6, 6>();
  const Matrix6d actual = actual_.topLeftCorner<6, 6>();
  record.nees_ratio = reported.llt().solve(actual).trace() / 6;
  const Matrix6d chart = ChartJacobian(state.convention(), state.nav().T_WB());
  const Matrix6d canonical = chart * actual * chart.transpose();
  record.orientation_rad = std::sqrt(canonical.diagonal().head<3>().sum());
  record.position_m = std::sqrt(canonical.diagonal().tail<3>().sum());
  records_.push_back(record);
  // Noise of observations whose clone has left can never enter again.
  std::vector<KeptNoise> left;
  for (size_t i = 0; i < kept_.size(); ++i) {
    if (state.FindClone(kept_[i].serial) >= 0) {
      cross_.middleCols<2>(2 * static_cast<Index>(left.size())) =
          cross_.middleCols<2>(2 * static_cast<Index>(i)).eval();
      left.push_back(kept_[i]);
    }
  }
  kept_ = std::move(left);
  cross_.conservativeResize(Eigen::NoChange, 2 * static_cast<Index>(kept_.size()));
  std::erase_if(used_, [&](const auto& use) { return state.FindClone(use.second) < 0; });
}

}  // namespace alidade
