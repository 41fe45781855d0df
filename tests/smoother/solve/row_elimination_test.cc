#include "smoother/solve/row_elimination.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <vector>

#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int kFrames = 5;

TermPart Pose(int frame, Index first) {
  return {{Unknown::Kind::kFrame, frame}, first, kPoseColumns};
}

/// Rows of a chain of poses with a loop, and of each pose alone; `skipped`: a coordinate of the third that no
/// row is about, or -1.
std::vector<LinearTerm> MakeChain(int skipped) {
  test::RandomStates random(17);
  std::vector<LinearTerm> terms;
  const auto add = [&](const std::vector<TermPart>& parts, Index rows) {
    LinearTerm& term = terms.emplace_back();
    term.ResizeRows(parts, rows);
    for (double& entry : term.jacobian.reshaped()) {
      entry = random.Uniform(-1, 1);
    }
    for (const TermPart& part : parts) {
      if (part.of.index == 2 && skipped >= 0) {
        term.jacobian.col(part.first + skipped).setZero();
      }
    }
  };
  for (int i = 0; i + 1 < kFrames; ++i) {
    add({Pose(i, 0), Pose(i + 1, kPoseColumns)}, 6);
  }
  add({Pose(3, 0), Pose(0, kPoseColumns)}, 4);
  for (int i = 0; i < kFrames; ++i) {
    add({Pose(i, 0)}, 2);
  }
  return terms;
}

ColumnMap ColumnsInTime() {
  ColumnMap columns;
  for (int i = 0; i < kFrames; ++i) {
    columns.AddPose(i);
  }
  return columns;
}

TEST(RowEliminationTest, WhatIsLeftIsTheSchurComplement) {
  const ColumnMap columns = ColumnsInTime();
  RowElimination elimination(columns);
  MatrixXd hessian = MatrixXd::Zero(columns.size(), columns.size());
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(columns.size());
  for (LinearTerm& term : MakeChain(-1)) {
    term.AddTo(columns, &hessian, &gradient);
    elimination.Add(&term);
  }
  for (int i = 0; i < kFrames; ++i) {
    ASSERT_TRUE(elimination.EliminateUpTo(kPoseColumns * (i + 1)));
  }
  const MatrixXd full = hessian.selfadjointView<Eigen::Lower>();
  const MatrixXd schur = full.inverse().bottomRightCorner<6, 6>().inverse();
  EXPECT_LT((elimination.root().transpose() * elimination.root() - schur).norm(), 1e-10 * schur.norm());
}

TEST(RowEliminationTest, AColumnThatNoRowIsAboutIsNotDetermined) {
  for (int skipped = 0; skipped < 6; ++skipped) {
    RowElimination elimination(ColumnsInTime());
    for (LinearTerm& term : MakeChain(skipped)) {
      elimination.Add(&term);
    }
    EXPECT_TRUE(elimination.EliminateUpTo(2 * kPoseColumns));
    EXPECT_FALSE(elimination.EliminateUpTo(3 * kPoseColumns)) << skipped;
  }
}

}  // namespace
}  // namespace alidade
