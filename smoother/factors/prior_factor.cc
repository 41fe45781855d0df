#include "smoother/factors/prior_factor.h"

#include <Eigen/Cholesky>
#include <utility>

#include "smoother/factors/imu_factor.h"

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

void AddCalibrationPrior(const CalibrationEstimate& estimate, LinearPrior* prior) {
  const Eigen::Index rows = prior->jacobian.rows();
  const Eigen::Index columns = prior->jacobian.cols();
  const Eigen::Index size = estimate.layout.size();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows + size, columns + size);
  jacobian.topLeftCorner(rows, columns) = prior->jacobian;
  jacobian.bottomRightCorner(size, size).diagonal() = estimate.deviations.cwiseInverse();
  prior->jacobian = std::move(jacobian);
  prior->residual.conservativeResize(rows + size);
  prior->residual.tail(size).setZero();
  prior->calibration_origin = WindowCalibration{estimate.layout, estimate.mean};
}

PriorFactor::PriorFactor(const LinearPrior* prior, const WindowCalibration* calibration)
    : prior_(prior), calibration_(calibration) {
  blocks_ = {BlockKind::kNavState, BlockKind::kBias};
  blocks_.resize(prior->anchors.size() + 1, BlockKind::kNavState);
  if (prior->clock_origin) {
    blocks_.push_back(BlockKind::kClock);
  }
  if (calibration_ != nullptr) {
    blocks_.push_back(BlockKind::kCalibration);
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
    r.noalias() += J.middleCols<6>(prior_->ClockColumn()) * (clock - *prior_->clock_origin);
    if (tangent_jacobians != nullptr && tangent_jacobians[block] != nullptr) {
      RowMap<6>(tangent_jacobians[block], rows(), 6) = J.middleCols<6>(prior_->ClockColumn());
    }
  }
  if (calibration_ != nullptr) {
    const int block = count + 1 + (prior_->clock_origin ? 1 : 0);
    const WindowCalibration& origin = *prior_->calibration_origin;
    CameraCalibration camera;
    if (!calibration_->At(parameters[block], &camera)) {
      return false;
    }
    const auto columns = J.middleCols(prior_->CalibrationColumn(), origin.size());
    r.noalias() += columns * Local(origin.layout, origin.mean, camera);
    if (tangent_jacobians != nullptr && tangent_jacobians[block] != nullptr) {
      constexpr int kWidth = CalibrationLayout::kMaxSize;
      RowMap<kWidth> out(tangent_jacobians[block], rows(), kWidth);
      out.setZero();
      out.leftCols(origin.size()).noalias() = columns * LocalJacobian(origin.layout, origin.mean, camera) *
                                              calibration_->BlockJacobian(parameters[block]);
    }
  }
  return true;
}

}  // namespace alidade
