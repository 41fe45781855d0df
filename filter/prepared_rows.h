#pragma once

#include <Eigen/Core>

namespace alidade {

/// The rows of a Kalman update as SquareRootCovariance applies them: A = H S with P = S S^T, unit noise, and
/// the innovation y = measured - predicted. They lie in the storage of H and y, which must outlive them and
/// is theirs from then on. Only SquareRootCovariance::Prepare makes them, so that rows H cannot be taken for
/// rows A, nor be prepared twice.
class PreparedRows {
 public:
  /// Weights the rows [first, first + count) and their innovation.
  void Scale(int first, int count, double factor) {
    rows_.middleRows(first, count) *= factor;
    innovation_.segment(first, count) *= factor;
  }

 private:
  friend class SquareRootCovariance;
  /// Of `rows` and `innovation`, the rows from `sparse_from` on are handled apart.
  PreparedRows(Eigen::Ref<Eigen::MatrixXd> rows, Eigen::Ref<Eigen::VectorXd> innovation, int sparse_from)
      : rows_(rows), innovation_(innovation), sparse_from_(sparse_from) {}

  Eigen::Ref<Eigen::MatrixXd> rows_;
  Eigen::Ref<Eigen::VectorXd> innovation_;
  int sparse_from_;
};

}  // namespace alidade
