#include "filter/filter_observer.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "filter/filter.h"
#include "filter/filter_state.h"
#include "tests/support/scenario.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Repeats with plain covariance algebra what it is given, and compares at the end of every frame.
class CovarianceReplay : public FilterObserver {
 public:
  void OnReset(const FilterState& state) override {
    p_ = state.covariance().Covariance();
    core_ = 0;
  }
  void OnPropagate(const Matrix15d& phi, const Matrix15d& q) override {
    MatrixXd map = MatrixXd::Identity(p_.rows(), p_.rows());
    map.block<15, 15>(core_, core_) = phi;
    p_ = map * p_ * map.transpose();
    p_.block<15, 15>(core_, core_) += q;
  }
  void OnClone(int first, int size) override {
    const Index head = core_ + 15;
    MatrixXd map = MatrixXd::Zero(p_.rows() + size, p_.rows());
    map.topLeftCorner(head, head).setIdentity();
    map.block(head, core_ + first, size, size).setIdentity();
    map.bottomRightCorner(p_.rows() - head, p_.rows() - head).setIdentity();
    p_ = map * p_ * map.transpose();
  }
  void OnAddLandmark(int first, const MatrixXd& rows) override {
    ASSERT_EQ(first, 0);
    ASSERT_EQ(rows.cols(), p_.rows() + 3);
    const Eigen::Matrix3d root = rows.leftCols<3>().inverse();
    MatrixXd map = MatrixXd::Zero(p_.rows() + 3, p_.rows());
    map.topRows<3>() = -root * rows.rightCols(p_.rows());
    map.bottomRows(p_.rows()).setIdentity();
    p_ = map * p_ * map.transpose();
    p_.topLeftCorner<3, 3>() += root * root.transpose();
    core_ += 3;
    ++landmarks_;
  }
  void OnAddToLandmark(int landmark, const Eigen::Matrix3d& m, int source) override {
    MatrixXd map = MatrixXd::Identity(p_.rows(), p_.rows());
    map.block<3, 3>(landmark, source) = m;
    p_ = map * p_ * map.transpose();
    ++anchor_moves_;
  }
  void OnRemove(int first, int size) override {
    MatrixXd map = MatrixXd::Zero(p_.rows() - size, p_.rows());
    map.leftCols(first).topRows(first).setIdentity();
    const Index tail = p_.rows() - first - size;
    map.bottomRightCorner(tail, tail).setIdentity();
    p_ = map * p_ * map.transpose();
    core_ -= first < core_ ? size : 0;
  }
  void OnShear(const Eigen::VectorXd& column, const Eigen::VectorXd& row) override {
    const MatrixXd map = MatrixXd::Identity(p_.rows(), p_.rows()) + column * row.transpose();
    p_ = map * p_ * map.transpose();
    ++shears_;
  }
  void OnUpdate(const FilterState& state, const FilterRows& rows) override {
    ASSERT_EQ(rows.jacobian.cols(), state.covariance().dimension());
    MatrixXd innovation_covariance = rows.jacobian * p_ * rows.jacobian.transpose();
    innovation_covariance.diagonal().array() += 1;
    const MatrixXd cross = rows.jacobian * p_;
    p_ -= cross.transpose() * innovation_covariance.llt().solve(cross);
    ++updates_;
    CheckNoise(rows);
  }
  void OnFrame(const FilterState& state) override {
    const MatrixXd filter = state.covariance().Covariance();
    ASSERT_EQ(filter.rows(), p_.rows());
    // A clone is a copy, so P is singular for a moment: compare in correlation units.
    const Eigen::VectorXd scale = filter.diagonal().cwiseSqrt().cwiseInverse();
    worst_ =
        std::max(worst_, (scale.asDiagonal() * (filter - p_) * scale.asDiagonal()).cwiseAbs().maxCoeff());
    ++frames_;
  }

  int frames() const { return frames_; }
  int updates() const { return updates_; }
  int landmarks() const { return landmarks_; }
  int anchor_moves() const { return anchor_moves_; }
  int shears() const { return shears_; }
  int inflated() const { return inflated_; }
  int plain() const { return plain_; }
  double worst() const { return worst_; }

 private:
  /// Without a weight the rows are orthonormal combinations of the observations' noise; a base that counts
  /// half leaves less than that.
  void CheckNoise(const FilterRows& rows) {
    for (const TracedBlock& block : rows.blocks) {
      ASSERT_EQ(block.noise.rows(), block.rows);
      ASSERT_EQ(block.noise.cols(), static_cast<Index>(2 * block.serials.size()));
      const MatrixXd gram = block.noise * block.noise.transpose();
      const MatrixXd identity = MatrixXd::Identity(block.rows, block.rows);
      const bool unit = (gram - identity).cwiseAbs().maxCoeff() < 1e-9;
      plain_ += unit ? 1 : 0;
      inflated_ += unit ? 0 : 1;
      EXPECT_LT(gram.trace(), block.rows + 1e-9);
    }
  }

  MatrixXd p_;
  int core_ = 0;  ///< first row of the core, behind the landmarks
  int frames_ = 0;
  int updates_ = 0;
  int landmarks_ = 0;
  int anchor_moves_ = 0;
  int shears_ = 0;
  int inflated_ = 0;
  int plain_ = 0;
  double worst_ = 0;
};

CovarianceReplay Replay(const EstimatorConfig& config, double path_m) {
  SimulatorConfig sim;
  sim.duration_s = 8;
  sim.path_m = path_m;
  const Dataset dataset = test::SimulateOrDie(sim, 3);
  CovarianceReplay replay;
  const std::unique_ptr<Estimator> filter = MakeFilter(config, dataset.rig, &replay);
  const test::ScenarioResult result =
      test::RunScenario(dataset, test::DrawInitialState(dataset, 3), filter.get());
  EXPECT_TRUE(result.status.ok()) << result.status.message();
  EXPECT_EQ(result.frames, replay.frames());
  return replay;
}

CovarianceReplay Replay(BaseReuse reuse, RobustKernel kernel, int slam_features = 0) {
  EstimatorConfig config;
  config.filter.base_reuse = reuse;
  config.filter.window = 12;
  config.filter.slam_features = slam_features;
  config.vision.robust_kernel = kernel;
  config.vision.gate_probability = kernel == RobustKernel::kNone ? 1.0 : 0.99;
  return Replay(config, 10);
}

TEST(FilterObserverTest, WhatIsObservedIsWhatTheFilterDoes) {
  const CovarianceReplay replay = Replay(BaseReuse::kInflate, RobustKernel::kHuber);
  EXPECT_GT(replay.updates(), 60);
  EXPECT_LT(replay.worst(), 1e-6);
}

TEST(FilterObserverTest, LandmarksOfTheStateAreObservedToo) {
  const CovarianceReplay replay = Replay(BaseReuse::kInflate, RobustKernel::kHuber, 10);
  EXPECT_GT(replay.landmarks(), 20);
  EXPECT_GT(replay.anchor_moves(), 20);
  EXPECT_LT(replay.worst(), 1e-6);
}

TEST(FilterObserverTest, WhatCarriesAnUncertainScaleIsObservedToo) {
  EstimatorConfig config;
  config.filter.window = 12;
  config.filter.max_direction_deviation = 0.2;
  const CovarianceReplay replay = Replay(config, 0.8);
  EXPECT_GT(replay.shears(), 5);
  EXPECT_LT(replay.worst(), 1e-6);
}

TEST(FilterObserverTest, TheNoiseOfARowIsThatOfItsObservations) {
  const CovarianceReplay disjoint = Replay(BaseReuse::kDisjoint, RobustKernel::kNone);
  EXPECT_GT(disjoint.plain(), 500);
  EXPECT_EQ(disjoint.inflated(), 0);
  EXPECT_GT(Replay(BaseReuse::kInflate, RobustKernel::kNone).inflated(), 500);
}

TEST(FilterObserverTest, ObservingChangesNothing) {
  SimulatorConfig sim;
  sim.duration_s = 5;
  sim.path_m = 6;
  const Dataset dataset = test::SimulateOrDie(sim, 4);
  const EstimatorConfig config;
  CovarianceReplay replay;
  const std::unique_ptr<Estimator> observed = MakeFilter(config, dataset.rig, &replay);
  const std::unique_ptr<Estimator> alone = MakeFilter(config, dataset.rig);
  const NavEstimate initial = test::DrawInitialState(dataset, 4);
  const test::ScenarioResult with = test::RunScenario(dataset, initial, observed.get());
  const test::ScenarioResult without = test::RunScenario(dataset, initial, alone.get());
  EXPECT_EQ(with.last.nav.p_WB, without.last.nav.p_WB);
  EXPECT_EQ(with.last.covariance, without.last.covariance);
}

}  // namespace
}  // namespace alidade
