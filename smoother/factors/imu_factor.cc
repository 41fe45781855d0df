#include "smoother/factors/imu_factor.h"

namespace alidade {
namespace {

using RowMatrix15x9 = Eigen::Matrix<double, 15, 9, Eigen::RowMajor>;
using RowMatrix15x6 = Eigen::Matrix<double, 15, 6, Eigen::RowMajor>;

void Split(const Matrix15d& jacobian, double* nav, double* bias) {
  if (nav != nullptr) {
    Eigen::Map<RowMatrix15x9>{nav} = jacobian.leftCols<9>();
  }
  if (bias != nullptr) {
    Eigen::Map<RowMatrix15x6>{bias} = jacobian.rightCols<6>();
  }
}

NavState PointOf(const FirstEstimate* first, const NavState& now) {
  return first == nullptr ? now : first->Point(now);
}

void Chain(const FirstEstimate* first, const NavState& now, Matrix15d* jacobian) {
  if (first != nullptr) {
    jacobian->leftCols<9>() = (jacobian->leftCols<9>() * first->Chain(now)).eval();
  }
}

}  // namespace

ImuFactor::ImuFactor(const Preintegration* preintegration, const Eigen::Vector3d& gravity_W,
                     const FirstEstimate* first_i, const FirstEstimate* first_j)
    : model_{preintegration, gravity_W},
      sqrt_information_(Matrix15d::Zero()),
      valid_(preintegration->Whitening(&sqrt_information_)),
      first_i_(first_i),
      first_j_(first_j) {}

bool ImuFactor::Evaluate(const double* const* parameters, double* residual,
                         double* const* tangent_jacobians) const {
  const NavState state_i = UnpackNavState(parameters[0]);
  const NavState state_j = UnpackNavState(parameters[2]);
  const bool differentiate = tangent_jacobians != nullptr;
  Vector15d r;
  Matrix15d jacobian_i;
  Matrix15d jacobian_j;
  model_.Evaluate(state_i, UnpackBias(parameters[1]), state_j, UnpackBias(parameters[3]), &r,
                  differentiate ? &jacobian_i : nullptr, differentiate ? &jacobian_j : nullptr);
  if (differentiate && (first_i_ != nullptr || first_j_ != nullptr)) {
    Vector15d ignored;
    model_.Evaluate(PointOf(first_i_, state_i), UnpackBias(parameters[1]), PointOf(first_j_, state_j),
                    UnpackBias(parameters[3]), &ignored, &jacobian_i, &jacobian_j);
    Chain(first_i_, state_i, &jacobian_i);
    Chain(first_j_, state_j, &jacobian_j);
  }
  Eigen::Map<Vector15d>{residual} = sqrt_information_.triangularView<Eigen::Lower>() * r;
  if (differentiate) {
    Split(sqrt_information_.triangularView<Eigen::Lower>() * jacobian_i, tangent_jacobians[0],
          tangent_jacobians[1]);
    Split(sqrt_information_.triangularView<Eigen::Lower>() * jacobian_j, tangent_jacobians[2],
          tangent_jacobians[3]);
  }
  return true;
}

}  // namespace alidade
