#include "core/navigation_state.h"

#include "core/dense_solvers.h"
#include "core/format.h"

namespace alidade {

Eigen::Vector3d Pose::operator*(const Eigen::Vector3d& p) const {
  return rotation * p + translation;
}

Pose Pose::operator*(const Pose& other) const {
  return {rotation * other.rotation, rotation * other.translation + translation};
}

Pose Pose::Inverse() const {
  return {rotation.transpose(), -(rotation.transpose() * translation)};
}

bool IsFinite(const NavEstimate& estimate) {
  return estimate.nav.R_WB.allFinite() && estimate.nav.p_WB.allFinite() && estimate.nav.v_WB.allFinite() &&
         estimate.bias.gyro.allFinite() && estimate.bias.accel.allFinite() && estimate.covariance.allFinite();
}

Status CheckInitialState(const NavEstimate& initial) {
  const NavState& nav = initial.nav;
  if (!IsFinite(initial)) {
    return Status::Input("initial state is not finite");
  }
  const double off = (nav.R_WB * nav.R_WB.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (off > 1e-6 || nav.R_WB.determinant() < 0) {
    return Status::Input(Format("initial R_WB is not a rotation: |R R^T - I| is %.3g, determinant %.3g", off,
                                nav.R_WB.determinant()));
  }
  const double scale = initial.covariance.cwiseAbs().maxCoeff();
  if ((initial.covariance - initial.covariance.transpose()).cwiseAbs().maxCoeff() > 1e-9 * scale) {
    return Status::Input("initial covariance is not symmetric");
  }
  const Matrix15d lifted = initial.covariance + 1e-12 * scale * Matrix15d::Identity();
  if (scale > 0 && !SymmetricSolver(lifted).positive()) {
    return Status::Input("initial covariance has a negative eigenvalue");
  }
  return Status::Ok();
}

}  // namespace alidade
