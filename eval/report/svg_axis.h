#pragma once

#include <vector>

namespace alidade {

/// One axis: maps values to positions on the canvas.
class SvgAxis {
 public:
  /// `from` is the position of `low`; a logarithmic axis needs low > 0.
  SvgAxis(double low, double high, double from, double to, bool log);
  [[nodiscard]] double At(double value) const;
  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }
  /// About `count` round values inside; decades, or 1, 2, 5 of each, where logarithmic.
  [[nodiscard]] std::vector<double> Ticks(int count) const;

 private:
  double low_, high_, from_, to_;
  bool log_;
};

}  // namespace alidade
