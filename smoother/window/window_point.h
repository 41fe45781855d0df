#pragma once

#include <optional>
#include <vector>

#include "smoother/window/window.h"

namespace alidade {

/// States of a window at an evaluation.
struct WindowPoint {
  std::vector<NavState> states;   ///< of every frame
  ImuBias bias;                   ///< of the first
  std::optional<Vector6d> clock;  ///< of the first, in an aligned window
  CameraCalibration camera;
};
/// Whether all numbers of two points are the same.
[[nodiscard]] bool operator==(const WindowPoint& a, const WindowPoint& b);

[[nodiscard]] WindowPoint PointOf(const Window& window, const CameraCalibration& camera);

}  // namespace alidade
