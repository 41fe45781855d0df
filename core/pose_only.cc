#include "core/pose_only.h"

#include <cmath>

#include "core/check.h"
#include "core/turned_ray.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The part of A and b that view i contributes.
struct DepthRow {
  Vector3d z;      // direction observed
  Vector3d ray;    // R_i^T R_b z_b
  Vector3d shift;  // R_i^T (p_b - p_i)
  Vector3d a;      // [z]x ray
  Vector3d b;      // -[z]x shift
};

DepthRow MakeRow(const Pose& view, const NormalizedObservation& observation, const Pose& base_view,
                 const Vector3d& base_ray_W) {
  DepthRow row;
  row.z = observation.Ray();
  row.ray = view.rotation.transpose() * base_ray_W;
  row.shift = view.rotation.transpose() * (base_view.translation - view.translation);
  row.a = row.z.cross(row.ray);
  row.b = -row.z.cross(row.shift);
  return row;
}

bool GivesDepth(int view, int base, int count, DepthViews views) {
  return view != base && (views == DepthViews::kMulti || view == (base == count - 1 ? 0 : count - 1));
}

/// d depth / d (phi, dp) of every view and d depth / d z of every view.
struct DepthDerivative {
  Eigen::RowVectorXd poses;         // 1 x 6N
  Eigen::RowVectorXd observations;  // 1 x 2N
};

DepthDerivative DifferentiateDepth(std::span<const Pose> T_WC,
                                   std::span<const NormalizedObservation> observations, int base,
                                   DepthViews views, const PoseOnlyDepth& depth) {
  const int count = static_cast<int>(T_WC.size());
  const Pose& base_view = T_WC[static_cast<size_t>(base)];
  const Vector3d z_b = observations[static_cast<size_t>(base)].Ray();
  const Vector3d base_ray_W = base_view.rotation * z_b;
  DepthDerivative derivative{Eigen::RowVectorXd::Zero(6 * count), Eigen::RowVectorXd::Zero(2 * count)};
  for (int i = 0; i < count; ++i) {
    if (!GivesDepth(i, base, count, views)) {
      continue;
    }
    const Pose& view = T_WC[static_cast<size_t>(i)];
    const DepthRow row = MakeRow(view, observations[static_cast<size_t>(i)], base_view, base_ray_W);
    // dd = [ (b - 2 d A)^T dA + A^T db ] / A^T A, with dA = [z]x dray - [ray]x dz and
    // db = -[z]x dshift + [shift]x dz.
    const Vector3d weight_a = (row.b - 2 * depth.depth * row.a) / depth.normal;
    const Vector3d weight_b = row.a / depth.normal;
    const Eigen::RowVector3d to_ray = weight_a.transpose() * Skew(row.z);
    const Eigen::RowVector3d to_shift = -weight_b.transpose() * Skew(row.z);
    const Matrix3d Rt = view.rotation.transpose();
    derivative.poses.segment<3>(6 * i) += to_ray * Skew(row.ray) + to_shift * Skew(row.shift);
    derivative.poses.segment<3>(6 * i + 3) -= to_shift * Rt;
    derivative.poses.segment<3>(6 * base) -= to_ray * Rt * base_view.rotation * Skew(z_b);
    derivative.poses.segment<3>(6 * base + 3) += to_shift * Rt;
    const Eigen::RowVector3d to_z =
        -weight_a.transpose() * Skew(row.ray) + weight_b.transpose() * Skew(row.shift);
    derivative.observations.segment<2>(2 * i) +=
        to_z * observations[static_cast<size_t>(i)].plane.axes().leftCols<2>();
    derivative.observations.segment<2>(2 * base) +=
        to_ray * Rt * base_view.rotation * observations[static_cast<size_t>(base)].plane.axes().leftCols<2>();
  }
  return derivative;
}

/// p_W moves with the base pose, the base's ray and the depth.
void DifferentiatePoint(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                        int base, DepthViews views, const PoseOnlyDepth& depth,
                        PoseOnlyJacobians* jacobians) {
  const DepthDerivative derivative = DifferentiateDepth(T_WC, observations, base, views, depth);
  const Pose& base_view = T_WC[static_cast<size_t>(base)];
  const Vector3d z_b = observations[static_cast<size_t>(base)].Ray();
  const Vector3d base_ray_W = base_view.rotation * z_b;
  jacobians->poses = base_ray_W * derivative.poses;
  jacobians->poses.middleCols<3>(6 * base) -= depth.depth * base_view.rotation * Skew(z_b);
  jacobians->poses.middleCols<3>(6 * base + 3) += Matrix3d::Identity();
  jacobians->observations = base_ray_W * derivative.observations;
  jacobians->observations.middleCols<2>(2 * base) +=
      depth.depth * base_view.rotation * observations[static_cast<size_t>(base)].plane.axes().leftCols<2>();
}

}  // namespace

bool ComputePoseOnlyDepth(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                          int base, DepthViews views, PoseOnlyDepth* depth, PoseOnlyJacobians* jacobians) {
  const int count = static_cast<int>(T_WC.size());
  CHECK_EQ(observations.size(), T_WC.size());
  CHECK(count >= 2 && base >= 0 && base < count);
  const Pose& base_view = T_WC[static_cast<size_t>(base)];
  const Vector3d base_ray_W = TurnedRay(base_view.rotation, observations[static_cast<size_t>(base)].Ray());
  double normal = 0;
  double right_side = 0;
  for (int i = 0; i < count; ++i) {
    if (GivesDepth(i, base, count, views)) {
      const DepthRow row =
          MakeRow(T_WC[static_cast<size_t>(i)], observations[static_cast<size_t>(i)], base_view, base_ray_W);
      normal += row.a.squaredNorm();
      right_side += row.a.dot(row.b);
    }
  }
  if (!(normal > 1e-24)) {
    return false;
  }
  depth->normal = normal;
  depth->depth = right_side / normal;
  depth->p_W = base_view.translation + depth->depth * base_ray_W;
  if (!std::isfinite(depth->depth) || !depth->p_W.allFinite()) {
    return false;
  }
  if (jacobians != nullptr) {
    DifferentiatePoint(T_WC, observations, base, views, *depth, jacobians);
  }
  return true;
}

bool DepthIsDetermined(const PoseOnlyDepth& depth, int other_views, double sigma,
                       double max_relative_deviation) {
  const double parallax = depth.normal - 4 * other_views * sigma * sigma;
  return parallax * max_relative_deviation * max_relative_deviation > sigma * sigma;
}

}  // namespace alidade
