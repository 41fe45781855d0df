#include "smoother/window/frame_geometry.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Where the body of a frame was when the camera saw, and the camera with it.
FrameGeometry Seeing(const WindowFrame& frame, const NavState& state, const CameraCalibration& camera) {
  const double later_s = camera.time_offset_s - frame.time_offset_s;
  const Matrix3d turn = so3::Exp(Vector3d(frame.rates.head<3>() * later_s));
  FrameGeometry geometry;
  geometry.R_WB = state.R_WB * turn;
  const Vector3d p_WB = state.p_WB + frame.rates.tail<3>() * later_s;
  geometry.T_WC = Pose{geometry.R_WB, p_WB} * camera.T_BC;
  const Matrix6d camera_from_moved = BodyToCameraJacobian(geometry.R_WB, camera.T_BC);
  geometry.camera_from_body = camera_from_moved;
  geometry.camera_from_body.leftCols<3>() = camera_from_moved.leftCols<3>() * turn.transpose();
  geometry.camera_from_time = camera_from_moved * frame.rates;
  return geometry;
}

/// `make` gives the geometry at a state.
template <typename Make>
FrameGeometry WithFirstEstimate(const WindowFrame& frame, const NavState& state, const Make& make) {
  FrameGeometry geometry = make(state);
  if (frame.first) {
    const FrameGeometry first = make(frame.first->Point(state));
    geometry.T_WC_first = first.T_WC;
    geometry.camera_from_body = first.camera_from_body * frame.first->Chain(state).topLeftCorner<6, 6>();
    geometry.R_WB = first.R_WB;
    geometry.camera_from_time = first.camera_from_time;
  }
  return geometry;
}

/// `camera`: its pose on the body, or its calibration.
template <typename Camera>
std::vector<FrameGeometry> OfEveryFrame(const Window& window, const Camera& camera) {
  std::vector<FrameGeometry> geometry;
  geometry.reserve(static_cast<size_t>(window.size()));
  for (const std::unique_ptr<WindowFrame>& frame : window.frames()) {
    geometry.push_back(MakeGeometry(*frame, frame->nav_state(), camera));
  }
  return geometry;
}

}  // namespace

FrameGeometry MakeGeometry(const NavState& state, const Pose& T_BC) {
  return {state.T_WB() * T_BC, BodyToCameraJacobian(state.R_WB, T_BC), {}};
}

FrameGeometry MakeGeometry(const WindowFrame& frame, const NavState& state, const Pose& T_BC) {
  return WithFirstEstimate(frame, state, [&](const NavState& at) { return MakeGeometry(at, T_BC); });
}

std::vector<FrameGeometry> MakeGeometry(const Window& window, const Pose& T_BC) {
  return OfEveryFrame(window, T_BC);
}

FrameGeometry MakeGeometry(const WindowFrame& frame, const NavState& state, const CameraCalibration& camera) {
  return WithFirstEstimate(frame, state, [&](const NavState& at) { return Seeing(frame, at, camera); });
}

std::vector<FrameGeometry> MakeGeometry(const Window& window, const CameraCalibration& camera) {
  return OfEveryFrame(window, camera);
}

CameraFromCalibration CalibrationChain(const CalibrationLayout& layout, const FrameGeometry& frame) {
  CameraFromCalibration chain = CameraFromCalibration::Zero(6, layout.size());
  if (layout.extrinsics() >= 0) {
    chain.middleCols<6>(layout.extrinsics()) = ExtrinsicsToCameraJacobian(frame.R_WB);
  }
  if (layout.time_offset() >= 0) {
    chain.col(layout.time_offset()) = frame.camera_from_time;
  }
  return chain;
}
}  // namespace alidade
