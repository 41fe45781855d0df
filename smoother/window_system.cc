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

/// The rows of a frame's epochs, at the present states, kernels included.
FrameEpochRows EpochRows(const GnssFactorContext& gnss, const WindowFrame& frame) {
  FrameEpochRows all;
  GnssResiduals ignored;
  for (const FrameEpoch& epoch : frame.epochs) {
    const FrameEpochRows rows =
        LinearizeFrameEpoch(gnss, epoch, epoch.SecondsAfter(frame.stamp_ns), frame.nav_state(),
                            frame.imu_bias(), frame.clock_state(), true, &ignored);
    const Index before = all.residual.size();
    const Index count = rows.residual.size();
    all.frame.conservativeResize(before + count, Eigen::NoChange);
    all.clock.conservativeResize(before + count, Eigen::NoChange);
    all.residual.conservativeResize(before + count);
    all.frame.bottomRows(count) = rows.frame;
    all.clock.bottomRows(count) = rows.clock;
    all.residual.tail(count) = rows.residual;
  }
  return all;
}

ClockStep StepTo(const GnssFactorContext& gnss, const WindowFrame& from, const WindowFrame& to) {
  return {gnss.config, SecondsBetween(from.stamp_ns, to.stamp_ns), to.clock_anew};
}

/// The Hessian over [clocks | frames] from that over the frames (lower triangles): what the prior says about
/// the first clock, the epochs and the clocks' process are added.
MatrixXd WithClocks(const Window& window, const LinearPrior& prior, const GnssFactorContext& gnss,
                    const MatrixXd& frames) {
  const Index size = window.size();
  MatrixXd hessian = MatrixXd::Zero(21 * size, 21 * size);
  const Index offset = 6 * size;
  hessian.bottomRightCorner(15 * size, 15 * size) = frames;
  const MatrixXd clock = prior.jacobian.middleCols<6>(prior.ClockColumn());
  hessian.topLeftCorner<6, 6>() += clock.transpose() * clock;
  for (Index i = 0; i < static_cast<Index>(prior.anchors.size()); ++i) {
    const LinearPrior::Anchor& anchor = prior.anchors[static_cast<size_t>(i)];
    const NavState state = anchor.frame->nav_state();
    const Matrix9d chain =
        LocalJacobian(prior.convention, anchor.origin, state) * InverseChartJacobian(prior.convention, state);
    const int width = i == 0 ? 9 : 6;
    const MatrixXd pose =
        prior.jacobian.middleCols(LinearPrior::Column(static_cast<int>(i)), width) * chain.topRows(width);
    hessian.block<9, 6>(offset + 15 * i, 0) += pose.transpose() * clock;
  }
  hessian.block<6, 6>(offset + 9, 0) += prior.jacobian.middleCols<6>(9).transpose() * clock;
  for (Index i = 0; i < size; ++i) {
    const WindowFrame& frame = window.frame(static_cast<int>(i));
    const FrameEpochRows rows = EpochRows(gnss, frame);
    hessian.block<6, 6>(6 * i, 6 * i).noalias() += rows.clock.transpose() * rows.clock;
    hessian.block<15, 6>(offset + 15 * i, 6 * i).noalias() += rows.frame.transpose() * rows.clock;
    hessian.block<15, 15>(offset + 15 * i, offset + 15 * i).noalias() += rows.frame.transpose() * rows.frame;
    if (i + 1 < size) {
      const ClockStep step = StepTo(gnss, frame, window.frame(static_cast<int>(i) + 1));
      const Matrix6d information = step.root.transpose() * step.root;
      hessian.block<6, 6>(6 * i, 6 * i) += step.phi.transpose() * information * step.phi;
      hessian.block<6, 6>(6 * i + 6, 6 * i) -= information * step.phi;
      hessian.block<6, 6>(6 * i + 6, 6 * i + 6) += information;
    }
  }
  return hessian;
}

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
                      const Eigen::Vector3d& gravity_W, Matrix15d* covariance, const GnssFactorContext* gnss,
                      Matrix6d* clock_covariance) {
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
  if (gnss != nullptr) {
    hessian = WithClocks(window, prior, *gnss, hessian);
  }
  const Eigen::LLT<Eigen::Ref<MatrixXd>> factor(hessian);
  if (factor.info() != Eigen::Success) {
    return false;
  }
  // The newest frame comes last, so its own corner of the factor holds its marginal information.
  const Matrix15d corner = hessian.bottomRightCorner<15, 15>().triangularView<Eigen::Lower>();
  const Matrix15d inverse = corner.triangularView<Eigen::Lower>().solve(Matrix15d::Identity());
  *covariance = inverse.transpose() * inverse;
  if (gnss != nullptr && clock_covariance != nullptr) {
    const Index newest = 6 * (size - 1);
    MatrixXd unit = MatrixXd::Zero(hessian.rows(), 6);
    unit.middleRows<6>(newest).setIdentity();
    *clock_covariance = MatrixXd(factor.solve(unit)).middleRows<6>(newest);
  }
  return covariance->allFinite();
}

LinearPrior MarginalizeOldest(const Window& window, const LinearPrior& prior, const PoseSystem& vision,
                              const Eigen::Vector3d& gravity_W, const GnssFactorContext* gnss) {
  // Columns: the oldest frame (15), with GNSS its clock (6), the next frame (15), poses of the others (6
  // each), with GNSS the next clock (6), the residual.
  const int frames = window.size();
  const int clock = gnss != nullptr ? 6 : 0;
  const auto column = [clock](int frame) {
    return frame == 0 ? 0 : clock + (frame == 1 ? 15 : 30 + 6 * (frame - 2));
  };
  const int next_clock = column(frames);
  const Index columns = next_clock + clock;
  const int leaving = 15 + clock;
  const FrameEpochRows epochs = gnss != nullptr ? EpochRows(*gnss, window.frame(0)) : FrameEpochRows();
  const Index gnss_rows = epochs.residual.size() + clock;
  const Index prior_rows = prior.jacobian.rows();
  const Index vision_rows = vision.hessian.rows();
  MatrixXd stack = MatrixXd::Zero(
      std::max(prior_rows + 15 + vision_rows + RestModel::kRows + gnss_rows, columns + 1), columns + 1);
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
  if (gnss != nullptr) {
    const MatrixXd jacobian = prior.jacobian.middleCols<6>(prior.ClockColumn());
    stack.block(0, 15, prior_rows, 6) = jacobian;
    prior_residual.noalias() += jacobian * (window.frame(0).clock_state() - *prior.clock_origin);
  }
  stack.col(columns).head(prior_rows) = prior_residual;

  const ErrorConvention convention = prior.convention;
  const ImuRows imu = LinearizeImu(window.frame(0), window.frame(1), gravity_W);
  stack.block<15, 15>(prior_rows, 0) = imu.first * ImuChartJacobian(convention, window.frame(0).nav_state());
  stack.block<15, 15>(prior_rows, leaving) =
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

  if (gnss != nullptr) {
    const WindowFrame& oldest = window.frame(0);
    const Index first = prior_rows + 15 + vision_rows + RestModel::kRows;
    const Index count = epochs.residual.size();
    stack.block(first, 0, count, 15) = epochs.frame * ImuChartJacobian(convention, oldest.nav_state());
    stack.block(first, 15, count, 6) = epochs.clock;
    stack.col(columns).segment(first, count) = epochs.residual;
    const ClockStep step = StepTo(*gnss, oldest, window.frame(1));
    stack.block<6, 6>(first + count, 15) = -step.root * step.phi;
    stack.block<6, 6>(first + count, next_clock) = step.root;
    stack.col(columns).segment<6>(first + count) =
        step.root * (window.frame(1).clock_state() - step.phi * oldest.clock_state());
  }

  const Eigen::HouseholderQR<Eigen::Ref<MatrixXd>> qr(stack);
  LinearPrior next;
  next.convention = convention;
  const Index kept = columns - leaving;
  next.jacobian = stack.block(leaving, leaving, kept, kept).triangularView<Eigen::Upper>();
  next.residual = stack.col(columns).segment(leaving, kept);
  if (gnss != nullptr) {
    next.clock_origin = window.frame(1).clock_state();
  }
  for (int i = 1; i < frames; ++i) {
    const WindowFrame& frame = window.frame(i);
    next.anchors.push_back({&frame, frame.nav_state(), frame.imu_bias()});
  }
  return next;
}

}  // namespace alidade
