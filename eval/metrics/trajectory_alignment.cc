#include "eval/metrics/trajectory_alignment.h"

#include <Eigen/Geometry>

#include "core/yaw_shift.h"

namespace alidade {
namespace {

/// 3xN positions of one side of the pairs.
Eigen::Matrix3Xd Positions(const std::vector<StatePair>& pairs, TrajectoryPoint StatePair::*side) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    positions.col(static_cast<Eigen::Index>(i)) = (pairs[i].*side).nav.p_WB;
  }
  return positions;
}

/// Turn about z that minimises sum |truth_c - R_z(yaw) estimate_c|^2 of centred positions. Identity when all
/// horizontal positions coincide.
Eigen::Matrix3d BestYaw(const Eigen::Matrix3Xd& truth_centred, const Eigen::Matrix3Xd& estimate_centred) {
  return YawShift{so3::NearestYaw(truth_centred * estimate_centred.transpose())}.Rotation();
}

/// Umeyama, "Least-squares estimation of transformation parameters between two point patterns", 1991.
AlignmentTransform AlignUmeyama(const Eigen::Matrix3Xd& truth, const Eigen::Matrix3Xd& estimate,
                                bool with_scale) {
  const Eigen::Vector3d truth_mean = truth.rowwise().mean();
  const Eigen::Vector3d estimate_mean = estimate.rowwise().mean();
  // A cloud that is one point has no scale; dividing by its variance would give NaN.
  const bool has_extent = (estimate.colwise() - estimate_mean).squaredNorm() > 0;
  const Eigen::Matrix4d similarity = Eigen::umeyama(estimate, truth, with_scale && has_extent);

  AlignmentTransform transform;
  const double scale = similarity.topLeftCorner<3, 1>().norm();
  if (with_scale && has_extent) {
    transform.scale = scale;
  }
  // Scale 0 (the truth stands still) leaves no rotation to extract.
  if (scale > 0) {
    transform.rotation = similarity.topLeftCorner<3, 3>() / scale;
  }
  transform.translation = truth_mean - transform.scale * (transform.rotation * estimate_mean);
  return transform;
}

}  // namespace

AlignmentTransform AnchorAtFirst(const std::vector<StatePair>& pairs) {
  const NavState& truth = pairs.front().truth.nav;
  const NavState& estimate = pairs.front().estimate.nav;
  AlignmentTransform transform;
  transform.rotation = YawShift{so3::NearestYaw(truth.R_WB * estimate.R_WB.transpose())}.Rotation();
  transform.translation = truth.p_WB - transform.rotation * estimate.p_WB;
  return transform;
}

std::optional<TrajectoryAlignment> ParseTrajectoryAlignment(std::string_view name) {
  for (const TrajectoryAlignment alignment :
       {TrajectoryAlignment::kNone, TrajectoryAlignment::kPos, TrajectoryAlignment::kPosYaw,
        TrajectoryAlignment::kSe3, TrajectoryAlignment::kSim3}) {
    if (name == ToString(alignment)) {
      return alignment;
    }
  }
  return std::nullopt;
}

std::string_view ToString(TrajectoryAlignment alignment) {
  switch (alignment) {
    case TrajectoryAlignment::kNone:
      return "none";
    case TrajectoryAlignment::kPos:
      return "pos";
    case TrajectoryAlignment::kPosYaw:
      return "posyaw";
    case TrajectoryAlignment::kSe3:
      return "se3";
    case TrajectoryAlignment::kSim3:
      return "sim3";
  }
  return "none";
}

AlignmentTransform Align(const std::vector<StatePair>& pairs, TrajectoryAlignment alignment) {
  AlignmentTransform transform;
  if (pairs.empty() || alignment == TrajectoryAlignment::kNone) {
    return transform;
  }
  const Eigen::Matrix3Xd truth = Positions(pairs, &StatePair::truth);
  const Eigen::Matrix3Xd estimate = Positions(pairs, &StatePair::estimate);
  if (alignment == TrajectoryAlignment::kSe3 || alignment == TrajectoryAlignment::kSim3) {
    return AlignUmeyama(truth, estimate, alignment == TrajectoryAlignment::kSim3);
  }
  const Eigen::Vector3d truth_mean = truth.rowwise().mean();
  const Eigen::Vector3d estimate_mean = estimate.rowwise().mean();
  if (alignment == TrajectoryAlignment::kPosYaw) {
    transform.rotation = BestYaw(truth.colwise() - truth_mean, estimate.colwise() - estimate_mean);
  }
  transform.translation = truth_mean - transform.rotation * estimate_mean;
  return transform;
}

std::vector<StatePair> ApplyAlignment(const std::vector<StatePair>& pairs,
                                      const AlignmentTransform& transform) {
  // phi is a perturbation in the body frame and stays; dp and dv live in the world and turn with it.
  const Eigen::Matrix3d world_change = transform.scale * transform.rotation;
  Matrix6d chart_change = Matrix6d::Identity();
  chart_change.bottomRightCorner<3, 3>() = world_change;

  std::vector<StatePair> aligned = pairs;
  for (StatePair& pair : aligned) {
    NavState& nav = pair.estimate.nav;
    const Eigen::Matrix3d rotation = transform.rotation * nav.R_WB;
    const Eigen::Vector3d position =
        transform.scale * (transform.rotation * nav.p_WB) + transform.translation;
    const Eigen::Vector3d velocity = transform.scale * (transform.rotation * nav.v_WB);
    const Matrix6d covariance = chart_change * pair.estimate.covariance * chart_change.transpose();
    nav = {rotation, position, velocity};
    pair.estimate.covariance = covariance;
    Eigen::Matrix3d& velocity_covariance = pair.estimate.motion_covariance.velocity;
    velocity_covariance = (world_change * velocity_covariance * world_change.transpose()).eval();
  }
  return aligned;
}

}  // namespace alidade
