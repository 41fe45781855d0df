#pragma once

#include <ceres/evaluation_callback.h>
#include <ceres/problem.h>

#include <memory>
#include <span>
#include <vector>

#include "smoother/factors/reduced_cost.h"
#include "smoother/manifold/lifted_cost.h"
#include "smoother/solve/window_term.h"

namespace alidade {

class ParameterBlocks;

/// The costs with eliminated landmarks of one solve, in Ceres.
///
/// Ceres uses a residual only through r^T r, J^T r and J^T J. The normal equations of all costs are added up
/// and handed over as the rows of a square root, a triangle over the frames in time order, clock and
/// calibration; one last row with zero Jacobian holds the rest of the cost. The rows are residual blocks of a
/// few frames' columns each, over the frames from there on: what is zero in the triangle is no work for
/// Ceres. Where no Jacobian is asked for, as at a trial step, the last row holds the whole cost: nothing is
/// linearised for a step that may not be taken.
class ReducedRows final : public ceres::EvaluationCallback {
 public:
  /// `blocks` must outlive it and the problem.
  explicit ReducedRows(ParameterBlocks* blocks);
  ReducedRows(const ReducedRows&) = delete;
  ReducedRows& operator=(const ReducedRows&) = delete;
  ReducedRows(ReducedRows&&) = delete;
  ReducedRows& operator=(ReducedRows&&) = delete;
  ~ReducedRows() override;

  /// The first one adds the residual blocks to the problem. The cost must outlive it. `parts`: the columns of
  /// its normal equations; those of a calibration that the problem does not estimate are left out.
  void Add(ReducedCost* cost, const std::vector<TermPart>& parts, ceres::Problem* problem);
  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override;

 private:
  class Rows;  // a group of them, as a factor

  void AddRows(ceres::Problem* problem);
  /// The costs at the parameters, whose landmarks are solved for.
  void Solve();
  void Linearize();

  ParameterBlocks* blocks_;
  struct Cost {
    ReducedCost* cost;
    std::vector<TermPart> parts;
  };
  std::vector<Cost> costs_;
  ColumnMap columns_;
  std::vector<std::unique_ptr<LiftedCost<Rows>>> rows_;
  std::vector<double> parameters_;  ///< of the last evaluation
  bool valid_ = false;              ///< the calibration there is a camera
  bool linear_ = false;             ///< jacobian_ and residual_ are of these parameters
  double total_ = 0;                ///< of the costs, twice what Ceres calls the cost
  Eigen::MatrixXd jacobian_;
  Eigen::VectorXd residual_;
};

}  // namespace alidade
