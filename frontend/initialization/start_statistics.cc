// Statistics of the solution of the start's least-squares problem: covariance, scale, fit.

#include <cmath>

#include "core/dense_solvers.h"
#include "frontend/initialization/start_problem.h"

namespace alidade {

using Eigen::Vector3d;

bool StartProblem::NewestCovariance(double variance_factor, Matrix15d* covariance) const {
  const Eigen::Index rest = information_.rows() - 15;
  const SymmetricSolver factor(information_.topLeftCorner(rest, rest));
  if (!(factor.min_pivot() > 0)) {
    return false;
  }
  const Eigen::MatrixXd coupling = information_.bottomLeftCorner(15, rest).transpose();
  Matrix15d marginal =
      information_.bottomRightCorner<15, 15>() - coupling.transpose() * factor.Solve(coupling);
  marginal = marginal / variance_factor + gauge_;
  const SymmetricSolver newest(marginal);
  if (!(newest.min_pivot() > 0)) {
    return false;
  }
  const Matrix15d inverse = newest.Solve(Matrix15d::Identity());
  *covariance = 0.5 * (inverse + inverse.transpose());
  return covariance->allFinite();
}

bool StartProblem::Assess(double* relative_scale_std, double* inertial_chi2) const {
  Eigen::MatrixXd full = information_;
  full.bottomRightCorner<15, 15>() += gauge_;
  const Eigen::LLT<Eigen::MatrixXd> factor(full);
  return factor.info() == Eigen::Success && RelativeScaleStd(factor, relative_scale_std) &&
         InertialChi2(factor, inertial_chi2);
}

// Of the cameras' positions: where the body only turns about its camera, the lever arm gives the body's,
// whatever the scale of the scene.
bool StartProblem::RelativeScaleStd(const Eigen::LLT<Eigen::MatrixXd>& factor, double* deviation) const {
  Eigen::VectorXd functional = Eigen::VectorXd::Zero(information_.rows());
  const auto camera = [&](const NavState& state) -> Vector3d {
    return state.p_WB + state.R_WB * settings_.T_BC.translation;
  };
  const auto add = [&](size_t k, const Vector3d& arm) {
    const Eigen::Index at = 15 * static_cast<Eigen::Index>(k);
    functional.segment<3>(at) += settings_.T_BC.translation.cross(current_.states[k].R_WB.transpose() * arm);
    functional.segment<3>(at + 3) += arm;
  };
  const size_t newest = current_.states.size() - 1;
  double extent = 0;
  for (size_t k = 0; k < newest; ++k) {
    const Vector3d arm = camera(current_.states[k]) - camera(current_.states[newest]);
    add(k, arm);
    add(newest, -arm);
    extent += arm.squaredNorm();
  }
  if (!(extent > 1e-12)) {
    return false;
  }
  functional /= extent;
  *deviation = std::sqrt(functional.dot(factor.solve(functional)));
  return std::isfinite(*deviation);
}

bool StartProblem::InertialChi2(const Eigen::LLT<Eigen::MatrixXd>& factor, double* chi2) const {
  const Eigen::Index rows = 15 * static_cast<Eigen::Index>(preintegrations_.size());
  Eigen::MatrixXd transposed = Eigen::MatrixXd::Zero(information_.rows(), rows);
  double cost = 0;
  for (size_t k = 0; k < preintegrations_.size(); ++k) {
    const Eigen::Index at = 15 * static_cast<Eigen::Index>(k);
    Vector15d residual;
    transposed.block<30, 15>(at, at) = InertialJacobian(k, &residual).transpose();
    cost += residual.squaredNorm();
  }
  factor.matrixL().solveInPlace(transposed);
  const double freedom = static_cast<double>(rows) - transposed.squaredNorm();
  *chi2 = cost / freedom;
  return freedom > 0;
}

double StartProblem::ReprojectionChi2() const {
  double sum = 0;
  double dof = 0;
  std::vector<double> squared;
  for (size_t t = 0; t < active_.size(); ++t) {
    if (active_[t]) {
      TrackResiduals(current_, t, &squared);
      for (const double value : squared) {
        sum += value;
      }
      dof += 2 * static_cast<double>(squared.size()) - 3;
    }
  }
  return dof > 0 ? sum / dof : 0;
}

}  // namespace alidade
