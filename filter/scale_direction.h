#pragma once

#include <Eigen/Core>

#include "filter/filter_state.h"

namespace alidade {

/// The direction of a change of scale in the filter's error: every camera of the window moves away from the
/// oldest one in proportion to its distance, and the velocity grows by the same share. The rows of tracks do
/// not see it at the state where they are linearised. Once a correction has changed the window's shape, new
/// rows do not see another direction, and together they would report a scale that no track determines
/// (docs/track_memory.md).
class ScaleDirection {
 public:
  /// capacity: largest size of the error.
  explicit ScaleDirection(int capacity);

  /// Takes the direction at the present state, n, over the clones up to `last_serial`, whose shape the tracks
  /// have determined. False when they are fewer than two, or at one place: nothing is to be carried then.
  bool Take(const FilterState& state, int last_serial);
  /// After a correction: with n' the direction now, errors x become x + (n' - n) l.x, l.x being the relative
  /// error of scale in x, l.n = 1. So what did not see n does not see n'. The state after those clones
  /// follows with their velocity. Applied to the covariance and to `errors` (of the whole error's size, or
  /// empty).
  void Carry(FilterState* state, Eigen::Ref<Eigen::VectorXd> errors);
  /// Takes what Carry has done to the covariance since Take back.
  void TakeBack(FilterState* state);
  /// l, l.x being the relative error of scale in x.
  [[nodiscard]] auto row() const { return row_.head(dimension_); }
  /// The correction that takes away a gradient g of the cost along the direction: -P l g / (1 + v |g|), l.n'
  /// = 1, v = l P l. Smaller than the scale itself however large v g is: the cost is no parabola that far.
  void Descend(const SquareRootCovariance& covariance, double gradient,
               Eigen::Ref<Eigen::VectorXd> correction);
  /// In place of a correction by `step` of Descend: the scale may be wrong by anything between nothing and
  /// s = l.step, of which s^2 / 3 is the mean square. Its variance v grows by so much: errors x become x + c
  /// (l.x / s) step, (1 + c)^2 v = v + s^2 / 3. What is not correlated with the scale stays as it is.
  void Inflate(const Eigen::Ref<const Eigen::VectorXd>& step, FilterState* state);

 private:
  /// l P l; change_ becomes S^T l, P = S S^T.
  double VarianceOfRow(const SquareRootCovariance& covariance);

  size_t determined_ = 0;  ///< number of clones that `last_serial` closes
  Eigen::Index dimension_ = 0;
  Eigen::VectorXd row_;      ///< l
  double scale_ = 1;         ///< l.n of the direction now
  Eigen::MatrixX3d places_;  ///< of these cameras, seen from the oldest one
  Eigen::VectorXd change_;
  Eigen::VectorXd carried_;  ///< errors are x + carried l.x since Take
};

}  // namespace alidade
