#pragma once

#include <functional>
#include <vector>

#include "core/lie.h"

namespace alidade {

/// Gauss-Newton normal equations of a chain of states x_0 .. x_{n-1} (15 columns each), every one linked to
/// the next, and of a few constants c (15 columns) that concern them all: H is block tridiagonal with a
/// border (an arrow).
///
/// Factorize eliminates x_0, x_1, ... in turn, with A_k what is left of the diagonal block, B_k its coupling
/// to x_{k+1} and C_k to c:
///
///     F_k = A_k^-1 B_k,  E_k = A_k^-1 C_k,
///     A_{k+1} -= B_k^T F_k,  C_{k+1} -= B_k^T E_k,  H_cc -= C_k^T E_k.
///
/// Backwards, from P_cc = H_cc^-1, the blocks of the inverse on and beside the diagonal and in the border
/// follow (Takahashi et al. 1973; the first two terms are the smoother of Rauch, Tung and Striebel 1965 given
/// c, the terms of E_k what c adds):
///
///     P_kc = -F_k P_{k+1,c} - E_k P_cc,   P_{k,k+1} = -F_k P_{k+1,k+1} - E_k P_{c,k+1},
///     P_kk = A_k^-1 - P_{k,k+1} F_k^T - P_kc E_k^T.
///
/// Both are exact. Time and memory are O(n): 5.5 kB a state.
class ArrowSystem {
 public:
  static constexpr int kState = 15;
  static constexpr int kBorder = 15;
  using Border = Eigen::Matrix<double, kBorder, 1>;
  using BorderMatrix = Eigen::Matrix<double, kBorder, kBorder>;
  using Coupling = Eigen::Matrix<double, kState, kBorder>;
  using PoseRows = Eigen::Matrix<double, 6, kState>;
  using BorderRows = Eigen::Matrix<double, 6, kBorder>;
  using LinkBorderRows = Eigen::Matrix<double, kState, kBorder>;

  explicit ArrowSystem(size_t states) : nodes_(states) {}

  [[nodiscard]] size_t states() const { return nodes_.size(); }
  /// Forgets all terms.
  void Reset();
  /// Whitened residual and Jacobians of a term over x_k, x_{k+1} and c.
  void AddLink(size_t k, const Vector15d& residual, const Matrix15d& of_k, const Matrix15d& of_next,
               const LinkBorderRows& of_border);
  /// The same of a term over x_k and c.
  void AddPose(size_t k, const Vector6d& residual, const PoseRows& of_k, const BorderRows& of_border);
  /// Independent whitened residuals of x_k, and of c: `root` holds the square roots of their information.
  void AddPrior(size_t k, const Vector15d& residual, const Vector15d& root);
  void AddBorderPrior(const Border& residual, const Border& root);

  /// False when H is not positive definite.
  bool Factorize();

  // After Factorize.

  /// g^T H^-1 g: the squared distance to the minimum of the linearised problem in standard deviations.
  [[nodiscard]] double newton_decrement() const { return newton_decrement_; }
  [[nodiscard]] const Border& border_step() const { return border_step_; }
  [[nodiscard]] const BorderMatrix& border_covariance() const { return border_covariance_; }

  /// What is known of a state: the step to the minimum, -H^-1 g, and covariances.
  struct Solution {
    size_t k = 0;
    Vector15d step = Vector15d::Zero();
    Matrix15d covariance = Matrix15d::Zero();       ///< P_kk
    Coupling with_border = Coupling::Zero();        ///< P_kc
    Matrix15d with_next = Matrix15d::Zero();        ///< P_{k,k+1}; zero of the last state
    Matrix15d next_covariance = Matrix15d::Zero();  ///< P_{k+1,k+1}; likewise
    Coupling next_with_border = Coupling::Zero();   ///< P_{k+1,c}; likewise
  };
  /// Visits all states, the last one first.
  void Solve(const std::function<void(const Solution&)>& visit) const;

 private:
  /// Before the elimination of the state A_k, B_k, C_k and the gradient; after it A_k^-1, F_k, E_k and A_k^-1
  /// g.
  struct Node {
    Matrix15d own = Matrix15d::Zero();
    Matrix15d next = Matrix15d::Zero();
    Coupling border = Coupling::Zero();
    Vector15d gradient = Vector15d::Zero();
  };

  std::vector<Node> nodes_;
  BorderMatrix border_ = BorderMatrix::Zero();
  Border border_gradient_ = Border::Zero();
  BorderMatrix border_covariance_ = BorderMatrix::Zero();
  Border border_step_ = Border::Zero();
  double newton_decrement_ = 0;
};

}  // namespace alidade
