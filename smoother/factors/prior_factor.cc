#include "smoother/factors/prior_factor.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/lie.h"
#include "smoother/factors/imu_factor.h"
#include "smoother/factors/spread.h"

namespace alidade {
namespace {

template <int kColumns>
using RowMap = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, kColumns, Eigen::RowMajor>>;

}  // namespace

ColumnMap PriorColumns(int frames, bool clock, int calibration, size_t landmarks) {
  ColumnMap columns;
  for (int i = 0; i < frames; ++i) {
    i == 0 ? columns.AddState(i) : columns.AddPose(i);
  }
  if (clock) {
    columns.AddClock(0);
  }
  columns.AddCalibration(calibration);
  for (size_t i = 0; i < landmarks; ++i) {
    columns.AddLandmark(static_cast<int>(i));
  }
  return columns;
}

ColumnMap LinearPrior::columns() const {
  return PriorColumns(static_cast<int>(anchors.size()), clock_origin.has_value(), calibration_origin.size(),
                      landmarks.size());
}

Vector9d LinearPrior::NavError(size_t anchor, const NavState& state) const {
  return chart.Local(anchors[anchor].origin, state);
}

Vector6d LinearPrior::BiasError(const ImuBias& bias) const {
  const ImuBias& origin = anchors.front().bias_origin;
  Vector6d error;
  error << bias.gyro - origin.gyro, bias.accel - origin.accel;
  return error;
}

Vector6d LinearPrior::ClockError(const Vector6d& clock) const {
  return clock - *clock_origin;
}

Eigen::VectorXd LinearPrior::CalibrationError(const CameraCalibration& camera) const {
  return Local(calibration_origin.layout, calibration_origin.mean, camera);
}

LinearPrior::SpreadChange LinearPrior::SpreadAt(std::span<const NavState> states) const {
  SpreadChange change;
  if (!(spread > 0)) {
    change.slope.setZero(6, static_cast<Eigen::Index>(anchors.size()));
    return change;
  }
  const Eigen::Vector3d& camera_B = calibration_origin.mean.T_BC.translation;
  std::vector<NavState> now, points;
  for (const Anchor& anchor : anchors) {
    now.push_back(states[static_cast<size_t>(anchor.frame->index)]);
    points.push_back(anchor.frame->first ? anchor.frame->first->Point(now.back()) : now.back());
  }
  change.ratio = SpreadOf(now, camera_B).metres / spread;
  change.slope = SpreadOf(points, camera_B).slope;
  for (size_t i = 0; i < anchors.size(); ++i) {
    if (anchors[i].frame->first) {
      const Matrix6d chain = anchors[i].frame->first->Chain(now[i]).topLeftCorner<6, 6>();
      change.slope.col(static_cast<Eigen::Index>(i)).applyOnTheLeft(chain.transpose());
    }
  }
  return change;
}

LinearPrior::FrameErrors LinearPrior::ErrorsAt(std::span<const NavState> states, const SpreadChange& change,
                                               Derivative derivative) const {
  const auto state_of = [&](const Anchor& anchor) -> const NavState& {
    return states[static_cast<size_t>(anchor.frame->index)];
  };
  FrameErrors errors;
  // First estimates hold positions where they are, whatever the scale.
  const bool separate = spread > 0 && !anchors.front().frame->first;
  errors.ratio = separate ? change.ratio : 1;
  const Eigen::Vector3d& camera_B = calibration_origin.mean.T_BC.translation;
  const NavState& first = state_of(anchors.front());
  errors.on_first << first.R_WB * Skew(-camera_B), Eigen::Matrix3d::Identity();
  errors.on_first *= errors.ratio - 1;
  const auto along_scale = [&](const NavState& state, const NavState& from) {
    Vector9d zeta;
    zeta << Eigen::Vector3d::Zero(), state.T_WB() * camera_B - from.T_WB() * camera_B, state.v_WB;
    return zeta;
  };
  for (size_t i = 0; i < anchors.size(); ++i) {
    const NavState& origin = anchors[i].origin;
    NavState state = state_of(anchors[i]);
    const Vector9d scale = along_scale(state, first) / errors.ratio;
    state.p_WB -= (errors.ratio - 1) * scale.segment<3>(3);
    state.v_WB /= errors.ratio;
    Matrix9d chain = chart.InverseJacobian(state);
    if (derivative == Derivative::kHere) {
      chain = (chart.LocalJacobian(origin, state) * chain).eval();
    }
    errors.xi.push_back(NavError(i, state));
    errors.along.emplace_back(Vector9d::Zero());
    if (separate) {
      const Vector9d along = chart.InverseJacobian(origin) * along_scale(origin, anchors.front().origin);
      errors.xi.back() += std::log(errors.ratio) * along;
      errors.along.back() = along - chain * scale;
    }
    chain.rightCols<6>() /= errors.ratio;
    chain.leftCols<3>() += (errors.ratio - 1) * chain.middleCols<3>(3) * state.R_WB * Skew(camera_B);
    errors.chain.push_back(chain);
  }
  return errors;
}

bool MakeInitialPrior(ErrorConvention convention, const WindowFrame& frame, const Matrix15d& covariance,
                      LinearPrior* prior) {
  const NavState state = frame.nav_state();
  prior->chart = {convention, state.p_WB};
  const Matrix15d to_xi = InverseImuChartJacobian(convention, prior->chart.FromCentre(state));
  Matrix15d covariance_xi = to_xi * covariance * to_xi.transpose();
  // A direction given as exactly known gets a deviation far below every unit's use, so that the prior exists.
  covariance_xi.diagonal().array() += 1e-18;
  const Eigen::LLT<Matrix15d> factor(covariance_xi);
  if (factor.info() != Eigen::Success) {
    return false;
  }
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
    : prior_(prior), calibration_(calibration), columns_(prior->columns()) {
  CHECK(prior->landmarks.empty() && !(prior->spread > 0)) << "a prior for SlamPriorCost";
  blocks_ = {BlockKind::kNavState, BlockKind::kBias};
  blocks_.resize(prior->anchors.size() + 1, BlockKind::kNavState);
  if (prior->clock_origin) {
    blocks_.push_back(BlockKind::kClock);
  }
  blocks_.push_back(BlockKind::kCalibration);
}

void PriorFactor::AddFrame(size_t anchor, const double* block, double* residual, double* tangent) const {
  const LinearPrior::Anchor& at = prior_->anchors[anchor];
  const ColumnMap::Range columns = columns_.Frame(static_cast<int>(anchor));
  const Eigen::Index width = std::min(columns.size, kNavColumns);
  const auto jacobian = prior_->jacobian.middleCols(columns.first, width);
  const NavState state = UnpackNavState(block);
  const Vector9d xi = prior_->NavError(anchor, state);
  Eigen::Map<Eigen::VectorXd>(residual, rows()).noalias() += jacobian * xi.head(width);
  if (tangent != nullptr) {
    const Matrix9d chain =
        prior_->chart.LocalJacobian(at.origin, state) * prior_->chart.InverseJacobian(state);
    RowMap<9>(tangent, rows(), 9).noalias() = jacobian * chain.topRows(width);
  }
}

void PriorFactor::AddBias(const double* block, double* residual, double* tangent) const {
  const Vector6d shift = prior_->BiasError(UnpackBias(block));
  const auto jacobian = prior_->jacobian.middleCols<6>(columns_.Frame(0).first + kNavColumns);
  Eigen::Map<Eigen::VectorXd>(residual, rows()).noalias() += jacobian * shift;
  if (tangent != nullptr) {
    RowMap<6>(tangent, rows(), 6) = jacobian;
  }
}

void PriorFactor::AddClock(const double* block, double* residual, double* tangent) const {
  const Eigen::Map<const Vector6d> clock(block);
  const auto jacobian = prior_->jacobian.middleCols<6>(columns_.Clock(0).first);
  Eigen::Map<Eigen::VectorXd>(residual, rows()).noalias() += jacobian * prior_->ClockError(clock);
  if (tangent != nullptr) {
    RowMap<6>(tangent, rows(), 6) = jacobian;
  }
}

bool PriorFactor::AddCalibration(const double* block, double* residual, double* tangent) const {
  constexpr int kWidth = CalibrationLayout::kMaxSize;
  const WindowCalibration& origin = prior_->calibration_origin;
  CameraCalibration camera;
  if (!calibration_->At(block, &camera)) {
    return false;
  }
  const auto jacobian = prior_->jacobian.middleCols(columns_.Calibration().first, origin.size());
  Eigen::Map<Eigen::VectorXd>(residual, rows()).noalias() += jacobian * prior_->CalibrationError(camera);
  if (tangent != nullptr) {
    RowMap<kWidth> out(tangent, rows(), kWidth);
    out.setZero();
    out.leftCols(origin.size()).noalias() =
        jacobian * LocalJacobian(origin.layout, origin.mean, camera) * calibration_->BlockJacobian(block);
  }
  return true;
}

bool PriorFactor::Evaluate(const double* const* parameters, double* residual,
                           double* const* tangent_jacobians) const {
  const auto tangent = [&](size_t block) {
    return tangent_jacobians == nullptr ? nullptr : tangent_jacobians[block];
  };
  const size_t anchors = prior_->anchors.size();
  Eigen::Map<Eigen::VectorXd>(residual, rows()) = prior_->residual;
  for (size_t i = 0; i < anchors; ++i) {
    const size_t block = i == 0 ? 0 : i + 1;
    AddFrame(i, parameters[block], residual, tangent(block));
  }
  AddBias(parameters[1], residual, tangent(1));
  for (size_t block = anchors + 1; block < blocks_.size(); ++block) {
    if (blocks_[block] == BlockKind::kClock) {
      AddClock(parameters[block], residual, tangent(block));
    } else if (!AddCalibration(parameters[block], residual, tangent(block))) {
      return false;
    }
  }
  return true;
}

}  // namespace alidade
