#include "smoother/truth/arrow_system.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kStateColumns = ArrowSystem::kState;
constexpr Index kBorderColumns = ArrowSystem::kBorder;

/// Random terms over a chain, and the same normal equations as one dense matrix, constants last.
struct RandomChain {
  explicit RandomChain(size_t count) : system(count) {
    const Index border = kStateColumns * static_cast<Index>(count);
    hessian = MatrixXd::Zero(border + kBorderColumns, border + kBorderColumns);
    gradient = VectorXd::Zero(border + kBorderColumns);
    system.Reset();
    for (size_t k = 0; k < count; ++k) {
      const Index column = kStateColumns * static_cast<Index>(k);
      if (k + 1 < count) {
        const Matrix15d first = Random<15, 15>(), second = Random<15, 15>();
        const Vector15d residual = Random<15, 1>();
        const ArrowSystem::LinkBorderRows of_border = Random<15, kBorderColumns>();
        system.AddLink(k, residual, first, second, of_border);
        MatrixXd jacobian = MatrixXd::Zero(15, hessian.cols());
        jacobian.middleCols(column, 15) = first;
        jacobian.middleCols(column + 15, 15) = second;
        jacobian.rightCols(kBorderColumns) = of_border;
        AddDense(jacobian, residual);
      }
      for (int pose = 0; pose < 2; ++pose) {
        const ArrowSystem::PoseRows of_state = Random<6, 15>();
        const ArrowSystem::BorderRows of_border = Random<6, kBorderColumns>();
        const Vector6d residual = Random<6, 1>();
        system.AddPose(k, residual, of_state, of_border);
        MatrixXd jacobian = MatrixXd::Zero(6, hessian.cols());
        jacobian.middleCols(column, 15) = of_state;
        jacobian.middleCols(border, kBorderColumns) = of_border;
        AddDense(jacobian, residual);
      }
    }
    const Vector15d residual = Random<15, 1>(), root = Random<15, 1>();
    system.AddPrior(0, residual, root);
    hessian.diagonal().head<15>() += root.cwiseAbs2();
    gradient.head<15>() += root.cwiseProduct(residual);
    const ArrowSystem::Border border_residual = Random<kBorderColumns, 1>(),
                              border_root = Random<kBorderColumns, 1>();
    system.AddBorderPrior(border_residual, border_root);
    hessian.diagonal().tail<kBorderColumns>() += border_root.cwiseAbs2();
    gradient.tail<kBorderColumns>() += border_root.cwiseProduct(border_residual);
  }

  template <int kRows, int kColumns>
  Eigen::Matrix<double, kRows, kColumns> Random() {
    return Eigen::Matrix<double, kRows, kColumns>::NullaryExpr([this] { return random.Uniform(-1, 1); });
  }
  void AddDense(const MatrixXd& jacobian, const VectorXd& residual) {
    hessian += jacobian.transpose() * jacobian;
    gradient += jacobian.transpose() * residual;
  }

  test::RandomStates random{5};
  ArrowSystem system;
  MatrixXd hessian;
  VectorXd gradient;
};

TEST(ArrowSystemTest, EqualsTheDenseInverse) {
  constexpr size_t kStates = 7;
  RandomChain chain(kStates);
  ASSERT_TRUE(chain.system.Factorize());
  const MatrixXd covariance = chain.hessian.inverse();
  const VectorXd step = -covariance * chain.gradient;
  const double tolerance = 1e-9 * covariance.cwiseAbs().maxCoeff();
  const Index border = kStateColumns * static_cast<Index>(kStates);
  EXPECT_NEAR(chain.system.newton_decrement(), -chain.gradient.dot(step),
              1e-9 * chain.system.newton_decrement());
  EXPECT_LT((chain.system.border_covariance() - covariance.bottomRightCorner(kBorderColumns, kBorderColumns))
                .cwiseAbs()
                .maxCoeff(),
            tolerance);
  EXPECT_LT((chain.system.border_step() - step.tail(kBorderColumns)).cwiseAbs().maxCoeff(),
            1e-9 * step.norm());
  size_t visited = 0;
  chain.system.Solve([&](const ArrowSystem::Solution& solution) {
    EXPECT_EQ(solution.k, kStates - 1 - visited) << "the last one first";
    ++visited;
    const Index column = kStateColumns * static_cast<Index>(solution.k);
    EXPECT_LT((solution.step - step.segment(column, 15)).cwiseAbs().maxCoeff(), 1e-9 * step.norm());
    EXPECT_LT((solution.covariance - covariance.block(column, column, 15, 15)).cwiseAbs().maxCoeff(),
              tolerance);
    EXPECT_LT(
        (solution.with_border - covariance.block(column, border, 15, kBorderColumns)).cwiseAbs().maxCoeff(),
        tolerance);
    if (solution.k + 1 < kStates) {
      EXPECT_LT((solution.with_next - covariance.block(column, column + 15, 15, 15)).cwiseAbs().maxCoeff(),
                tolerance);
      EXPECT_LT((solution.next_covariance - covariance.block(column + 15, column + 15, 15, 15))
                    .cwiseAbs()
                    .maxCoeff(),
                tolerance);
    }
  });
  EXPECT_EQ(visited, kStates);
}

TEST(ArrowSystemTest, GivenNothingOfAStateThenNoFactorisation) {
  ArrowSystem system(2);
  system.Reset();
  EXPECT_FALSE(system.Factorize());
}

}  // namespace
}  // namespace alidade
