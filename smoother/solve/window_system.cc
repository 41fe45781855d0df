#include "smoother/solve/window_system.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <array>

#include "smoother/solve/frame_rows.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// J of the prior over 15 canonical coordinates of each anchor's frame, at the present states.
MatrixXd PriorJacobian(const LinearPrior& prior) {
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
  return jacobian;
}

void AddPriorHessian(const LinearPrior& prior, MatrixXd* hessian) {
  const MatrixXd jacobian = PriorJacobian(prior);
  // Anchors are the window's first frames, in order: their columns are the leading ones.
  hessian->topLeftCorner(jacobian.cols(), jacobian.cols())
      .selfadjointView<Eigen::Lower>()
      .rankUpdate(jacobian.transpose());
}

/// What the prior says of the first clock: information, and its coupling to 15 coordinates of each frame.
struct PriorClock {
  Matrix6d information;
  MatrixXd coupling;  ///< 15F x 6
};

PriorClock ClockOf(const LinearPrior& prior, Index frames) {
  const MatrixXd clock = prior.jacobian.middleCols<6>(prior.ClockColumn());
  PriorClock said{clock.transpose() * clock, MatrixXd::Zero(15 * frames, 6)};
  for (Index i = 0; i < static_cast<Index>(prior.anchors.size()); ++i) {
    const LinearPrior::Anchor& anchor = prior.anchors[static_cast<size_t>(i)];
    const NavState state = anchor.frame->nav_state();
    const Matrix9d chain =
        LocalJacobian(prior.convention, anchor.origin, state) * InverseChartJacobian(prior.convention, state);
    const int width = i == 0 ? 9 : 6;
    const MatrixXd pose =
        prior.jacobian.middleCols(LinearPrior::Column(static_cast<int>(i)), width) * chain.topRows(width);
    said.coupling.middleRows<9>(15 * i).noalias() = pose.transpose() * clock;
  }
  said.coupling.middleRows<6>(9).noalias() = prior.jacobian.middleCols<6>(9).transpose() * clock;
  return said;
}

/// The same of a prior with SLAM features, and its Hessian over the frames.
PriorClock ClockOf(const SlamPrior::Reduced& reduced, Index frames) {
  const Index clock = SlamPrior::Column(static_cast<int>(frames));
  PriorClock said{reduced.hessian.block<6, 6>(clock, clock).selfadjointView<Eigen::Lower>(),
                  MatrixXd::Zero(15 * frames, 6)};
  const auto rows = reduced.hessian.middleRows<6>(clock);
  said.coupling.topRows<15>() = rows.leftCols<15>().transpose();
  for (Index i = 1; i < frames; ++i) {
    said.coupling.middleRows<6>(15 * i) =
        rows.middleCols<6>(SlamPrior::Column(static_cast<int>(i))).transpose();
  }
  return said;
}

void AddPriorHessian(const SlamPrior::Reduced& reduced, Index frames, MatrixXd* hessian) {
  const auto width = [](Index frame) { return frame == 0 ? Index{15} : Index{6}; };
  for (Index i = 0; i < frames; ++i) {
    for (Index j = 0; j <= i; ++j) {
      hessian->block(15 * i, 15 * j, width(i), width(j)) += reduced.hessian.block(
          SlamPrior::Column(static_cast<int>(i)), SlamPrior::Column(static_cast<int>(j)), width(i), width(j));
    }
  }
}

/// The Hessian over [clocks | frames] from that over the frames (lower triangles): what the prior says about
/// the first clock, the epochs and the clocks' process are added.
MatrixXd WithClocks(const Window& window, const PriorClock& prior, const GnssFactorContext& gnss,
                    const MatrixXd& frames) {
  const Index size = window.size();
  MatrixXd hessian = MatrixXd::Zero(21 * size, 21 * size);
  const Index offset = 6 * size;
  hessian.bottomRightCorner(15 * size, 15 * size) = frames;
  hessian.topLeftCorner<6, 6>() += prior.information;
  hessian.block(offset, 0, 15 * size, 6) += prior.coupling;
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

/// What the prior says of the calibration: information, and its coupling to [first clock | frames].
struct PriorCalibration {
  MatrixXd information;
  MatrixXd clock;   ///< 6 x k, in an aligned window
  MatrixXd frames;  ///< 15F x k
};

PriorCalibration CalibrationOf(const LinearPrior& prior, const CameraCalibration& camera, Index frames) {
  const Index size = prior.calibration_size();
  const WindowCalibration& origin = *prior.calibration_origin;
  const MatrixXd chained = prior.jacobian.middleCols(prior.CalibrationColumn(), size) *
                           LocalJacobian(origin.layout, origin.mean, camera);
  PriorCalibration said{chained.transpose() * chained, {}, MatrixXd::Zero(15 * frames, size)};
  const MatrixXd anchors = PriorJacobian(prior);
  said.frames.topRows(anchors.cols()) = anchors.transpose() * chained;
  if (prior.clock_origin) {
    said.clock = prior.jacobian.middleCols<6>(prior.ClockColumn()).transpose() * chained;
  }
  return said;
}

/// The same of a prior with SLAM features, whose views know the calibration too.
PriorCalibration CalibrationOf(const SlamPrior::Reduced& reduced, const LinearPrior& prior, Index frames) {
  const Index size = prior.calibration_size();
  const auto rows = reduced.hessian.bottomRows(size);
  PriorCalibration said{
      rows.rightCols(size).selfadjointView<Eigen::Lower>(), {}, MatrixXd::Zero(15 * frames, size)};
  said.frames.topRows<15>() = rows.leftCols<15>().transpose();
  for (Index i = 1; i < frames; ++i) {
    said.frames.middleRows<6>(15 * i) =
        rows.middleCols<6>(SlamPrior::Column(static_cast<int>(i))).transpose();
  }
  if (prior.clock_origin) {
    said.clock = rows.middleCols<6>(SlamPrior::Column(static_cast<int>(frames))).transpose();
  }
  return said;
}

/// The Hessian over [calibration | what `rest` is over] (lower triangles), `rest` being over [clocks |
/// frames].
MatrixXd WithCalibration(Index frames, const PriorCalibration& prior, const PoseSystem& vision,
                         const MatrixXd& rest) {
  const Index size = vision.calibration_size();
  const Index first = size + rest.rows() - 15 * frames;  // of the frames
  MatrixXd hessian = MatrixXd::Zero(size + rest.rows(), size + rest.rows());
  hessian.bottomRightCorner(rest.rows(), rest.rows()) = rest;
  hessian.topLeftCorner(size, size) = prior.information + vision.hessian.bottomRightCorner(size, size);
  hessian.block(first, 0, 15 * frames, size) = prior.frames;
  hessian.block(size, 0, prior.clock.rows(), size) += prior.clock;
  for (Index i = 0; i < frames; ++i) {
    hessian.block(first + 15 * i, 0, 6, size) += vision.hessian.block(6 * frames, 6 * i, size, 6).transpose();
  }
  return hessian;
}

}  // namespace

bool NewestCovariance(const Window& window, const LinearPrior& prior, const PoseSystem& vision,
                      const Eigen::Vector3d& gravity_W, Matrix15d* covariance, const GnssFactorContext* gnss,
                      Matrix6d* clock_covariance, const SlamPrior::Reduced* slam,
                      VectorXd* calibration_deviations) {
  const Index size = window.size();
  MatrixXd hessian = MatrixXd::Zero(15 * size, 15 * size);
  if (slam != nullptr) {
    AddPriorHessian(*slam, size, &hessian);
  } else {
    AddPriorHessian(prior, &hessian);
  }
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
    hessian =
        WithClocks(window, slam != nullptr ? ClockOf(*slam, size) : ClockOf(prior, size), *gnss, hessian);
  }
  const Index calibration = prior.calibration_size();
  if (calibration > 0) {
    hessian = WithCalibration(size,
                              slam != nullptr ? CalibrationOf(*slam, prior, size)
                                              : CalibrationOf(prior, vision.calibration->mean, size),
                              vision, hessian);
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
    const Index newest = calibration + 6 * (size - 1);
    MatrixXd unit = MatrixXd::Zero(hessian.rows(), 6);
    unit.middleRows<6>(newest).setIdentity();
    *clock_covariance = MatrixXd(factor.solve(unit)).middleRows<6>(newest);
  }
  if (calibration_deviations != nullptr) {
    const MatrixXd unit = MatrixXd::Identity(hessian.rows(), calibration);
    *calibration_deviations = MatrixXd(factor.solve(unit)).diagonal().cwiseSqrt();
  }
  return covariance->allFinite();
}

}  // namespace alidade
