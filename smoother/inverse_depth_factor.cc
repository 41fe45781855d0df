#include "smoother/inverse_depth_factor.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using RowMatrix2x9 = Eigen::Matrix<double, 2, 9, Eigen::RowMajor>;
using RowMatrix2x3 = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;

// Whitened residual of a landmark behind the camera: far beyond any gate, yet not so large that it hides the
// rest of the cost, to which the solver's tolerance is relative.
constexpr double kBehindSigma = 100;

void StoreNav(const Eigen::Matrix2d& whitening, const InverseDepthModel::PoseJacobian& camera,
              const NavState& state, const Pose& T_BC, double* tangent) {
  if (tangent != nullptr) {
    Eigen::Map<RowMatrix2x9> out(tangent);
    out.leftCols<6>() = whitening * camera * BodyToCameraJacobian(state.R_WB, T_BC);
    out.rightCols<3>().setZero();
  }
}

}  // namespace

bool InverseDepthFactor::Evaluate(const double* const* parameters, double* residual,
                                  double* const* tangent_jacobians) const {
  const NavState base = UnpackNavState(parameters[0]);
  const NavState view = UnpackNavState(parameters[1]);
  const Eigen::Map<const Eigen::Vector3d> landmark(parameters[2]);
  const InverseDepthModel model{landmark.head<2>(), observation_.z};
  const bool differentiate = tangent_jacobians != nullptr;
  Vector2d r;
  InverseDepthModel::PoseJacobian jacobian_base;
  InverseDepthModel::PoseJacobian jacobian_view;
  Vector2d jacobian_rho;
  Eigen::Matrix2d jacobian_bearing;
  const bool in_front =
      model.Evaluate(base.T_WB() * *T_BC_, view.T_WB() * *T_BC_, landmark.z(), &r,
                     differentiate ? &jacobian_base : nullptr, differentiate ? &jacobian_view : nullptr,
                     differentiate ? &jacobian_rho : nullptr, differentiate ? &jacobian_bearing : nullptr);
  if (!in_front) {
    r.setZero();
    jacobian_base.setZero();
    jacobian_view.setZero();
    jacobian_rho.setZero();
    jacobian_bearing.setZero();
  }
  const Eigen::Matrix2d& whitening = observation_.sqrt_information;
  Eigen::Map<Vector2d>{residual} = in_front ? Vector2d(whitening * r) : Vector2d::Constant(kBehindSigma);
  if (differentiate) {
    StoreNav(whitening, jacobian_base, base, *T_BC_, tangent_jacobians[0]);
    StoreNav(whitening, jacobian_view, view, *T_BC_, tangent_jacobians[1]);
    if (tangent_jacobians[2] != nullptr) {
      Eigen::Map<RowMatrix2x3> out(tangent_jacobians[2]);
      out.leftCols<2>() = whitening * jacobian_bearing;
      out.col(2) = whitening * jacobian_rho;
    }
  }
  return true;
}

bool BaseBearingFactor::Evaluate(const double* const* parameters, double* residual,
                                 double* const* tangent_jacobians) const {
  const Eigen::Map<const Eigen::Vector3d> landmark(parameters[0]);
  Eigen::Map<Vector2d>{residual} = observation_.sqrt_information * (landmark.head<2>() - observation_.z);
  if (tangent_jacobians != nullptr && tangent_jacobians[0] != nullptr) {
    Eigen::Map<RowMatrix2x3> out(tangent_jacobians[0]);
    out.leftCols<2>() = observation_.sqrt_information;
    out.col(2).setZero();
  }
  return true;
}

bool DepthPriorFactor::Evaluate(const double* const* parameters, double* residual,
                                double* const* tangent_jacobians) const {
  residual[0] = prior_.sqrt_information * (parameters[0][2] - prior_.mean);
  if (tangent_jacobians != nullptr && tangent_jacobians[0] != nullptr) {
    Eigen::Map<Eigen::RowVector3d>{tangent_jacobians[0]} << 0, 0, prior_.sqrt_information;
  }
  return true;
}

}  // namespace alidade
