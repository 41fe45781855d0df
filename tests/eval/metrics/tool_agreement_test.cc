// Figures of evo, rpg_trajectory_evaluation and ov_eval for trajectories made from a formula, to the digits
// that the tools print.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "eval/metrics/evaluate.h"
#include "tests/eval/metrics/formula_trajectories.h"

namespace alidade {
namespace {

using test::FormulaPair;

/// Rows of a table of figures: words up to the numbers, which are the last `numbers` of a row.
struct FigureRow {
  std::vector<std::string> words;
  std::vector<double> numbers;
  std::string text;
};

std::vector<FigureRow> ReadFigures(const std::string& file, const std::string& kind, std::size_t numbers) {
  std::ifstream table(ALIDADE_SOURCE_DIR "/tests/eval/metrics/" + file);
  std::vector<FigureRow> rows;
  for (std::string line; std::getline(table, line);) {
    std::istringstream stream(line);
    std::vector<std::string> words{std::istream_iterator<std::string>(stream), {}};
    if (words.size() > numbers && words[0] == kind) {
      FigureRow row{{}, {}, line};
      for (std::size_t i = words.size() - numbers; i < words.size(); ++i) {
        row.numbers.push_back(std::stod(words[i]));
      }
      words.resize(words.size() - numbers);
      row.words = words;
      rows.push_back(row);
    }
  }
  EXPECT_GT(rows.size(), 10U) << file;
  return rows;
}

/// To half of the last printed digit of evo; to nine digits of rpg_trajectory_evaluation, which prints all.
void ExpectFigures(const ErrorStatistics& ours, const FigureRow& row, double absolute, double relative) {
  const double values[] = {ours.rmse, ours.mean, ours.median, ours.std, ours.min, ours.max, ours.sse};
  const char* names[] = {"rmse", "mean", "median", "std", "min", "max", "sse"};
  for (std::size_t i = 0; i < row.numbers.size(); ++i) {
    EXPECT_NEAR(values[i], row.numbers[i], absolute + relative * std::abs(row.numbers[i]))
        << names[i] << " of " << row.text;
  }
}

void ExpectAsEvo(const ErrorStatistics& ours, const FigureRow& row) {
  ExpectFigures(ours, row, 0.51e-6, 0);
}

void ExpectAsRpg(const ErrorStatistics& ours, const FigureRow& row) {
  ExpectFigures(ours, row, 1e-10, 1e-9);
}

double EvoMaxDt(const std::string& name) {
  return name == "camera" ? 0.01 : name == "crowded" ? 0.04 : 0.02;
}

Evaluation EvaluateAs(const std::string& name, TrajectoryAlignment alignment,
                      const AssociationOptions& association, const ToolRpeOptions& rpe = {}) {
  const test::TrajectoryPair pair = FormulaPair(name);
  EvaluationOptions options;
  options.alignment = alignment;
  options.association = association;
  options.tool_rpe = rpe;
  Result<Evaluation> evaluation = Evaluate(pair.truth, pair.estimate, options);
  EXPECT_TRUE(evaluation.ok()) << evaluation.message();
  return evaluation.ok() ? *std::move(evaluation) : Evaluation();
}

AssociationOptions AsEvo(const std::string& name, double offset_s = 0) {
  return {.method = EvaluationTool::kEvo, .max_dt_s = EvoMaxDt(name), .time_offset_s = offset_s};
}

AssociationOptions AsRpg() {
  return {.method = EvaluationTool::kRpg, .max_dt_s = DefaultMaxDt(EvaluationTool::kRpg)};
}

ErrorStatistics Find(const ToolRpeResult& result, const std::string& relation) {
  for (const RelationError& entry : result.relations) {
    if (entry.name == relation) {
      return entry.statistics;
    }
  }
  ADD_FAILURE() << "no relation " << relation;
  return {};
}

// Words: kind, trajectories, alignment, offset, relation, pairs.
TEST(EvoAgreement, AbsoluteErrors) {
  for (const FigureRow& row : ReadFigures("evo_figures.txt", "ape", 7)) {
    const Evaluation evaluation = EvaluateAs(row.words[1], *ParseTrajectoryAlignment(row.words[2]),
                                             AsEvo(row.words[1], std::stod(row.words[3])));
    EXPECT_EQ(evaluation.pairs.size(), std::stoul(row.words[5])) << row.text;
    ExpectAsEvo(row.words[4] == "angle_deg" ? evaluation.ate_ori_deg : evaluation.ate_pos_m, row);
    EXPECT_DOUBLE_EQ(evaluation.ate.pos_m, evaluation.ate_pos_m.rmse);
    EXPECT_DOUBLE_EQ(evaluation.ate.ori_deg, evaluation.ate_ori_deg.rmse);
  }
}

// Words: kind, trajectories, alignment, delta, unit, pairs, along, tolerance, relation, count.
TEST(EvoAgreement, RelativeErrors) {
  for (const FigureRow& row : ReadFigures("evo_figures.txt", "rpe", 7)) {
    const ToolRpeOptions options{.method = EvaluationTool::kEvo,
                                 .deltas = {std::stod(row.words[3])},
                                 .unit = *ParseRpeUnit(row.words[4]),
                                 .all_pairs = row.words[5] == "all",
                                 .pairs_from_truth = row.words[6] == "truth",
                                 .tolerance = std::stod(row.words[7])};
    const Evaluation evaluation =
        EvaluateAs(row.words[1], *ParseTrajectoryAlignment(row.words[2]), AsEvo(row.words[1]), options);
    ASSERT_EQ(evaluation.tool_rpe.size(), 1U);
    EXPECT_EQ(evaluation.tool_rpe[0].count, std::stoul(row.words[9])) << row.text;
    ExpectAsEvo(Find(evaluation.tool_rpe[0], row.words[8]), row);
    EXPECT_TRUE(evaluation.rpe.empty());
  }
}

// Words: kind, trajectories, alignment, error, pairs.
TEST(RpgAgreement, AbsoluteErrors) {
  for (const FigureRow& row : ReadFigures("rpg_figures.txt", "abs", 6)) {
    const Evaluation evaluation = EvaluateAs(row.words[1], *ParseTrajectoryAlignment(row.words[2]), AsRpg());
    EXPECT_EQ(evaluation.pairs.size(), std::stoul(row.words[4])) << row.text;
    ExpectAsRpg(row.words[3] == "rot" ? evaluation.ate_ori_deg : evaluation.ate_pos_m, row);
  }
}

// Words: kind, trajectories, alignment, length, error, count.
TEST(RpgAgreement, RelativeErrors) {
  for (const FigureRow& row : ReadFigures("rpg_figures.txt", "rel", 6)) {
    const Evaluation evaluation =
        EvaluateAs(row.words[1], *ParseTrajectoryAlignment(row.words[2]), AsRpg(),
                   {.method = EvaluationTool::kRpg, .deltas = {std::stod(row.words[3])}});
    ASSERT_EQ(evaluation.tool_rpe.size(), 1U);
    EXPECT_EQ(evaluation.tool_rpe[0].count, std::stoul(row.words[5])) << row.text;
    ExpectAsRpg(Find(evaluation.tool_rpe[0], row.words[4]), row);
  }
}

// error_singlerun of ov_eval (OpenVINS 6948812) prints three decimals; posyaw is its alignment too.
TEST(OvEvalAgreement, AbsoluteErrors) {
  struct Row {
    const char* name;
    TrajectoryAlignment alignment;
    double pos_rmse, pos_mean, pos_max, ori_rmse, ori_mean, ori_max;
  };
  constexpr Row kRows[] = {
      {"camera", TrajectoryAlignment::kNone, 4.149, 3.797, 6.845, 40.140, 40.133, 41.515},
      {"camera", TrajectoryAlignment::kPosYaw, 0.142, 0.133, 0.265, 1.156, 1.103, 1.812},
      {"camera", TrajectoryAlignment::kSe3, 0.139, 0.130, 0.254, 1.044, 1.004, 1.699},
      {"camera", TrajectoryAlignment::kSim3, 0.083, 0.077, 0.164, 1.044, 1.004, 1.699},
  };
  for (const Row& row : kRows) {
    SCOPED_TRACE(std::string(ToString(row.alignment)));
    const Evaluation evaluation = EvaluateAs(row.name, row.alignment, AsRpg());
    EXPECT_NEAR(evaluation.ate_pos_m.rmse, row.pos_rmse, 0.51e-3);
    EXPECT_NEAR(evaluation.ate_pos_m.mean, row.pos_mean, 0.51e-3);
    EXPECT_NEAR(evaluation.ate_pos_m.max, row.pos_max, 0.51e-3);
    EXPECT_NEAR(evaluation.ate_ori_deg.rmse, row.ori_rmse, 0.51e-3);
    EXPECT_NEAR(evaluation.ate_ori_deg.mean, row.ori_mean, 0.51e-3);
    EXPECT_NEAR(evaluation.ate_ori_deg.max, row.ori_max, 0.51e-3);
  }
}

// GIVEN more estimates than truth rows in their span WHEN paired by the three rules THEN evo uses truth rows
// several times, rpg and ours each once.
TEST(ToolAssociation, RulesDifferWhereEstimatesCompeteForARow) {
  const test::TrajectoryPair pair = FormulaPair("crowded");
  std::map<EvaluationTool, std::size_t> most_shared, pairs;
  for (const EvaluationTool method : {EvaluationTool::kAlidade, EvaluationTool::kEvo, EvaluationTool::kRpg}) {
    const auto matched = Associate(pair.truth, pair.estimate, {.method = method, .max_dt_s = 0.04});
    ASSERT_TRUE(matched.ok()) << matched.message();
    pairs[method] = matched->size();
    std::map<TimeNs, std::size_t> uses;
    for (const StatePair& entry : *matched) {
      most_shared[method] = std::max(most_shared[method], ++uses[entry.truth.stamp_ns]);
    }
  }
  EXPECT_GT(most_shared[EvaluationTool::kEvo], 1U);
  EXPECT_EQ(most_shared[EvaluationTool::kRpg], 1U);
  EXPECT_EQ(most_shared[EvaluationTool::kAlidade], 1U);
  EXPECT_GT(pairs[EvaluationTool::kEvo], pairs[EvaluationTool::kRpg]);
}

TEST(ToolRpe, GivenAnImpossibleRequestThenItIsRefused) {
  const test::TrajectoryPair pair = FormulaPair("crowded");
  const auto message = [&](const EvaluationOptions& options, bool oriented = true) {
    Trajectory estimate = pair.estimate;
    estimate.has_orientation = oriented;
    return std::string(Evaluate(pair.truth, estimate, options).message());
  };
  EvaluationOptions options;
  options.association.max_dt_s = 0.04;
  options.tool_rpe = {.method = EvaluationTool::kEvo, .deltas = {1.5}};
  EXPECT_THAT(message(options), testing::HasSubstr("a whole number of frames"));
  options.tool_rpe = {.method = EvaluationTool::kEvo, .deltas = {181}, .unit = RpeUnit::kDegrees};
  EXPECT_THAT(message(options), testing::HasSubstr("at most 180"));
  options.tool_rpe = {.method = EvaluationTool::kRpg, .deltas = {}};
  EXPECT_THAT(message(options, false), testing::HasSubstr("need orientations"));
  options = {};
  options.association = {.method = EvaluationTool::kEvo, .interpolate = true};
  EXPECT_THAT(message(options), testing::HasSubstr("only association alidade interpolates"));
}

TEST(ToolRpe, GivenNoDeltasThenTheyAreTheToolsOwn) {
  const Evaluation evo = EvaluateAs("camera", TrajectoryAlignment::kNone, AsEvo("camera"),
                                    {.method = EvaluationTool::kEvo, .deltas = {}});
  ASSERT_EQ(evo.tool_rpe.size(), 1U);
  EXPECT_EQ(evo.tool_rpe[0].count, 969U);
  const Evaluation rpg = EvaluateAs("camera", TrajectoryAlignment::kSe3, AsRpg(),
                                    {.method = EvaluationTool::kRpg, .deltas = {}});
  ASSERT_EQ(rpg.tool_rpe.size(), 5U);
  EXPECT_DOUBLE_EQ(rpg.tool_rpe[1].delta, DefaultRpgLengths(FormulaPair("camera").truth)[1]);
}

TEST(ErrorStatistics, GivenKnownNumbersThenTheyAreThoseOfTheBook) {
  const ErrorStatistics even = ComputeErrorStatistics({4, 1, 3, 2});
  EXPECT_DOUBLE_EQ(even.median, 2.5);
  EXPECT_DOUBLE_EQ(even.std, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(even.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(even.sse, 30);
  EXPECT_DOUBLE_EQ(ComputeErrorStatistics({5, 1, 2}).median, 2);
  EXPECT_TRUE(std::isnan(ComputeErrorStatistics({}).rmse));
}

}  // namespace
}  // namespace alidade
