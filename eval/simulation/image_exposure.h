#pragma once

#include <functional>
#include <vector>

#include "core/navigation_state.h"

namespace alidade {

/// Where a camera is while it exposes the rows of one image.
class ImageExposure {
 public:
  /// All rows at once.
  explicit ImageExposure(const Pose& T_WC) : poses_{T_WC} {}
  /// `T_WC_after`: the camera's pose some seconds after the exposure of the middle row, asked for at 65
  /// instants; between them the pose is interpolated (of a turn with 20 rad/s^2 and a read-out of 30 ms: to
  /// 1e-6 rad).
  ImageExposure(const std::function<Pose(double)>& T_WC_after, double line_delay_s, int height_px);

  /// The camera when it exposes a row [px].
  [[nodiscard]] Pose CameraAt(double row) const;
  [[nodiscard]] bool at_once() const { return poses_.size() == 1; }

 private:
  std::vector<Pose> poses_;
  double rows_between_ = 1;
};

}  // namespace alidade
