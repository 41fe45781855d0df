#include "core/inverse_depth.h"
#include "core/landmark_reduction.h"
#include "core/pose_only.h"
#include "eval/probe/probe_models.h"

namespace alidade::probe {
namespace {

/// The landmark's own rows that EliminateLandmark leaves on top.
constexpr int kLandmarkRows = 3;

/// Columns from the canonical chart of every view to the error of `convention`, in place.
void ToErrorCoordinates(const std::vector<Pose>& views, ErrorConvention convention,
                        Eigen::MatrixXd* jacobian) {
  for (size_t i = 0; i < views.size(); ++i) {
    const Eigen::Index column = static_cast<Eigen::Index>(6 * i);
    const Eigen::MatrixXd block = jacobian->middleCols<6>(column) * ChartJacobian(convention, views[i]);
    jacobian->middleCols<6>(column) = block;
  }
}

DepthViews PairOf(const Json& input) {
  const Json& pair = Member(input, "pair");
  if (pair == "multi") {
    return DepthViews::kMulti;
  }
  if (pair == "two") {
    return DepthViews::kTwo;
  }
  throw CaseError{"pair: found " + pair.dump(-1, ' ', false, Json::error_handler_t::replace) +
                  ", expected \"multi\" or \"two\""};
}

/// Observations of unit noise.
std::vector<NormalizedObservation> UnitNoise(const std::vector<Eigen::Vector2d>& z) {
  std::vector<NormalizedObservation> observations(z.size());
  for (size_t i = 0; i < z.size(); ++i) {
    observations[i].z = z[i];
  }
  return observations;
}

/// The rows of a track over the poses of all its views, the landmark held fixed, 2N x 6N.
Eigen::MatrixXd OverAllPoses(const TrackLinearization& track) {
  const Eigen::Index rows = track.residual.size();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, 3 * rows);
  for (Eigen::Index k = 0; 2 * k < rows; ++k) {
    jacobian.block<2, 6>(2 * k, 6 * k) = track.pose_jacobians.middleRows<2>(2 * k);
  }
  return jacobian;
}

}  // namespace

Json PoseOnlyAnswer(const Json& input, ErrorConvention convention) {
  const std::vector<Pose> views = Views(input);
  const std::vector<NormalizedObservation> observations = UnitNoise(Observations(input, views.size()));
  const int base = Index(Member(input, "base"), "base", static_cast<int>(views.size()));
  const DepthViews pair = PairOf(input);
  if (pair == DepthViews::kTwo && base + 1 == static_cast<int>(views.size())) {
    throw CaseError{"base: the last view cannot be the base of a two-view depth"};
  }
  PoseOnlyDepth depth;
  PoseOnlyJacobians point;
  TrackLinearization track;
  if (!ComputePoseOnlyDepth(views, observations, base, pair, &depth, &point) ||
      !LinearizeTrack(views, observations, depth.p_W, &track)) {
    throw CaseError{"no parallax between the views, or the landmark lies behind one of them"};
  }
  const Eigen::VectorXd observed_minus_predicted = -track.residual;
  Eigen::MatrixXd fixed_landmark = OverAllPoses(track);
  // Total derivatives: the landmark follows poses and observations.
  Eigen::MatrixXd total = fixed_landmark + track.point_jacobian * point.poses;
  ToErrorCoordinates(views, convention, &total);
  const Eigen::Index rows = track.residual.size();
  const Eigen::MatrixXd noise =
      Eigen::MatrixXd::Identity(rows, rows) - track.point_jacobian * point.observations;

  ToErrorCoordinates(views, convention, &fixed_landmark);
  Eigen::VectorXd reduced = observed_minus_predicted;
  EliminateLandmark(track.point_jacobian, fixed_landmark, reduced);
  const Eigen::MatrixXd pose_rows = fixed_landmark.bottomRows(rows - kLandmarkRows);

  Json answer;
  answer["depth"] = depth.depth;
  answer["p_f"] = VectorToJson(depth.p_W);
  answer["residual"] = VectorToJson(observed_minus_predicted);
  answer["H_X"] = ToJson(total);
  answer["H_n"] = ToJson(noise);
  answer["information"] = ToJson(pose_rows.transpose() * pose_rows);
  answer["gradient"] = VectorToJson(pose_rows.transpose() * reduced.tail(rows - kLandmarkRows));
  return answer;
}

Json InverseDepthAnswer(const Json& input, ErrorConvention convention) {
  const std::vector<Pose> views = Views(input);
  const std::vector<Eigen::Vector2d> z = Observations(input, views.size());
  const int base = Index(Member(input, "base"), "base", static_cast<int>(views.size()));
  const double inverse_depth = Number(Member(input, "inverse_depth"), "inverse_depth");
  if (inverse_depth < 0) {
    throw CaseError{"inverse_depth: found " + input["inverse_depth"].dump() + ", expected at least 0"};
  }
  const Eigen::Index rows = static_cast<Eigen::Index>(2 * views.size());

  const Eigen::Vector2d& bearing = z[static_cast<size_t>(base)];
  const Eigen::Vector3d landmark(bearing.x(), bearing.y(), inverse_depth);
  // The base observes its own bearing exactly: its two rows stay zero.
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(rows);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, 3 * rows);
  Eigen::VectorXd jacobian_rho = Eigen::VectorXd::Zero(rows);
  for (int k = 0; k < static_cast<int>(views.size()); ++k) {
    if (k == base) {
      continue;
    }
    const InverseDepthModel model{z[static_cast<size_t>(k)]};
    Eigen::Vector2d view_residual;
    InverseDepthModel::PoseJacobian base_block, view_block;
    InverseDepthModel::LandmarkJacobian landmark_block;
    if (!model.Evaluate(views[static_cast<size_t>(base)], views[static_cast<size_t>(k)], landmark,
                        &view_residual, &base_block, &view_block, &landmark_block)) {
      throw CaseError{"landmark lies behind views[" + std::to_string(k) + "]"};
    }
    residual.segment<2>(2 * k) = -view_residual;
    jacobian.block<2, 6>(2 * k, 6 * base) = base_block;
    jacobian.block<2, 6>(2 * k, 6 * k) = view_block;
    jacobian_rho.segment<2>(2 * k) = landmark_block.col(2);
  }
  ToErrorCoordinates(views, convention, &jacobian);

  Json answer;
  answer["residual"] = VectorToJson(residual);
  answer["H_X"] = ToJson(jacobian);
  answer["H_rho"] = VectorToJson(jacobian_rho);
  return answer;
}

}  // namespace alidade::probe
