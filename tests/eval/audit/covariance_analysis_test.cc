#include "eval/audit/covariance_analysis.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/QR>

#include "core/random.h"
#include "eval/study/reuse_study.h"
#include "filter/filter.h"
#include "filter/filter_state.h"
#include "tests/support/scenario.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

NavEstimate UnitPrior() {
  NavEstimate start;
  start.covariance.setIdentity();
  return start;
}

MatrixXd RandomMatrix(Index rows, Index columns, RandomStream* random) {
  return MatrixXd::NullaryExpr(rows, columns, [random] { return random->Normal(); });
}

/// Two rounds of one track over the core alone: views (1, 2), then the base 1 again with 3.
struct TwoRounds {
  FilterRows first;
  FilterRows second;
};

TwoRounds MakeTwoRounds(bool base_again) {
  RandomStream random(3, "two rounds");
  TwoRounds rounds;
  // Rows of a filter have orthonormal noise; the base contributes to both.
  const MatrixXd basis = Eigen::HouseholderQR<MatrixXd>(RandomMatrix(4, 4, &random)).householderQ();
  for (FilterRows* rows : {&rounds.first, &rounds.second}) {
    rows->jacobian = RandomMatrix(3, 15, &random);
    rows->innovation = VectorXd::Zero(3);
    rows->blocks = {{0, 3, 7, {1, 2}, basis.topRows(3)}};
  }
  // The second round looks much the way the first did, as rounds of one track do.
  rounds.second.jacobian = (rounds.first.jacobian + 0.3 * rounds.second.jacobian).eval();
  rounds.second.blocks[0].serials = {base_again ? 1 : 4, 3};
  return rounds;
}

/// Applies both rounds to a state under the analysis.
CovarianceAnalysis Analyze(const TwoRounds& rounds, FilterState* state) {
  CovarianceAnalysis analysis;
  state->SetObserver(&analysis);
  EXPECT_TRUE(state->Reset(UnitPrior()).ok());
  for (const FilterRows* rows : {&rounds.first, &rounds.second}) {
    analysis.OnUpdate(*state, *rows);
    FilterRows copy = *rows;
    VectorXd correction(state->covariance().dimension());
    const PreparedRows prepared = state->covariance().Prepare(copy.jacobian, copy.innovation);
    EXPECT_TRUE(state->covariance().Apply(prepared, correction, nullptr));
  }
  return analysis;
}

/// The same by sampling: errors and observation noise drawn, the filter's gains applied.
MatrixXd Sampled(const TwoRounds& rounds, bool base_again, int samples) {
  RandomStream random(11, "samples");
  MatrixXd p = MatrixXd::Identity(15, 15);
  std::vector<MatrixXd> gains;
  for (const FilterRows* rows : {&rounds.first, &rounds.second}) {
    const MatrixXd& h = rows->jacobian;
    const MatrixXd innovation = h * p * h.transpose() + MatrixXd::Identity(3, 3);
    gains.push_back(p * h.transpose() * innovation.inverse());
    p = (p - gains.back() * h * p).eval();
  }
  MatrixXd sum = MatrixXd::Zero(15, 15);
  for (int i = 0; i < samples; ++i) {
    VectorXd error = RandomMatrix(15, 1, &random);
    const VectorXd first = RandomMatrix(4, 1, &random);
    VectorXd second = RandomMatrix(4, 1, &random);
    if (base_again) {
      second.head<2>() = first.head<2>();
    }
    error -= gains[0] * (rounds.first.jacobian * error + rounds.first.blocks[0].noise * first);
    error -= gains[1] * (rounds.second.jacobian * error + rounds.second.blocks[0].noise * second);
    sum += error * error.transpose();
  }
  return sum / samples;
}

TEST(CovarianceAnalysisTest, AgreesWithSamplesOfAReusedBaseWhereTheFilterDoesNot) {
  const TwoRounds rounds = MakeTwoRounds(true);
  FilterState state(ErrorConvention::kRightInvariant, false, Pose(), {2, 0});
  const CovarianceAnalysis analysis = Analyze(rounds, &state);
  const MatrixXd sampled = Sampled(rounds, true, 200000);
  const MatrixXd believed = state.covariance().Covariance();
  EXPECT_LT((analysis.actual() - sampled).norm(), 0.01 * sampled.norm());
  EXPECT_GT((believed - sampled).norm(), 0.05 * sampled.norm());
  EXPECT_EQ(analysis.unmodelled_reuse(), 0);
}

TEST(CovarianceAnalysisTest, IsTheFiltersOwnCovarianceWhenNothingServesTwice) {
  FilterState state(ErrorConvention::kRightInvariant, false, Pose(), {2, 0});
  const CovarianceAnalysis analysis = Analyze(MakeTwoRounds(false), &state);
  const MatrixXd believed = state.covariance().Covariance();
  EXPECT_LT((analysis.actual() - believed).norm(), 1e-12 * believed.norm());
}

TEST(CovarianceAnalysisTest, CountsTheReuseItDoesNotModel) {
  TwoRounds rounds = MakeTwoRounds(true);
  rounds.second.blocks[0].serials = {1, 2};  // the second view was no base
  FilterState state(ErrorConvention::kRightInvariant, false, Pose(), {2, 0});
  EXPECT_EQ(Analyze(rounds, &state).unmodelled_reuse(), 1);
}

/// A window of 12 on a short figure-8.
ReusePrediction Predict(const std::string& policy) {
  SimulatorConfig simulation;
  simulation.duration_s = 10;
  simulation.path_m = 13;
  simulation.max_features = 60;
  for (const ReusePolicy& each : ReusePolicies()) {
    if (each.name == policy) {
      const Result<ReusePrediction> prediction =
          PredictConsistency(simulation, EstimatorConfig(), each, 12, 1);
      EXPECT_TRUE(prediction.ok()) << prediction.message();
      return prediction.ok() ? *prediction : ReusePrediction();
    }
  }
  ADD_FAILURE() << policy;
  return {};
}

TEST(ReuseStudyTest, JointAndDisjointSetsAreConsistentAndReuseIsNot) {
  const ReusePrediction joint = Predict("joint");
  const ReusePrediction disjoint = Predict("disjoint");
  const ReusePrediction reuse = Predict("reuse");
  const ReusePrediction inflate = Predict("inflate");
  EXPECT_NEAR(joint.nees_ratio, 1, 1e-6);
  EXPECT_NEAR(disjoint.nees_ratio, 1, 1e-6);
  EXPECT_GT(reuse.nees_ratio, 1.5);
  EXPECT_GT(inflate.nees_ratio, 1);
  EXPECT_LT(inflate.nees_ratio, 1.3);
  EXPECT_LT(joint.position_m, inflate.position_m) << "each observation once, with all others, is the best";
  EXPECT_LT(inflate.position_m, disjoint.position_m) << "the base's second service is worth something";
}

TEST(ReuseStudyTest, PredictsTheNeesThatSeedsMeasure) {
  SimulatorConfig sim;
  sim.duration_s = 20;
  sim.path_m = 26;
  EstimatorConfig config;
  config.filter.base_reuse = BaseReuse::kPaper;
  config.init.method = InitMethod::kTruth;
  config.vision.max_relative_depth_deviation = 0.02;  // poorer depths add inconsistency of their own
  const auto predicted = PredictConsistency(sim, config, ReusePolicies()[2], config.filter.window, 1);
  ASSERT_TRUE(predicted.ok()) << predicted.message();
  double nees = 0;
  constexpr int kSeeds = 12;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const Dataset dataset = test::SimulateOrDie(sim, seed);
    const std::unique_ptr<Estimator> filter = MakeFilter(config, dataset.rig);
    nees +=
        test::RunScenario(dataset, test::DrawInitialState(dataset, seed), filter.get()).nees_pose / kSeeds;
  }
  EXPECT_GT(nees, 6 * 0.7 * predicted->nees_ratio);
  EXPECT_LT(nees, 6 * 1.4 * predicted->nees_ratio);
}

TEST(ReuseStudyTest, RefusesARecordedImu) {
  SimulatorConfig simulation;
  simulation.hybrid_dataset = "somewhere";
  EXPECT_EQ(PredictConsistency(simulation, EstimatorConfig(), ReusePolicies()[0], 10, 1).status().code(),
            StatusCode::kConfig);
}

}  // namespace
}  // namespace alidade
