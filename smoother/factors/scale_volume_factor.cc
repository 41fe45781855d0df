#include "smoother/factors/scale_volume_factor.h"

#include <cmath>

#include "smoother/factors/spread.h"

namespace alidade {
namespace {

// Square root of the curvature along the logarithm of the spread, without which a row has no gradient: the
// information of a deviation of more than three times the scale.
constexpr double kCurvatureRoot = 0.3;

}  // namespace

ScaleVolumeFactor::ScaleVolumeFactor(int frames, const Eigen::Vector3d& point_B, double present_m,
                                     double freedom)
    : point_B_(point_B),
      present_m_(present_m),
      freedom_(freedom),
      blocks_(static_cast<size_t>(frames), BlockKind::kNavState) {}

bool ScaleVolumeFactor::Evaluate(const double* const* parameters, double* residual,
                                 double* const* tangent_jacobians) const {
  std::vector<NavState> states;
  states.reserve(blocks_.size());
  for (size_t i = 0; i < blocks_.size(); ++i) {
    states.push_back(UnpackNavState(parameters[i]));
  }
  const Spread spread = SpreadOf(states, point_B_);
  if (!(spread.metres > 0)) {
    return false;
  }
  residual[0] = kCurvatureRoot * std::log(spread.metres / present_m_) - freedom_ / kCurvatureRoot;
  for (size_t i = 0; tangent_jacobians != nullptr && i < blocks_.size(); ++i) {
    if (tangent_jacobians[i] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 1, kNavTangentSize>> row(tangent_jacobians[i]);
      row << kCurvatureRoot * spread.slope.col(static_cast<Eigen::Index>(i)).transpose(),
          Eigen::RowVector3d::Zero();
    }
  }
  return true;
}

}  // namespace alidade
