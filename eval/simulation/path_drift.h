#pragma once

#include <array>

#include "core/random.h"
#include "eval/simulation/jet.h"

namespace alidade {

/// s(u) = sum_i a_i sin(f_i u + c_i) with amplitudes 0.4, 0.3, 0.2, 0.1: within [-1, 1] and never periodic.
/// The frequencies f_i are near 0.5, 0.87, 1.41, 2.24; they and the offsets c_i are drawn.
class PathDrift {
 public:
  explicit PathDrift(RandomStream* stream);

  [[nodiscard]] Jet At(const Jet& u) const;
  /// Root mean square of d s / d u over all u.
  [[nodiscard]] double RmsSlope() const;

 private:
  static constexpr std::size_t kTerms = 4;

  std::array<double, kTerms> frequency_ = {};
  std::array<double, kTerms> offset_ = {};
};

}  // namespace alidade
