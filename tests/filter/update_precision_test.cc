#include <gtest/gtest.h>

#include <string>

#include "eval/config/config_yaml.h"
#include "filter/filter_estimator.h"
#include "filter/square_root_covariance.h"
#include "tests/filter/square_root_fixture.h"
#include "tests/support/preset_run.h"
#include "tests/support/scenario.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A window of eight clones behind two leading blocks, updated once in single and once in double precision.
class UpdatePrecisionTest : public ::testing::Test {
 protected:
  struct Outcome {
    MatrixXd covariance;
    VectorXd correction;
    double nis = 0;
    double log_det = 0;
  };

  /// `scale`: of the rows, which do not see the first `unseen` errors.
  static Outcome Update(UpdatePrecision precision, double scale, Index unseen) {
    RandomStream random(7, "update precision");
    const MatrixXd a = test::RandomMatrix(&random, 15, 15);
    SquareRootCovariance root(15 + 6 * 8 + 6, 6, precision);
    EXPECT_TRUE(root.Reset(a * a.transpose() + 0.1 * Matrix15d::Identity()).ok());
    for (int clone = 0; clone < 8; ++clone) {
      root.Propagate(Matrix15d::Identity() + 0.1 * test::RandomMatrix(&random, 15, 15),
                     0.1 * test::RandomMatrix(&random, 15, 15));
      root.CloneCore(0, 6);
    }
    for (int landmark = 0; landmark < 2; ++landmark) {
      root.AddLeading(Eigen::Matrix3d::Identity(),
                      test::RandomMatrix(&random, 3, root.dimension() - root.leading()));
    }
    constexpr int kDense = 90;
    MatrixXd rows = scale * test::RandomMatrix(&random, kDense + 4, root.dimension());
    rows.topLeftCorner(kDense, unseen).setZero();
    rows.block(kDense, 6, 4, root.dimension() - 9).setZero();
    VectorXd innovation = test::RandomMatrix(&random, kDense + 4, 1);
    Outcome outcome;
    outcome.correction.resize(root.dimension());
    EXPECT_TRUE(root.Apply(root.Prepare(rows, innovation, kDense), outcome.correction, &outcome.nis,
                           &outcome.log_det));
    outcome.covariance = root.Covariance();
    const MatrixXd below = root.factor().triangularView<Eigen::StrictlyLower>();
    EXPECT_EQ(below.norm(), 0.0);
    return outcome;
  }
};

TEST_F(UpdatePrecisionTest, SingleIsDoubleToItsRounding) {
  for (const Index unseen : {0, 6, 21}) {
    const Outcome exact = Update(UpdatePrecision::kDouble, 0.1, unseen);
    const Outcome rounded = Update(UpdatePrecision::kSingle, 0.1, unseen);
    EXPECT_LT((rounded.covariance - exact.covariance).norm(), 1e-4 * exact.covariance.norm());
    EXPECT_NE(rounded.covariance, exact.covariance);
    EXPECT_LT((rounded.correction - exact.correction).norm(), 1e-4 * exact.correction.norm());
    EXPECT_NEAR(rounded.nis, exact.nis, 1e-4 * exact.nis);
    EXPECT_NEAR(rounded.log_det, exact.log_det, 1e-4 * exact.log_det);
  }
}

// GIVEN rows beside whose square single precision does not hold the identity THEN it is factored in double
// precision, and the update is as good as the rows are.
TEST_F(UpdatePrecisionTest, LargeRowsAreFactoredInDouble) {
  const Outcome exact = Update(UpdatePrecision::kDouble, 1e4, 0);
  const Outcome rounded = Update(UpdatePrecision::kSingle, 1e4, 0);
  EXPECT_LT((rounded.covariance - exact.covariance).norm(), 1e-3 * exact.covariance.norm());
  EXPECT_NEAR(rounded.log_det, exact.log_det, 1e-5 * exact.log_det);
}

TEST(UpdatePrecisionRun, TheEstimateIsTheSame) {
  SimulatorConfig sim;
  sim.duration_s = 30;
  sim.path_m = 39;
  const Dataset dataset = test::SimulateOrDie(sim, 12);
  for (const std::string preset : {"alidade_filter", "openvins_class"}) {
    const test::ScenarioResult exact =
        test::RunPreset(preset, {"filter.update_precision=double"}, dataset, 12);
    const test::ScenarioResult rounded =
        test::RunPreset(preset, {"filter.update_precision=single"}, dataset, 12);
    EXPECT_NE(rounded.rmse_position_m, exact.rmse_position_m) << preset;
    EXPECT_NEAR(rounded.rmse_position_m, exact.rmse_position_m, 0.02 * exact.rmse_position_m) << preset;
    EXPECT_NEAR(rounded.nees_pose, exact.nees_pose, 0.05 * exact.nees_pose) << preset;
  }
}

/// The end of a run of alidade_filter in either precision, which is the same only where both are double.
class WhereSingleDoesNotSuffice : public ::testing::Test {
 protected:
  static Eigen::Vector3d End(const Dataset& dataset, const NavEstimate& start, const std::string& precision) {
    const Result<EstimatorConfig> config =
        LoadEstimatorConfig(ALIDADE_SOURCE_DIR "/configs/estimators/alidade_filter.yaml",
                            {"filter.update_precision=" + precision});
    EXPECT_TRUE(config.ok()) << config.message();
    FilterEstimator filter(*config, dataset.rig);
    const test::ScenarioResult result = test::RunScenario(dataset, start, &filter);
    EXPECT_TRUE(result.status.ok()) << result.status.message();
    return result.last.nav.p_WB;
  }

  static Dataset FiveSeconds(double path_m) {
    SimulatorConfig sim;
    sim.duration_s = 5;
    sim.path_m = path_m;
    return test::SimulateOrDie(sim, 12);
  }
};

// GIVEN a position error whose deviation a single does not hold THEN the update is in double precision.
TEST_F(WhereSingleDoesNotSuffice, FarFromTheOriginItIsDouble) {
  const Dataset dataset = FiveSeconds(6.5);
  NavEstimate start = test::DrawInitialState(dataset, 12);
  EXPECT_NE(End(dataset, start, "single"), End(dataset, start, "double"));
  start.nav.p_WB += Eigen::Vector3d(1.5e5, 0, 0);
  EXPECT_EQ(End(dataset, start, "single"), End(dataset, start, "double"));
}

// GIVEN a slow start of unknown velocity, with which the window's shape is uncertain THEN so it is.
TEST_F(WhereSingleDoesNotSuffice, WithAWindowOfUncertainShapeItIsDouble) {
  const Dataset dataset = FiveSeconds(0.5);
  NavEstimate start = test::DrawInitialState(dataset, 12);
  start.covariance.block<3, 3>(6, 6) = 0.01 * Eigen::Matrix3d::Identity();
  EXPECT_EQ(End(dataset, start, "single"), End(dataset, start, "double"));
}

}  // namespace
}  // namespace alidade
