#include "smoother/window/window_point.h"

#include <algorithm>

namespace alidade {

WindowPoint PointOf(const Window& window, const CameraCalibration& camera) {
  WindowPoint point;
  point.camera = camera;
  for (const std::unique_ptr<WindowFrame>& frame : window.frames()) {
    point.states.push_back(frame->nav_state());
  }
  point.bias = window.frame(0).imu_bias();
  if (window.frame(0).clock) {
    point.clock = window.frame(0).clock_state();
  }
  return point;
}

bool operator==(const WindowPoint& a, const WindowPoint& b) {
  const auto same = [](const NavState& x, const NavState& y) {
    return x.R_WB == y.R_WB && x.p_WB == y.p_WB && x.v_WB == y.v_WB;
  };
  return a.bias.gyro == b.bias.gyro && a.bias.accel == b.bias.accel && a.clock == b.clock &&
         std::equal(a.states.begin(), a.states.end(), b.states.begin(), b.states.end(), same) &&
         a.camera == b.camera;
}

}  // namespace alidade
