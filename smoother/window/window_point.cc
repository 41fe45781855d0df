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
  const CameraCalibration& c = a.camera;
  const CameraCalibration& d = b.camera;
  return a.bias.gyro == b.bias.gyro && a.bias.accel == b.bias.accel && a.clock == b.clock &&
         std::equal(a.states.begin(), a.states.end(), b.states.begin(), b.states.end(), same) &&
         c.T_BC.rotation == d.T_BC.rotation && c.T_BC.translation == d.T_BC.translation &&
         c.time_offset_s == d.time_offset_s && c.line_delay_s == d.line_delay_s &&
         c.camera.intrinsics() == d.camera.intrinsics() && c.camera.coefficients() == d.camera.coefficients();
}

}  // namespace alidade
