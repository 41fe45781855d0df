#include "filter/scale_direction.h"

#include <Eigen/LU>
#include <cmath>

namespace alidade {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

// Of the scale at Take. A window that shrinks by more has another shape.
constexpr double kLeastScale = 0.1;

Vector3d FromOldest(const FilterState& state, size_t clone) {
  return state.clones()[clone].T_WC.translation - state.clones().front().T_WC.translation;
}

/// d camera position / d position part of the clone's error.
auto OverPosition(const Clone& clone) {
  return clone.camera_from_error.bottomRightCorner<3, 3>();
}

}  // namespace

ScaleDirection::ScaleDirection(int capacity)
    : row_(capacity), places_(capacity / 6, 3), change_(capacity), carried_(capacity) {}

bool ScaleDirection::Take(const FilterState& state, int last_serial) {
  const std::vector<Clone>& clones = state.clones();
  determined_ = 0;
  while (determined_ < clones.size() && clones[determined_].serial <= last_serial) {
    ++determined_;
  }
  if (determined_ < 2) {
    return false;
  }
  dimension_ = state.covariance().dimension();
  auto row = row_.head(dimension_);
  row.setZero();
  double extent = 0;
  for (size_t i = 0; i < determined_; ++i) {
    const Vector3d place = FromOldest(state, i);
    places_.row(static_cast<Index>(i)) = place;
    extent += place.squaredNorm();
    row.segment<6>(state.CloneOffset(i)) += clones[i].camera_from_error.bottomRows<3>().transpose() * place;
    row.segment<6>(state.CloneOffset(0)) -=
        clones.front().camera_from_error.bottomRows<3>().transpose() * place;
  }
  row /= extent;
  scale_ = 1;
  carried_.head(dimension_).setZero();
  return extent > 0;
}

void ScaleDirection::Carry(FilterState* state, Eigen::Ref<VectorXd> errors) {
  const std::vector<Clone>& clones = state->clones();
  auto change = change_.head(state->covariance().dimension());
  change.setZero();
  double scale = 0;                  // l.n
  Vector3d last = Vector3d::Zero();  // change of the last place
  Vector3d rate = Vector3d::Zero();
  TimeNs last_ns = clones.front().stamp_ns;
  for (size_t i = 0; i < clones.size(); ++i) {
    const double dt_s = SecondsBetween(last_ns, clones[i].stamp_ns);
    Vector3d moved = last + dt_s * rate;
    if (i < determined_) {
      const Vector3d place = FromOldest(*state, i);
      moved = place - places_.row(static_cast<Index>(i)).transpose();
      if (dt_s > 0) {
        rate = (moved - last) / dt_s;
      }
      scale += row_.segment<3>(state->CloneOffset(i) + 3)
                   .dot(OverPosition(clones[i]).inverse() * places_.row(static_cast<Index>(i)).transpose());
      places_.row(static_cast<Index>(i)) = place;
    }
    change.segment<3>(state->CloneOffset(i) + 3) = OverPosition(clones[i]).inverse() * moved;
    last = moved;
    last_ns = clones[i].stamp_ns;
  }
  Vector15d core = Vector15d::Zero();
  core.segment<3>(3) = last;
  core.segment<3>(6) = rate;
  change.segment<15>(state->CoreOffset()) = InverseImuChartJacobian(state->convention(), state->nav()) * core;
  if (!(scale > kLeastScale)) {
    return;
  }
  const auto row = row_.head(change.size());
  scale_ = scale + row.dot(change);
  change /= scale;
  state->Shear(change, row);
  auto carried = carried_.head(change.size());
  carried += (1 + row.dot(carried)) * change;
  if (errors.size() > 0) {
    errors += row.dot(errors) * change;
  }
}

void ScaleDirection::TakeBack(FilterState* state) {
  const auto row = row_.head(dimension_);
  auto carried = carried_.head(dimension_);
  carried /= -(1 + row.dot(carried));
  state->Shear(carried, row);
  carried.setZero();
}

double ScaleDirection::VarianceOfRow(const SquareRootCovariance& covariance) {
  const auto factor = covariance.factor().triangularView<Eigen::Upper>();
  auto whitened = change_.head(covariance.dimension());
  whitened.noalias() = factor.transpose() * row_.head(whitened.size());
  return whitened.squaredNorm();
}

void ScaleDirection::Descend(const SquareRootCovariance& covariance, double gradient,
                             Eigen::Ref<VectorXd> correction) {
  const double variance = VarianceOfRow(covariance) / (scale_ * scale_);
  correction.noalias() = covariance.factor().triangularView<Eigen::Upper>() * change_.head(correction.size());
  correction *= -gradient / (scale_ * (1 + variance * std::abs(gradient)));
}

void ScaleDirection::Inflate(const Eigen::Ref<const VectorXd>& step, FilterState* state) {
  const auto row = row_.head(step.size());
  const double variance = VarianceOfRow(state->covariance());
  const double along = row.dot(step);
  if (!(variance > 0) || along == 0) {
    return;
  }
  auto column = change_.head(step.size());
  column = step * ((std::sqrt(1 + along * along / (3 * variance)) - 1) / along);
  state->Shear(column, row);
}

}  // namespace alidade
