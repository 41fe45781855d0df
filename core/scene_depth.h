#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

namespace alidade {

/// Median depth of the latest tracks whose depth was determined.
class SceneDepth {
 public:
  void Add(double depth_m) {
    depths_m_[next_] = depth_m;
    next_ = (next_ + 1) % depths_m_.size();
    count_ = std::min(count_ + 1, depths_m_.size());
  }
  void Clear() { next_ = count_ = 0; }

  /// [m]; nullopt before there are kLeast.
  [[nodiscard]] std::optional<double> Median() const {
    if (count_ < kLeast) {
      return std::nullopt;
    }
    auto sorted = depths_m_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count_ / 2);
    std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(count_));
    return *middle;
  }

 private:
  static constexpr size_t kLeast = 10;
  std::array<double, 64> depths_m_{};
  size_t next_ = 0;
  size_t count_ = 0;
};

}  // namespace alidade
