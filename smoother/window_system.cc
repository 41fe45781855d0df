#include "smoother/window_system.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <array>

#include "smoother/imu_factor.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// J of the prior over 15 canonical coordinates of each anchor's frame, at the present states.
void AddPriorHessian(const LinearPrior& prior, MatrixXd* hessian) {
  const Index rows = prior.jacobian.rows();
  const Index count = static_cast<Index>(prior.anchors.size());
  MatrixXd jacobian = MatrixXd::Zero(rows, 15 * count);
  for (Index i = 0; i < count; ++i) {
    const LinearPrior::Anchor& anchor = prior.anchors[static_cast<size_t>(i)];
    const NavState state = anchor.frame->nav_state();
    const Matrix9d chain =
        LocalJacobian(prior.convention, anchor.origin, state) * InverseChartJacobian(prior.convention, state);
    const int width = i == 0 ? 9 : 6;
    jacobian.middleCols(15 * i, 9).noalias() =
        prior.jacobian.middleCols(LinearPrior::Column(static_cast<int>(i)), width) * chain.topRows(width);
  }
  jacobian.middleCols<6>(9) = prior.jacobian.middleCols<6>(9);
  // Anchors are the window's first frames, in order: their columns are the leading ones.
  hessian->topLeftCorner(15 * count, 15 * count)
      .selfadjointView<Eigen::Lower>()
      .rankUpdate(jacobian.transpose());
}

/// Rows of a frame's rest measurement over its 15 canonical coordinates; zero when it has none.
struct RestRows {
  explicit RestRows(const WindowFrame& frame) {
    if (frame.rest) {
      frame.rest->Evaluate(frame.nav_state(), frame.imu_bias(), &residual, &jacobian);
    }
  }
  RestModel::Jacobian jacobian = RestModel::Jacobian::Zero();
  Vector6d residual = Vector6d::Zero();
};

}  // namespace

ImuRows LinearizeImu(const WindowFrame& first, const WindowFrame& second, const Eigen::Vector3d& gravity_W) {
  const ImuFactor factor(&*second.preintegration, gravity_W, second.mean_step_s());
  Eigen::Matrix<double, 15, 9, Eigen::RowMajor> nav_first, nav_second;
  Eigen::Matrix<double, 15, 6, Eigen::RowMajor> bias_first, bias_second;
  const std::array<const double*, 4> parameters = {first.nav.data(), first.bias.data(), second.nav.data(),
                                                   second.bias.data()};
  const std::array<double*, 4> jacobians = {nav_first.data(), bias_first.data(), nav_second.data(),
                                            bias_second.data()};
  ImuRows rows;
  factor.Evaluate(parameters.data(), rows.residual.data(), jacobians.data());
  rows.first << nav_first, bias_first;
  rows.second << nav_second, bias_second;
  return rows;
}

bool NewestCovariance(const Window& window, const LinearPrior& prior, const PoseSystem& vision,
                      const Eigen::Vector3d& gravity_W, Matrix15d* covariance) {
  const Index size = window.size();
  MatrixXd hessian = MatrixXd::Zero(15 * size, 15 * size);
  AddPriorHessian(prior, &hessian);
  for (int i = 0; i + 1 < window.size(); ++i) {
    const ImuRows imu = LinearizeImu(window.frame(i), window.frame(i + 1), gravity_W);
    hessian.block<15, 15>(15 * i, 15 * i).noalias() += imu.first.transpose() * imu.first;
    hessian.block<15, 15>(15 * i + 15, 15 * i).noalias() += imu.second.transpose() * imu.first;
    hessian.block<15, 15>(15 * i + 15, 15 * i + 15).noalias() += imu.second.transpose() * imu.second;
  }
  for (Index i = 0; i < size; ++i) {
    const RestRows rest(window.frame(static_cast<int>(i)));
    hessian.block<15, 15>(15 * i, 15 * i).noalias() += rest.jacobian.transpose() * rest.jacobian;
    for (Index j = 0; j <= i; ++j) {
      hessian.block<6, 6>(15 * i, 15 * j) += vision.hessian.block<6, 6>(6 * i, 6 * j);
    }
  }
  const Eigen::LLT<Eigen::Ref<MatrixXd>> factor(hessian);
  if (factor.info() != Eigen::Success) {
    return false;
  }
  // The newest frame comes last, so its own corner of the factor holds its marginal information.
  const Matrix15d corner = hessian.bottomRightCorner<15, 15>().triangularView<Eigen::Lower>();
  const Matrix15d inverse = corner.triangularView<Eigen::Lower>().solve(Matrix15d::Identity());
  *covariance = inverse.transpose() * inverse;
  return covariance->allFinite();
}

LinearPrior MarginalizeOldest(const Window& window, const LinearPrior& prior, const PoseSystem& vision,
                              const Eigen::Vector3d& gravity_W) {
  // Columns: the oldest frame (15), the next (15), poses of the others (6 each), the residual.
  const int frames = window.size();
  const auto column = [](int frame) { return frame == 0 ? 0 : frame == 1 ? 15 : 30 + 6 * (frame - 2); };
  const Index columns = column(frames);
  const Index prior_rows = prior.jacobian.rows();
  const Index vision_rows = vision.hessian.rows();
  MatrixXd stack =
      MatrixXd::Zero(std::max(prior_rows + 15 + vision_rows + RestModel::kRows, columns + 1), columns + 1);
  VectorXd prior_residual = prior.residual;
  for (size_t i = 0; i < prior.anchors.size(); ++i) {
    const LinearPrior::Anchor& anchor = prior.anchors[i];
    const Index width = i == 0 ? 15 : 6;
    const Index from = LinearPrior::Column(static_cast<int>(i));
    Vector15d xi;
    xi.head<9>() = Local(prior.convention, anchor.origin, anchor.frame->nav_state());
    const ImuBias bias = anchor.frame->imu_bias();
    xi.tail<6>() << bias.gyro - anchor.bias_origin.gyro, bias.accel - anchor.bias_origin.accel;
    stack.block(0, column(anchor.frame->index), prior_rows, width) = prior.jacobian.middleCols(from, width);
    prior_residual.noalias() += prior.jacobian.middleCols(from, width) * xi.head(width);
  }
  stack.col(columns).head(prior_rows) = prior_residual;

  const ErrorConvention convention = prior.convention;
  const ImuRows imu = LinearizeImu(window.frame(0), window.frame(1), gravity_W);
  stack.block<15, 15>(prior_rows, 0) = imu.first * ImuChartJacobian(convention, window.frame(0).nav_state());
  stack.block<15, 15>(prior_rows, 15) =
      imu.second * ImuChartJacobian(convention, window.frame(1).nav_state());
  stack.col(columns).segment<15>(prior_rows) = imu.residual;

  MatrixXd vision_jacobian;
  VectorXd vision_residual;
  SquareRootRows(vision.hessian, vision.gradient, &vision_jacobian, &vision_residual);
  for (int i = 0; i < frames; ++i) {
    stack.block(prior_rows + 15, column(i), vision_rows, 6).noalias() =
        vision_jacobian.middleCols<6>(6 * i) * ChartJacobian(convention, window.frame(i).nav_state().T_WB());
  }
  stack.col(columns).segment(prior_rows + 15, vision_rows) = vision_residual;

  const RestRows rest(window.frame(0));
  stack.block<RestModel::kRows, 15>(prior_rows + 15 + vision_rows, 0) =
      rest.jacobian * ImuChartJacobian(convention, window.frame(0).nav_state());
  stack.col(columns).segment<RestModel::kRows>(prior_rows + 15 + vision_rows) = rest.residual;

  const Eigen::HouseholderQR<Eigen::Ref<MatrixXd>> qr(stack);
  LinearPrior next;
  next.convention = convention;
  const Index kept = columns - 15;
  next.jacobian = stack.block(15, 15, kept, kept).triangularView<Eigen::Upper>();
  next.residual = stack.col(columns).segment(15, kept);
  for (int i = 1; i < frames; ++i) {
    const WindowFrame& frame = window.frame(i);
    next.anchors.push_back({&frame, frame.nav_state(), frame.imu_bias()});
  }
  return next;
}

}  // namespace alidade
