#include "core/landmark_reduction.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "core/check.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

bool LinearizeTrack(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                    const Vector3d& p_W, TrackLinearization* linearization) {
  const Eigen::Index count = static_cast<Eigen::Index>(T_WC.size());
  linearization->residual.resize(2 * count);
  linearization->pose_jacobians.resize(2 * count, 6);
  linearization->point_jacobian.resize(2 * count, 3);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Pose& view = T_WC[static_cast<size_t>(k)];
    const NormalizedObservation& observation = observations[static_cast<size_t>(k)];
    const Vector3d p_C = view.rotation.transpose() * (p_W - view.translation);
    if (!(p_C.z() > 0)) {
      return false;
    }
    const Vector2d predicted = p_C.hnormalized();
    Eigen::Matrix<double, 2, 3> perspective;
    perspective << 1, 0, -predicted.x(), 0, 1, -predicted.y();
    const Eigen::Matrix<double, 2, 3> weighted = observation.sqrt_information * (perspective / p_C.z());
    const Eigen::Matrix<double, 2, 3> to_point = weighted * view.rotation.transpose();
    linearization->residual.segment<2>(2 * k) = observation.sqrt_information * (predicted - observation.z);
    linearization->pose_jacobians.block<2, 3>(2 * k, 0) = weighted * Skew(p_C);
    linearization->pose_jacobians.block<2, 3>(2 * k, 3) = -to_point;
    linearization->point_jacobian.middleRows<2>(2 * k) = to_point;
  }
  return true;
}

void EliminateLandmark(Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> point_jacobian,
                       Eigen::Ref<Eigen::MatrixXd> jacobian, Eigen::Ref<Eigen::VectorXd> residual) {
  const Eigen::Index rows = point_jacobian.rows();
  DCHECK_EQ(jacobian.rows(), rows);
  DCHECK_GE(rows, 4);
  for (Eigen::Index column = 0; column < 3; ++column) {
    const Eigen::Index tail = rows - column;
    const double norm = point_jacobian.col(column).tail(tail).norm();
    if (norm == 0) {
      continue;
    }
    // Householder vector v (v0 first), reflection I - v v^T / (v0 * pivot-shift)
    const double pivot = point_jacobian(column, column);
    const double alpha = pivot > 0 ? -norm : norm;
    Eigen::Ref<Eigen::VectorXd> v = point_jacobian.col(column).tail(tail);
    v[0] = pivot - alpha;
    const double scale = -1.0 / (alpha * v[0]);
    for (Eigen::Index other = column + 1; other < 3; ++other) {
      const double dot = scale * v.dot(point_jacobian.col(other).tail(tail));
      point_jacobian.col(other).tail(tail) -= dot * v;
    }
    for (Eigen::Index other = 0; other < jacobian.cols(); ++other) {
      const double dot = scale * v.dot(jacobian.col(other).tail(tail));
      jacobian.col(other).tail(tail) -= dot * v;
    }
    residual.tail(tail) -= scale * v.dot(residual.tail(tail)) * v;
    point_jacobian(column, column) = alpha;
  }
}

bool RefineLandmark(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations, int base,
                    int iterations, Vector3d* p_W) {
  const Pose& base_view = T_WC[static_cast<size_t>(base)];
  const Vector3d p_base = base_view.rotation.transpose() * (*p_W - base_view.translation);
  if (!(p_base.z() > 0)) {
    return false;
  }
  // (x, y, rho) in the base view.
  Vector3d m(p_base.x() / p_base.z(), p_base.y() / p_base.z(), 1.0 / p_base.z());
  // Cost, and when asked for the normal equations; a landmark behind a view costs infinitely much.
  const auto linearize = [&](const Vector3d& at, Matrix3d* normal, Vector3d* gradient) {
    double cost = 0;
    if (normal != nullptr) {
      normal->setZero();
      gradient->setZero();
    }
    for (size_t k = 0; k < T_WC.size(); ++k) {
      const Matrix3d R_kb = T_WC[k].rotation.transpose() * base_view.rotation;
      const Vector3d shift = T_WC[k].rotation.transpose() * (base_view.translation - T_WC[k].translation);
      const Vector3d q = R_kb * Vector3d(at.x(), at.y(), 1) + at.z() * shift;
      if (!(q.z() > 1e-6)) {
        return std::numeric_limits<double>::infinity();
      }
      const Vector2d predicted = q.hnormalized();
      const Vector2d residual = observations[k].sqrt_information * (predicted - observations[k].z);
      cost += residual.squaredNorm();
      if (normal != nullptr) {
        Eigen::Matrix<double, 2, 3> perspective;
        perspective << 1, 0, -predicted.x(), 0, 1, -predicted.y();
        Matrix3d direction;
        direction << R_kb.col(0), R_kb.col(1), shift;
        const Eigen::Matrix<double, 2, 3> jacobian =
            observations[k].sqrt_information * (perspective / q.z()) * direction;
        *normal += jacobian.transpose() * jacobian;
        *gradient += jacobian.transpose() * residual;
      }
    }
    return cost;
  };
  double damping = 1e-9;
  Matrix3d normal;
  Vector3d gradient;
  double cost = linearize(m, &normal, &gradient);
  for (int i = 0; i < iterations && std::isfinite(cost); ++i) {
    Matrix3d damped = normal;
    damped.diagonal() *= 1 + damping;
    const Vector3d step = damped.ldlt().solve(-gradient);
    const Vector3d candidate = m + step;
    const double candidate_cost =
        candidate.z() > 0 ? linearize(candidate, nullptr, nullptr) : std::numeric_limits<double>::infinity();
    if (candidate_cost <= cost) {
      const bool converged = cost - candidate_cost < 1e-10 * (1 + cost);
      m = candidate;
      damping = std::max(damping * 0.1, 1e-9);
      if (converged) {
        break;
      }
      cost = linearize(m, &normal, &gradient);
    } else {
      damping = std::max(damping * 100, 1e-3);
    }
  }
  if (!std::isfinite(cost) || !(m.z() > 0) || !m.allFinite()) {
    return false;
  }
  *p_W = base_view.translation + base_view.rotation * Vector3d(m.x(), m.y(), 1) / m.z();
  return true;
}

}  // namespace alidade
