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
[[nodiscard]] WindowPoint PointOf(const Window& window, const CameraCalibration& camera);

/// Whether states, bias and clock of two points are the same numbers. The cameras are not compared.
[[nodiscard]] bool SameStates(const WindowPoint& a, const WindowPoint& b);

}  // namespace alidade
