#include "core/landmark_reduction.h"

#include <cmath>

#include "core/check.h"
#include "core/reprojection.h"

namespace alidade {

bool LinearizeObservation(const Pose& T_WC, const NormalizedObservation& observation,
                          const Eigen::Vector3d& p_W, ObservationRows* rows) {
  const PointInCamera seen(T_WC, p_W);
  Eigen::Vector2d predicted;
  PointRows<2> projection;
  if (!ProjectToPlane(observation.plane, seen.q, kMinPointDepth, &predicted, &projection)) {
    return false;
  }
  const PointRows<2> whitened = observation.sqrt_information * projection;
  rows->residual = observation.sqrt_information * (predicted - observation.z);
  seen.Chain(whitened, &rows->pose_jacobian, &rows->point_jacobian);
  return true;
}

bool LinearizeTrack(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                    const Eigen::Vector3d& p_W, TrackLinearization* linearization) {
  const Eigen::Index count = static_cast<Eigen::Index>(T_WC.size());
  linearization->residual.resize(2 * count);
  linearization->pose_jacobians.resize(2 * count, 6);
  linearization->point_jacobian.resize(2 * count, 3);
  ObservationRows rows;
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto view = static_cast<size_t>(k);
    if (!LinearizeObservation(T_WC[view], observations[view], p_W, &rows)) {
      return false;
    }
    linearization->residual.segment<2>(2 * k) = rows.residual;
    linearization->pose_jacobians.middleRows<2>(2 * k) = rows.pose_jacobian;
    linearization->point_jacobian.middleRows<2>(2 * k) = rows.point_jacobian;
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

}  // namespace alidade
