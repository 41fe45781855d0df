#include "filter/window_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace alidade {
namespace {

using Eigen::Vector3d;
using OverClone = Eigen::Matrix<double, 3, 6>;

/// A camera's position as the newest one sees it, and its Jacobians over the errors of both clones.
struct SeenFromNewest {
  Vector3d place;
  OverClone over_clone;
  OverClone over_newest;
};

SeenFromNewest SeeFromNewest(const FilterState& state, size_t clone) {
  const Clone& seen = state.clones()[clone];
  const Clone& newest = state.clones().back();
  const Eigen::Matrix3d R_CW = newest.T_WC.rotation.transpose();
  const Vector3d place = R_CW * (seen.T_WC.translation - newest.T_WC.translation);
  return {
      place, R_CW * seen.camera_from_error.bottomRows<3>(),
      Skew(place) * newest.camera_from_error.topRows<3>() - R_CW * newest.camera_from_error.bottomRows<3>()};
}

}  // namespace

double RelativeDeformation(const FilterState& state, const Eigen::Ref<const Eigen::VectorXd>& correction) {
  const size_t newest = state.clones().size() - 1;
  const auto of_newest = correction.segment<6>(state.CloneOffset(newest));
  double deformation = 0;
  double extent = 0;
  for (size_t i = 0; i < newest; ++i) {
    const SeenFromNewest seen = SeeFromNewest(state, i);
    const Vector3d shift =
        seen.over_clone * correction.segment<6>(state.CloneOffset(i)) + seen.over_newest * of_newest;
    deformation += shift.squaredNorm();
    extent += seen.place.squaredNorm();
  }
  return extent > 0 ? std::sqrt(deformation / extent) : 0;
}

BaselineDeviation MeasureBaseline(const FilterState& state) {
  if (state.clones().size() < 2) {
    return {};
  }
  const SeenFromNewest oldest = SeeFromNewest(state, 0);
  const double extent = oldest.place.norm();
  if (!(extent > 0)) {
    return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  const SquareRootCovariance& p = state.covariance();
  const int n = state.CloneOffset(state.clones().size() - 1);
  const int o = state.CloneOffset(0);
  const Eigen::Matrix3d cross = oldest.over_newest * p.PoseBlock(n, o) * oldest.over_clone.transpose();
  const Eigen::Matrix3d covariance = oldest.over_newest * p.PoseBlock(n, n) * oldest.over_newest.transpose() +
                                     oldest.over_clone * p.PoseBlock(o, o) * oldest.over_clone.transpose() +
                                     cross + cross.transpose();
  const Vector3d line = oldest.place / extent;
  const double along = std::max(line.dot(covariance * line), 0.0);
  return {std::sqrt(std::max(covariance.trace() - along, 0.0)) / extent, std::sqrt(along) / extent};
}

}  // namespace alidade
