#pragma once

#include <ceres/crs_matrix.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "smoother/solve/window_problem.h"
#include "smoother/solve/window_term.h"
#include "tests/smoother/window/window_fixture.h"

namespace alidade::test {

/// Terms as Ceres sees them, with the manifolds of a convention.
class CeresView {
 public:
  CeresView(ErrorConvention convention, const WindowFrames& frames, const WindowCalibration& calibration,
            std::vector<WindowTrack*> tracks = {})
      : convention_(convention),
        frames_(frames),
        tracks_(std::move(tracks)),
        problem_(convention, frames, tracks_, calibration) {}

  /// The term must outlive the view. Its parts become columns.
  void Add(WindowTerm* term) {
    term->AddTo(&problem_);
    for (const TermPart& part : term->parts()) {
      AddColumns(part);
    }
  }
  /// The columns of all terms together: `parts` alone, in this order.
  void SetColumns(const std::vector<TermPart>& parts) {
    order_.clear();
    for (const TermPart& part : parts) {
      AddColumns(part);
    }
  }

  /// The error of the calibration, CalibrationLayout::kMaxSize.
  void SetCalibration(const Eigen::VectorXd& error) {
    std::copy(error.data(), error.data() + error.size(), problem_.blocks().Calibration());
  }

  /// Rows over the tangents of all blocks of the columns, side by side.
  [[nodiscard]] Eigen::MatrixXd Jacobian(Eigen::VectorXd* residual) {
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = order_;
    options.apply_loss_function = true;
    std::vector<double> values;
    ceres::CRSMatrix sparse;
    EXPECT_TRUE(problem_.ceres().Evaluate(options, nullptr, &values, nullptr, &sparse));
    *residual = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
    for (int row = 0; row < sparse.num_rows; ++row) {
      for (int i = sparse.rows[static_cast<size_t>(row)]; i < sparse.rows[static_cast<size_t>(row) + 1];
           ++i) {
        jacobian(row, sparse.cols[static_cast<size_t>(i)]) = sparse.values[static_cast<size_t>(i)];
      }
    }
    return jacobian;
  }
  /// Half the sum of the losses.
  [[nodiscard]] double Cost() {
    double cost = 0;
    EXPECT_TRUE(problem_.ceres().Evaluate({}, &cost, nullptr, nullptr, nullptr));
    return cost;
  }
  /// Residuals with the blocks moved by `delta`, through the manifolds.
  [[nodiscard]] Eigen::VectorXd Moved(const Eigen::VectorXd& delta) {
    const std::vector<std::vector<double>> before = Move(delta);
    std::vector<double> values;
    EXPECT_TRUE(problem_.ceres().Evaluate({}, nullptr, &values, nullptr, nullptr));
    MoveBack(before);
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  }
  /// J^T r there.
  [[nodiscard]] Eigen::VectorXd MovedGradient(const Eigen::VectorXd& delta) {
    const std::vector<std::vector<double>> before = Move(delta);
    Eigen::VectorXd residual;
    const Eigen::MatrixXd jacobian = Jacobian(&residual);
    MoveBack(before);
    return jacobian.transpose() * residual;
  }
  /// d canonical coordinates of the parts / d tangents.
  [[nodiscard]] Eigen::MatrixXd Chart(const std::vector<TermPart>& parts) const {
    Eigen::MatrixXd chart = Eigen::MatrixXd::Zero(0, 0);
    for (const TermPart& part : parts) {
      Eigen::MatrixXd own = Eigen::MatrixXd::Identity(part.width, part.width);
      if (part.of.kind == Unknown::Kind::kFrame) {
        // Relative to the centre of ParameterBlocks' manifold.
        NavState state = frames_[static_cast<size_t>(part.of.index)]->nav_state();
        state.p_WB -= frames_.back()->nav_state().p_WB;
        state.v_WB -= frames_.back()->nav_state().v_WB;
        const Eigen::Index columns = std::max(part.width, kNavColumns);
        own = ImuChartJacobian(convention_, state).topLeftCorner(part.width, columns);
      }
      const Eigen::Index rows = chart.rows();
      const Eigen::Index columns = chart.cols();
      chart.conservativeResize(rows + own.rows(), columns + own.cols());
      chart.rightCols(own.cols()).topRows(rows).setZero();
      chart.bottomRows(own.rows()).leftCols(columns).setZero();
      chart.bottomRightCorner(own.rows(), own.cols()) = own;
    }
    return chart;
  }

 private:
  void AddColumns(const TermPart& part) {
    switch (part.of.kind) {
      case Unknown::Kind::kFrame:
        order_.push_back(problem_.blocks().Nav(part.of.index));
        if (part.width > kNavColumns) {
          order_.push_back(problem_.blocks().Bias(part.of.index));
        }
        break;
      case Unknown::Kind::kClock:
        order_.push_back(problem_.blocks().Clock(part.of.index));
        break;
      case Unknown::Kind::kCalibration:
        order_.push_back(problem_.blocks().Calibration());
        break;
      case Unknown::Kind::kLandmark:
        order_.push_back(problem_.blocks().Landmark(part.of.index));
        break;
    }
  }
  /// Returns what the blocks held before.
  std::vector<std::vector<double>> Move(const Eigen::VectorXd& delta) {
    std::vector<std::vector<double>> before;
    Eigen::Index at = 0;
    for (double* block : order_) {
      const int size = problem_.ceres().ParameterBlockSize(block);
      const int tangent = problem_.ceres().ParameterBlockTangentSize(block);
      before.emplace_back(block, block + size);
      const Eigen::VectorXd step = delta.segment(at, tangent);
      if (const ceres::Manifold* manifold = problem_.ceres().GetManifold(block)) {
        manifold->Plus(before.back().data(), step.data(), block);
      } else {
        Eigen::Map<Eigen::VectorXd>(block, size) += step;
      }
      at += tangent;
    }
    return before;
  }
  void MoveBack(const std::vector<std::vector<double>>& before) {
    for (size_t i = 0; i < order_.size(); ++i) {
      std::copy(before[i].begin(), before[i].end(), order_[i]);
    }
  }

  ErrorConvention convention_;
  const WindowFrames& frames_;
  const std::vector<WindowTrack*> tracks_;
  WindowProblem problem_;
  std::vector<double*> order_;
};

/// Moves the states away from where the data put them, so that no residual is zero.
inline void Disturb(WindowFixture* fixture) {
  for (int i = 0; i < fixture->window.size(); ++i) {
    WindowFrame& frame = fixture->window.frame(i);
    Vector9d shift;
    shift << fixture->random.Vector(0.02), fixture->random.Vector(0.05), fixture->random.Vector(0.05);
    PackNavState(Retract(ErrorConvention::kSo3xRn, frame.nav_state(), shift), frame.nav.data());
  }
}

}  // namespace alidade::test
