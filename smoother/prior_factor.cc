#include "smoother/prior_factor.h"

#include <Eigen/Cholesky>

#include "smoother/imu_factor.h"

namespace alidade {
namespace {

template <int kColumns>
using RowMap = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, kColumns, Eigen::RowMajor>>;

}  // namespace

bool MakeInitialPrior(ErrorConvention convention, const WindowFrame& frame, const Matrix15d& covariance,
                      LinearPrior* prior) {
  const NavState state = frame.nav_state();
  const Matrix15d to_xi = InverseImuChartJacobian(convention, state);
  Matrix15d covariance_xi = to_xi * covariance * to_xi.transpose();
  // A direction given as exactly known gets a deviation far below every unit's use, so that the prior exists.
  covariance_xi.diagonal().array() += 1e-18;
  const Eigen::LLT<Matrix15d> factor(covariance_xi);
  if (factor.info() != Eigen::Success) {
    return false;
  }
  prior->convention = convention;
  prior->anchors = {{&frame, state, frame.imu_bias()}};
  prior->jacobian = factor.matrixL().solve(Matrix15d::Identity());
  prior->residual = Vector15d::Zero();
  return prior->jacobian.allFinite();
}

PriorFactor::PriorFactor(const LinearPrior* prior) : prior_(prior) {
  blocks_ = {BlockKind::kNavState, BlockKind::kBias};
  blocks_.resize(prior->anchors.size() + 1, BlockKind::kNavState);
  if (prior->clock_origin) {
    blocks_.push_back(BlockKind::kClock);
  }
}

bool PriorFactor::Evaluate(const double* const* parameters, double* residual,
                           double* const* tangent_jacobians) const {
  const Eigen::MatrixXd& J = prior_->jacobian;
  Eigen::Map<Eigen::VectorXd> r(residual, rows());
  r = prior_->residual;
  const int count = static_cast<int>(prior_->anchors.size());
  for (int i = 0; i < count; ++i) {
    const LinearPrior::Anchor& anchor = prior_->anchors[static_cast<size_t>(i)];
    const int block = i == 0 ? 0 : i + 1;
    const int column = LinearPrior::Column(i);
    const int width = i == 0 ? 9 : 6;
    const NavState state = UnpackNavState(parameters[block]);
    const Vector9d xi = Local(prior_->convention, anchor.origin, state);
    r.noalias() += J.middleCols(column, width) * xi.head(width);
    if (tangent_jacobians != nullptr && tangent_jacobians[block] != nullptr) {
      const Matrix9d chain = LocalJacobian(prior_->convention, anchor.origin, state) *
                             InverseChartJacobian(prior_->convention, state);
      RowMap<9>(tangent_jacobians[block], rows(), 9).noalias() =
          J.middleCols(column, width) * chain.topRows(width);
    }
  }
  const ImuBias bias = UnpackBias(parameters[1]);
  Vector6d shift;
  shift << bias.gyro - prior_->anchors.front().bias_origin.gyro,
      bias.accel - prior_->anchors.front().bias_origin.accel;
  r.noalias() += J.middleCols<6>(9) * shift;
  if (tangent_jacobians != nullptr && tangent_jacobians[1] != nullptr) {
    RowMap<6>(tangent_jacobians[1], rows(), 6) = J.middleCols<6>(9);
  }
  if (prior_->clock_origin) {
    const int block = count + 1;
    const Eigen::Map<const Vector6d> clock(parameters[block]);
    r.noalias() += J.rightCols<6>() * (clock - *prior_->clock_origin);
    if (tangent_jacobians != nullptr && tangent_jacobians[block] != nullptr) {
      RowMap<6>(tangent_jacobians[block], rows(), 6) = J.rightCols<6>();
    }
  }
  return true;
}

}  // namespace alidade
