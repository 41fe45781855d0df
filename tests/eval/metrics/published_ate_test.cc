#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "eval/metrics/evaluate.h"
#include "eval/trajectory/trajectory_reader.h"
#include "tests/support/shared_data.h"

namespace alidade {
namespace {

Result<Evaluation> EvaluateXivo(const std::string& room) {
  const std::string folder = test::SharedDir() + "/data/tumvi/" + room + "/estimates/";
  const Result<Trajectory> truth = ReadTrajectory(folder + "xivo_gt.tum");
  const Result<Trajectory> estimate = ReadTrajectory(folder + "xivo_estimate.tum");
  if (!truth.ok() || !estimate.ok()) {
    return truth.ok() ? estimate.status() : truth.status();
  }
  EvaluationOptions options;
  options.alignment = TrajectoryAlignment::kSe3;
  options.association.max_dt_s = 1e-3;
  return Evaluate(*truth, *estimate, options);
}

/// Published by XIVO for TUM VI: position ATE rmse after SE(3) alignment of the pairs within 1 ms. Two pairs
/// of room1 are exactly 1 ms apart; one of them counts, as doubles of seconds round.
struct PublishedFigure {
  const char* room;
  double ate_m;
  std::size_t pairs;
};

class PublishedAte : public testing::TestWithParam<PublishedFigure> {};

TEST_P(PublishedAte, IsReproducedToItsPrintedDigits) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const Result<Evaluation> evaluation = EvaluateXivo(GetParam().room);
  ASSERT_TRUE(evaluation.ok()) << evaluation.message();
  EXPECT_EQ(evaluation->pairs.size(), GetParam().pairs);
  EXPECT_EQ(std::round(evaluation->ate.pos_m * 1e6), std::round(GetParam().ate_m * 1e6))
      << evaluation->ate.pos_m;
}

INSTANTIATE_TEST_SUITE_P(XivoOnTumVi, PublishedAte,
                         testing::Values(PublishedFigure{"room1", 0.121047, 720},
                                         PublishedFigure{"room3", 0.130106, 555},
                                         PublishedFigure{"room5", 0.086079, 518}),
                         [](const auto& test) { return std::string(test.param.room); });

}  // namespace
}  // namespace alidade
