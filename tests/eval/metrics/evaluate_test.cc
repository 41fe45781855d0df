#include "eval/metrics/evaluate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "eval/metrics/evaluate_format.h"
#include "tests/eval/trajectory/synthetic_trajectory.h"

namespace alidade {
namespace {

using test::MakeTrajectory;
using testing::HasSubstr;
using testing::Not;

/// An estimate turned by 90 degrees of yaw, shifted, and 1 % too long.
Trajectory ScaledEstimate(bool with_covariance) {
  Trajectory estimate = MakeTrajectory(300);
  const Eigen::Matrix3d yaw = so3::Exp({0, 0, -M_PI / 2});
  for (TrajectoryPoint& point : estimate.points) {
    point.nav.p_WB = (1.01 * (yaw * point.nav.p_WB) + Eigen::Vector3d(1, 2, 3)).eval();
    point.nav.R_WB = (yaw * point.nav.R_WB).eval();
    point.covariance = Matrix6d::Identity();
  }
  estimate.has_covariance = with_covariance;
  return estimate;
}

Evaluation EvaluateScaled(TrajectoryAlignment alignment, bool with_covariance) {
  EvaluationOptions options;
  options.alignment = alignment;
  options.rpe_distances_m = {2, 5000};
  const Result<Evaluation> evaluation =
      Evaluate(MakeTrajectory(400), ScaledEstimate(with_covariance), options);
  EXPECT_TRUE(evaluation.ok()) << evaluation.message();
  return *evaluation;
}

TEST(Evaluate, UndoesTheSimilarityAndReportsItsScale) {
  const Evaluation evaluation = EvaluateScaled(TrajectoryAlignment::kSim3, true);
  EXPECT_EQ(evaluation.pairs.size(), 300u);
  EXPECT_EQ(evaluation.truth_rows, 400u);
  EXPECT_NEAR(evaluation.duration_s, 29.9, 1e-9);
  EXPECT_NEAR(evaluation.transform.scale, 1 / 1.01, 1e-9);
  EXPECT_LT(evaluation.ate.pos_m, 1e-9);
  EXPECT_LT(evaluation.rpe[0].pos_rmse_m, 1e-9);
  EXPECT_GT(evaluation.unaligned.pos_m, 3);
  EXPECT_NEAR(evaluation.unaligned.ori_deg, 90, 1e-6);
}

TEST(Evaluate, LeavesAScaleErrorInARigidAlignment) {
  const Evaluation evaluation = EvaluateScaled(TrajectoryAlignment::kPosYaw, false);
  EXPECT_NEAR(evaluation.rpe[0].pos_rmse_m, 0.02, 1.5e-3);  // below 1 % of 2 m where the path bends
  EXPECT_LT(evaluation.ate.ori_deg, 1e-5);
  EXPECT_FALSE(evaluation.nees.has_value());
}

// GIVEN an estimate with covariances of velocity and biases WHEN the truth holds none of them THEN there is
// no NEES of them, and with a truth that does the anchor turns the velocity and its covariance.
TEST(Evaluate, EvaluatesVelocityAndBiasesOnlyWhereTheTruthHoldsThem) {
  Trajectory truth = MakeTrajectory(300);
  const Eigen::Matrix3d yaw = so3::Exp({0, 0, -M_PI / 2});
  for (TrajectoryPoint& point : truth.points) {
    point.nav.v_WB << 1, 0, 0;
  }
  Trajectory estimate = truth;
  for (TrajectoryPoint& point : estimate.points) {
    point.nav.p_WB = (yaw * point.nav.p_WB).eval();
    point.nav.R_WB = (yaw * point.nav.R_WB).eval();
    point.nav.v_WB = yaw * Eigen::Vector3d(1.2, 0, 0);
    point.covariance = Matrix6d::Identity();
    point.motion_covariance.velocity.diagonal() << 1, 0.01, 1;  // along the turned velocity
    point.motion_covariance.gyro_bias.setIdentity();
    point.motion_covariance.accel_bias.setIdentity();
    point.bias.accel << 0, 0, 2;
  }
  estimate.has_covariance = true;
  EvaluationOptions options;
  options.anchor_at_first = true;
  truth.has_velocity = truth.has_bias = false;
  const Evaluation without = *Evaluate(truth, estimate, options);
  EXPECT_TRUE(std::isnan(without.nees->mean_velocity));
  EXPECT_TRUE(std::isnan(without.nees->mean_gyro_bias));
  EXPECT_TRUE(std::isnan(without.nees->mean_accel_bias));
  truth.has_velocity = truth.has_bias = true;
  const Evaluation with = *Evaluate(truth, estimate, options);
  EXPECT_NEAR(with.nees->mean_velocity, 0.04 / 0.01, 1e-9);
  EXPECT_EQ(with.nees->mean_gyro_bias, 0);
  EXPECT_NEAR(with.nees->mean_accel_bias, 4, 1e-9);
}

TEST(Evaluate, EvaluatesConsistencyUnaligned) {
  const Evaluation evaluation = EvaluateScaled(TrajectoryAlignment::kSim3, true);
  ASSERT_TRUE(evaluation.nees.has_value());
  EXPECT_NEAR(evaluation.nees->mean_orientation, M_PI * M_PI / 4, 1e-6);
}

// GIVEN an estimate in a world of its own, 1 % too long WHEN it is anchored at its first pose THEN yaw and
// offset are gone from RMSE and NEES, and what grows along the path stays.
TEST(Evaluate, AnchorsAnEstimateOfItsOwnWorldAtItsFirstPose) {
  EvaluationOptions options;
  options.anchor_at_first = true;
  const Result<Evaluation> evaluation = Evaluate(MakeTrajectory(400), ScaledEstimate(true), options);
  ASSERT_TRUE(evaluation.ok()) << evaluation.message();
  const StatePair& first = evaluation->pairs.front();
  EXPECT_LT((first.estimate.nav.p_WB - first.truth.nav.p_WB).norm(), 1e-12);
  EXPECT_LT(evaluation->unaligned.ori_deg, 1e-5);
  EXPECT_LT(evaluation->nees->mean_orientation, 1e-12);
  double expected = 0;
  for (const StatePair& pair : evaluation->pairs) {
    expected += 1e-4 * (pair.truth.nav.p_WB - first.truth.nav.p_WB).squaredNorm();
  }
  EXPECT_NEAR(evaluation->unaligned.pos_m, std::sqrt(expected / 300), 1e-9);
  EXPECT_EQ(RemarkOnWorld(*evaluation), "");
}

// GIVEN an estimate whose first pose is far outside its deviations WHEN yaw and offset explain it THEN the
// evaluation says that the estimate has a world of its own; WHEN a tilt does, or the deviations are large,
// it does not.
TEST(Evaluate, TellsAnEstimateOfItsOwnWorld) {
  const auto remark = [](const Eigen::Vector3d& turn, double deviation) {
    Trajectory truth = MakeTrajectory(400);
    Trajectory estimate = truth;
    for (TrajectoryPoint& point : estimate.points) {
      point.nav.R_WB = (so3::Exp(turn) * point.nav.R_WB).eval();
      point.nav.p_WB += Eigen::Vector3d(0, 2, 0);
      point.covariance = deviation * deviation * Matrix6d::Identity();
    }
    estimate.has_covariance = true;
    const Evaluation evaluation = *Evaluate(truth, estimate, {});
    const std::string text = RemarkOnWorld(evaluation);
    const nlohmann::json json = nlohmann::json::parse(FormatEvaluationJson(evaluation));
    EXPECT_EQ(json.value("remark", ""), text);
    EXPECT_THAT(FormatEvaluationText(evaluation), HasSubstr(text));
    return text;
  };
  EXPECT_EQ(
      remark({0, 0, 0.5}, 0.01),
      "begins 2 m and 28.6 deg of yaw from the truth: RMSE, NEES and silent failures need anchor_at_first");
  EXPECT_EQ(remark({0, 0, 0.5}, 0.1), "");
  EXPECT_EQ(remark({2, 0, 0}, 0.01), "");
}

TEST(Evaluate, PassesTheAssociationErrorOn) {
  const Result<Evaluation> evaluation = Evaluate(MakeTrajectory(400), MakeTrajectory(5, 0, 1), {});
  EXPECT_EQ(evaluation.code(), StatusCode::kInput);
}

// GIVEN an estimate that drifts and is turned, THEN an alignment of its first twentieth leaves the drift.
TEST(Evaluate, AlignsByTheFirstShare) {
  Trajectory truth, estimate;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.1 * i;
    TrajectoryPoint point;
    point.stamp_ns = i * 100'000'000LL;
    point.nav.p_WB = Eigen::Vector3d(10 * std::sin(t), 10 * std::cos(t), 0);
    truth.points.push_back(point);
    point.nav.p_WB = turn * (point.nav.p_WB + Eigen::Vector3d(5 + (i < 50 ? 0 : 1), 6, 7));
    estimate.points.push_back(point);
  }
  EvaluationOptions options;
  options.align_share = 0.05;
  EXPECT_NEAR(Evaluate(truth, estimate, options)->ate.pos_m, std::sqrt(0.95), 1e-6);
  options.align_share = 1;
  EXPECT_NEAR(Evaluate(truth, estimate, options)->ate.pos_m, std::sqrt(0.05 * 0.95), 1e-2);
}

TEST(FormatEvaluation, GivenAToolsRelativeErrorThenTextAndJsonNameIt) {
  EvaluationOptions options;
  options.tool_rpe = {.method = EvaluationTool::kEvo, .deltas = {2}, .unit = RpeUnit::kMetres};
  const Result<Evaluation> evaluation = Evaluate(MakeTrajectory(400), ScaledEstimate(true), options);
  ASSERT_TRUE(evaluation.ok()) << evaluation.message();
  const nlohmann::json json = nlohmann::json::parse(FormatEvaluationJson(*evaluation));
  EXPECT_TRUE(json["rpe"].empty());
  EXPECT_EQ(json["rpe_by_tool"]["tool"], "evo");
  EXPECT_EQ(json["rpe_by_tool"]["unit"], "m");
  const nlohmann::json& delta = json["rpe_by_tool"]["deltas"][0];
  EXPECT_GT(delta["count"], 5);
  EXPECT_NEAR(delta["trans_part"]["rmse"].get<double>(), 0.02, 2e-3);  // 1 % of 2 m
  EXPECT_THAT(FormatEvaluationText(*evaluation),
              HasSubstr("relative error by evo over 2 m: " + std::to_string(evaluation->tool_rpe[0].count) +
                        " pairs (consecutive, along the estimate)"));
}

TEST(FormatEvaluation, JsonReadsBackWithFixedKeysAndRoundedNumbers) {
  const Evaluation evaluation = EvaluateScaled(TrajectoryAlignment::kSim3, true);
  const std::string text = FormatEvaluationJson(evaluation);
  const nlohmann::ordered_json json = nlohmann::ordered_json::parse(text);
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) {
    keys.push_back(key);
  }
  EXPECT_EQ(keys,
            (std::vector<std::string>{"pairs", "truth_rows", "estimate_rows", "association", "duration_s",
                                      "path_m", "anchor_at_first", "align_share", "alignment", "unaligned",
                                      "ate", "ate_statistics", "rpe", "nees"}));
  EXPECT_EQ(json["association"]["rule"], "alidade");
  EXPECT_EQ(json["ate_statistics"]["pos_m"]["rmse"], json["ate"]["pos_rmse_m"]);
  EXPECT_EQ(json["pairs"], 300);
  EXPECT_EQ(json["alignment"]["name"], "sim3");
  EXPECT_EQ(json["alignment"]["scale"].get<double>(), 0.99009901);
  EXPECT_EQ(json["alignment"]["q_wxyz"].size(), 4u);
  EXPECT_EQ(json["alignment"]["translation_m"].size(), 3u);
  EXPECT_NEAR(json["unaligned"]["ori_rmse_deg"].get<double>(), 90, 1e-6);
  EXPECT_NEAR(json["nees"]["orientation"]["mean"].get<double>(), M_PI * M_PI / 4, 1e-6);
  EXPECT_EQ(json["nees"]["pose"]["band_95"].size(), 2u);
  EXPECT_GT(json["rpe"][0]["count"], 100);
  EXPECT_EQ(json["rpe"][1]["count"], 0);
  EXPECT_TRUE(json["rpe"][1]["pos_rmse_m"].is_null());
  EXPECT_EQ(text, FormatEvaluationJson(EvaluateScaled(TrajectoryAlignment::kSim3, true)));
  EXPECT_TRUE(
      nlohmann::json::parse(FormatEvaluationJson(EvaluateScaled(TrajectoryAlignment::kPos, false)))["nees"]
          .is_null());
}

TEST(FormatEvaluation, TextHoldsTheFiguresAndTheirUnits) {
  const std::string text = FormatEvaluationText(EvaluateScaled(TrajectoryAlignment::kSim3, true));
  EXPECT_THAT(text, HasSubstr("pairs      300 of 300 estimate and 400 truth rows (nearest within 0.01 s)"));
  EXPECT_THAT(text, HasSubstr("scale      0.990099"));
  EXPECT_THAT(text, HasSubstr("aligned (sim3)"));
  EXPECT_THAT(text, HasSubstr("5000 m"));
  EXPECT_THAT(text, HasSubstr("NEES (unaligned)"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
  EXPECT_THAT(FormatEvaluationText(EvaluateScaled(TrajectoryAlignment::kPos, false)), Not(HasSubstr("NEES")));
}

}  // namespace
}  // namespace alidade
