#include "filter/track_memory.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/check.h"
#include "core/dense_solvers.h"
#include "core/landmark_reduction.h"
#include "filter/landmark_view.h"

namespace alidade {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

namespace {

// A carried memory loses a little with every clone; it need not restart for that.
constexpr double kStayFactor = 1.5;
// Of the depth's deviation, what the state's may be: it is common to all tracks and biases the scale, where a
// track's own averages out.
constexpr double kStateShare = 0.5;

}  // namespace

void TrackMemory::AddInnovation(double nis) {
  ++further_views;
  const double size = residual.norm();
  if (size > 0) {
    innovations += std::sqrt(nis) / size * residual;
  }
}

TrackMemoryKeeper::TrackMemoryKeeper(const FilterConfig& filter, int max_clones, int calibration_size)
    : error_(filter.error),
      max_depth_deviation_(filter.memory_depth_deviation),
      calibration_(calibration_size),
      columns_(6 * max_clones + calibration_size),
      stacked_(5, columns_),
      jacobian_(2, columns_) {}

double TrackMemoryKeeper::StateDepthDeviation(const FilterState& state, const Vector3d& ray,
                                              const Matrix3d& landmark_rows,
                                              const Eigen::Ref<const MatrixXd>& clone_rows,
                                              const std::vector<int>& clones) {
  const Vector3d direction = ray.normalized();
  const Vector3d along = landmark_rows.triangularView<Eigen::Upper>().transpose().solve(direction);
  // direction . (f~ - p~_newest), with f~ = R^-1 (t - T x - n) and t = 0, less the part of n.
  if (depth_row_.size() < state.covariance().capacity()) {
    depth_row_.resize(state.covariance().capacity());
    whitened_depth_row_.resize(state.covariance().capacity());
  }
  auto row = depth_row_.head(state.covariance().dimension());
  row.setZero();
  for (size_t k = 0; k < clones.size(); ++k) {
    row.segment<6>(state.CloneOffset(static_cast<size_t>(clones[k]))) -=
        clone_rows.middleCols<6>(6 * static_cast<Index>(k)).transpose() * along;
  }
  row.segment(state.CalibrationOffset(), calibration_).noalias() -=
      clone_rows.middleCols(6 * static_cast<Index>(clones.size()), calibration_).transpose() * along;
  const auto newest = static_cast<size_t>(clones.back());
  row.segment<6>(state.CloneOffset(newest)) -=
      state.clones()[newest].camera_from_error.bottomRows<3>().transpose() * direction;
  auto whitened = whitened_depth_row_.head(row.size());
  whitened.noalias() = state.covariance().factor().transpose() * row;
  return whitened.norm();
}

bool TrackMemoryKeeper::StateAllows(const FilterState& state, const Vector3d& p_W,
                                    const Matrix3d& landmark_rows,
                                    const Eigen::Ref<const MatrixXd>& clone_rows,
                                    const std::vector<int>& clones) {
  const Vector3d ray = p_W - state.clones()[static_cast<size_t>(clones.back())].T_WC.translation;
  return StateDepthDeviation(state, ray, landmark_rows, clone_rows, clones) <
         kStateShare * max_depth_deviation_ * ray.norm();
}

void TrackMemoryKeeper::Start(const FilterState& state, const Vector3d& p_W, const Matrix3d& landmark_rows,
                              const Eigen::Ref<const MatrixXd>& clone_rows, const std::vector<int>& clones,
                              TrackMemory* memory) {
  memory->active = StateAllows(state, p_W, landmark_rows, clone_rows, clones);
  if (!memory->active) {
    return;
  }
  memory->carried = false;
  memory->refusals = 0;
  memory->innovations.setZero();
  memory->further_views = 0;
  memory->p_W = p_W;
  memory->landmark_rows = landmark_rows.triangularView<Eigen::Upper>();
  memory->clone_rows.setZero(3, columns_);
  for (size_t k = 0; k < clones.size(); ++k) {
    const Clone& clone = state.clones()[static_cast<size_t>(clones[k])];
    memory->clone_rows.middleCols<6>(6 * clone.slot) = clone_rows.block<3, 6>(0, 6 * static_cast<Index>(k));
  }
  memory->clone_rows.rightCols(calibration_) =
      clone_rows.middleCols(6 * static_cast<Index>(clones.size()), calibration_);
  if (error_.anchored()) {
    const Clone& anchor = state.clones()[static_cast<size_t>(clones.back())];
    memory->anchor = anchor.serial;
    memory->clone_rows.middleCols<3>(6 * anchor.slot) +=
        LandmarkError::OverAnchor(memory->landmark_rows, p_W);
  }
}

bool TrackMemoryKeeper::Extend(const FilterState& state, const TrackMemory& memory, size_t clone_index,
                               const NormalizedObservation& observation, double weight,
                               TrackMemory* extended) {
  const Clone& clone = state.clones()[clone_index];
  NormalizedObservation weighted = observation;
  weighted.sqrt_information *= weight;
  LandmarkViewRows view;
  if (!LinearizeView(state, clone, weighted, memory.p_W, memory.p_W, &view)) {
    return false;
  }
  Eigen::Matrix<double, 5, 3> landmark;
  landmark << memory.landmark_rows, view.landmark;
  stacked_.topRows<3>() = memory.clone_rows;
  stacked_.bottomRows<2>().setZero();
  stacked_.block<2, 6>(3, 6 * clone.slot) = view.clone;
  stacked_.bottomRightCorner(2, calibration_) = view.calibration;
  if (error_.anchored()) {
    const int anchor = state.FindClone(memory.anchor);
    CHECK_GE(anchor, 0) << "a memory's anchor left the window";
    stacked_.block<2, 3>(3, 6 * state.clones()[static_cast<size_t>(anchor)].slot) +=
        LandmarkError::OverAnchor(view.landmark, memory.p_W);
  }
  // The reflections once, as a small matrix: the rows are few and long.
  Eigen::Matrix<double, 5, 5> rotation = Eigen::Matrix<double, 5, 5>::Identity();
  Eigen::Matrix<double, 5, 1> innovation;
  innovation << Vector3d::Zero(), -view.residual;
  EliminateLandmark(landmark, rotation, innovation);
  extended->active = true;
  extended->carried = memory.carried;
  extended->refusals = 0;
  extended->residual = view.residual;
  extended->innovations = memory.innovations;
  extended->further_views = memory.further_views;
  extended->anchor = memory.anchor;
  extended->landmark_rows = landmark.topRows<3>().triangularView<Eigen::Upper>();
  extended->clone_rows.noalias() = rotation.topRows<3>().lazyProduct(stacked_);
  jacobian_.noalias() = rotation.bottomRows<2>().lazyProduct(stacked_);
  innovation_ = innovation.tail<2>();
  // The rows' own innovation moves the landmark at once: t is zero in a memory.
  extended->p_W =
      memory.p_W + extended->landmark_rows.triangularView<Eigen::Upper>().solve(innovation.head<3>());
  return extended->p_W.allFinite();
}

void TrackMemoryKeeper::Correct(const FilterState& state, const Eigen::Ref<const Eigen::VectorXd>& correction,
                                TrackMemory* memory) const {
  Vector3d shift = Vector3d::Zero();
  for (size_t i = 0; i < state.clones().size(); ++i) {
    shift -= memory->clone_rows.middleCols<6>(6 * state.clones()[i].slot) *
             correction.segment<6>(state.CloneOffset(i));
  }
  shift.noalias() -= memory->clone_rows.rightCols(calibration_) *
                     correction.segment(state.CalibrationOffset(), calibration_);
  const Vector3d move = SolveRegular(memory->landmark_rows, shift);
  if (error_.anchored()) {
    const int anchor = state.FindClone(memory->anchor);
    CHECK_GE(anchor, 0) << "a memory's anchor left the window";
    const Vector3d theta = correction.segment<3>(state.CloneOffset(static_cast<size_t>(anchor)));
    memory->p_W = LandmarkError::Turned(theta, memory->p_W, state.centre());
  }
  memory->p_W += move;
}

void TrackMemoryKeeper::Carry(const FilterState& state, const CloneConditional& conditional,
                              TrackMemory* memory) const {
  const int leaving = 6 * conditional.leaving_slot;
  if (error_.anchored() && memory->anchor == conditional.leaving_serial) {
    const Clone& newest = state.clones().back();
    const Matrix3d over_anchor = LandmarkError::OverAnchor(memory->landmark_rows, memory->p_W);
    memory->clone_rows.middleCols<3>(leaving) -= over_anchor;
    memory->clone_rows.middleCols<3>(6 * newest.slot) += over_anchor;
    memory->anchor = newest.serial;
  }
  const Eigen::Matrix<double, 3, 6> rows = memory->clone_rows.middleCols<6>(leaving);
  if (rows.isZero(0)) {
    return;
  }
  memory->carried = true;
  for (size_t s = 0; s < conditional.neighbours; ++s) {
    memory->clone_rows.middleCols<6>(6 * conditional.neighbour_slots[s]) +=
        rows * conditional.gain.middleCols<6>(6 * static_cast<Index>(s));
  }
  memory->clone_rows.middleCols<6>(leaving).setZero();
  const Matrix3d noise = Matrix3d::Identity() + rows * conditional.covariance * rows.transpose();
  const Eigen::LLT<Matrix3d> whitener(noise);
  whitener.matrixL().solveInPlace(memory->landmark_rows);
  whitener.matrixL().solveInPlace(memory->clone_rows);
}

bool TrackMemoryKeeper::MayStart(
    const Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, 3>>& point_jacobian, const Vector3d& p_W,
    const Vector3d& camera_W) const {
  const Matrix3d information = point_jacobian.transpose() * point_jacobian;
  const Vector3d ray = p_W - camera_W;
  return std::sqrt(ray.dot(SolveSymmetric(information, ray))) < max_depth_deviation_ * ray.squaredNorm();
}

bool TrackMemoryKeeper::MayStay(const TrackMemory& memory, const Vector3d& camera_W) const {
  const Vector3d ray = memory.p_W - camera_W;
  return SolveRegular(memory.landmark_rows.transpose(), ray).norm() <
         kStayFactor * max_depth_deviation_ * ray.squaredNorm();
}

}  // namespace alidade
