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

/// The 2N-3 unit-noise rows [jacobian | residual] of a track whose landmark has been eliminated.
void RowsWithoutLandmark(const std::vector<Pose>& views, const std::vector<Eigen::Vector2d>& z,
                         const Eigen::Vector3d& p_W, Eigen::MatrixXd* jacobian, Eigen::VectorXd* residual) {
  std::vector<NormalizedObservation> observations(z.size());
  for (size_t i = 0; i < z.size(); ++i) {
    observations[i].z = z[i];
  }
  TrackLinearization linearization;
  if (!LinearizeTrack(views, observations, p_W, &linearization)) {
    throw CaseError{"landmark lies behind a view"};
  }
  EliminateLandmark(linearization.point_jacobian, *jacobian, *residual);
  const Eigen::Index rows = residual->size() - kLandmarkRows;
  *jacobian = jacobian->bottomRows(rows).eval();
  *residual = residual->tail(rows).eval();
}

}  // namespace

Json PoseOnlyAnswer(const Json& input, ErrorConvention convention) {
  const std::vector<Pose> views = Views(input);
  const std::vector<Eigen::Vector2d> z = Observations(input, views.size());
  const PoseOnlyModel model{Index(Member(input, "base"), "base", static_cast<int>(views.size())),
                            PairOf(input)};
  if (model.views == DepthViews::kTwo && model.base + 1 == static_cast<int>(views.size())) {
    throw CaseError{"base: the last view cannot be the base of a two-view depth"};
  }
  PoseOnlyDepth depth;
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian, noise_jacobian;
  if (!model.Evaluate(views, z, &depth, &residual, &jacobian, &noise_jacobian)) {
    throw CaseError{"no parallax between the views, or the landmark lies behind one of them"};
  }
  ToErrorCoordinates(views, convention, &jacobian);
  const Eigen::VectorXd observed_minus_predicted = -residual;
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(residual.size(), residual.size());

  Eigen::MatrixXd pose_rows = jacobian;
  Eigen::VectorXd pose_residual = observed_minus_predicted;
  RowsWithoutLandmark(views, z, depth.p_W, &pose_rows, &pose_residual);

  Json answer;
  answer["depth"] = depth.depth;
  answer["p_f"] = VectorToJson(depth.p_W);
  answer["residual"] = VectorToJson(observed_minus_predicted);
  answer["H_X"] = ToJson(jacobian);
  answer["H_n"] = ToJson(identity - noise_jacobian);
  answer["information"] = ToJson(pose_rows.transpose() * pose_rows);
  answer["gradient"] = VectorToJson(pose_rows.transpose() * pose_residual);
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

  // The base observes its own bearing exactly: its two rows stay zero.
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(rows);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, 3 * rows);
  Eigen::VectorXd jacobian_rho = Eigen::VectorXd::Zero(rows);
  for (int k = 0; k < static_cast<int>(views.size()); ++k) {
    if (k == base) {
      continue;
    }
    const InverseDepthModel model{z[static_cast<size_t>(base)], z[static_cast<size_t>(k)]};
    Eigen::Vector2d view_residual, view_rho;
    InverseDepthModel::PoseJacobian base_block, view_block;
    if (!model.Evaluate(views[static_cast<size_t>(base)], views[static_cast<size_t>(k)], inverse_depth,
                        &view_residual, &base_block, &view_block, &view_rho)) {
      throw CaseError{"landmark lies behind views[" + std::to_string(k) + "]"};
    }
    residual.segment<2>(2 * k) = -view_residual;
    jacobian.block<2, 6>(2 * k, 6 * base) = base_block;
    jacobian.block<2, 6>(2 * k, 6 * k) = view_block;
    jacobian_rho.segment<2>(2 * k) = view_rho;
  }
  ToErrorCoordinates(views, convention, &jacobian);

  Json answer;
  answer["residual"] = VectorToJson(residual);
  answer["H_X"] = ToJson(jacobian);
  answer["H_rho"] = VectorToJson(jacobian_rho);
  return answer;
}

}  // namespace alidade::probe
