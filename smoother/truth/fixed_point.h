#pragma once

#include <algorithm>
#include <cmath>

namespace alidade {

/// Faster iterations x <- F(x) of a positive x that converge linearly, as those of a noise that follows the
/// residuals do. The logarithm takes a secant step, held between once and four times the plain one.
class FixedPoint {
 public:
  /// The next x after `x`, given F(x).
  [[nodiscard]] double Next(double x, double F_of_x) {
    const double at = std::log(x);
    const double step = std::log(F_of_x / x);
    double factor = 1;
    if (last_step_ != 0 && at != last_at_) {
      const double slope = (step - last_step_) / (at - last_at_);
      factor = slope < 0 ? std::clamp(-1 / slope, 1.0, kMaxFactor) : 1;
    }
    last_at_ = at;
    last_step_ = step;
    return std::exp(at + factor * step);
  }

 private:
  static constexpr double kMaxFactor = 4;

  double last_at_ = 0;
  double last_step_ = 0;  ///< plain; 0: none yet
};

}  // namespace alidade
