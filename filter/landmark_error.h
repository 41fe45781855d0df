#pragma once

#include <Eigen/Core>

#include "core/error_convention.h"

namespace alidade {

/// Whether a correction of the convention turns every state about the origin of W.
[[nodiscard]] constexpr bool TurnsAboutOrigin(ErrorConvention convention) {
  return convention == ErrorConvention::kRightInvariant;
}

/// The error f~ of a landmark, in the state or remembered with a track. It is additive, p_W = p^_W + f~,
/// except in the right-invariant convention, where it turns with the attitude error of its anchor clone a:
///
///     p_W = Exp(theta_a) p^_W + f~.
///
/// With it a common turn and a common shift of all errors change no predicted observation, wherever the
/// landmark is linearised.
class LandmarkError {
 public:
  explicit LandmarkError(ErrorConvention convention) : anchored_(TurnsAboutOrigin(convention)) {}

  /// True when the error turns with an anchor's.
  [[nodiscard]] bool anchored() const { return anchored_; }

  /// [p_W]x: to first order an additive error of an anchored p_W is f~ - Lever theta_a. Moving the anchor
  /// from a to b leaves f~' = f~ + Lever (theta_b - theta_a).
  [[nodiscard]] static Eigen::Matrix3d Lever(const Eigen::Vector3d& p_W) { return Skew(p_W); }

  /// Rows over an additive error of p_W, and so over f~, to the rows over theta_a of an anchored one.
  template <typename Rows>
  [[nodiscard]] static Eigen::Matrix<double, Rows::RowsAtCompileTime, 3> OverAnchor(
      const Eigen::MatrixBase<Rows>& rows, const Eigen::Vector3d& p_W) {
    return -rows * Lever(p_W);
  }

  /// An anchored landmark after a correction that turned its anchor by theta_a; its own f~ comes on top.
  /// To first order it is Exp(theta_a) p_W. Turned about `centre` (FilterState::centre()), what the first
  /// order neglects does not grow with the distance from W's origin.
  [[nodiscard]] static Eigen::Vector3d Turned(const Eigen::Vector3d& theta_a, const Eigen::Vector3d& p_W,
                                              const Eigen::Vector3d& centre) {
    return centre + theta_a.cross(centre) + so3::Exp(theta_a) * (p_W - centre);
  }

 private:
  bool anchored_;
};

}  // namespace alidade
