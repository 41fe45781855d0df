#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace alidade {

/// Depth of the scenery while too few tracks tell it: that of a room [m].
inline constexpr double kRoomDepth = 5;

/// Depth of the scenery: the median of the latest tracks whose depth was determined.
class SceneDepth {
 public:
  static constexpr size_t kLeastTracks = 10;

  void Add(double depth_m) {
    depths_m_[next_] = depth_m;
    next_ = (next_ + 1) % depths_m_.size();
    count_ = std::min(count_ + 1, depths_m_.size());
  }
  void Clear() { next_ = count_ = 0; }

  /// [m]; kRoomDepth before there are kLeastTracks.
  [[nodiscard]] double Metres() const {
    if (count_ < kLeastTracks) {
      return kRoomDepth;
    }
    auto sorted = depths_m_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count_ / 2);
    std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(count_));
    return *middle;
  }

 private:
  std::array<double, 64> depths_m_{};
  size_t next_ = 0;
  size_t count_ = 0;
};

}  // namespace alidade
