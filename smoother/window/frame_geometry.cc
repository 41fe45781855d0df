#include "smoother/window/frame_geometry.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;

/// Where the body of a frame was when the camera saw, and the camera with it.
FrameGeometry Seeing(const WindowFrame& frame, const NavState& state, const CameraCalibration& camera) {
  const double later_s = camera.time_offset_s - frame.time_offset_s;
  if (later_s == 0) {
    FrameGeometry geometry = MakeGeometry(state, camera.T_BC);
    geometry.camera_from_time = geometry.camera_from_body * frame.rates;
    return geometry;
  }
  Matrix3d turn;
  const Pose T_WB = BodyAfter(state.T_WB(), frame.rates, later_s, &turn);
  FrameGeometry geometry;
  geometry.R_WB = T_WB.rotation;
  geometry.T_WC = T_WB * camera.T_BC;
  const Matrix6d camera_from_moved = BodyToCameraJacobian(geometry.R_WB, camera.T_BC);
  geometry.camera_from_body = camera_from_moved;
  geometry.camera_from_body.leftCols<3>() = camera_from_moved.leftCols<3>() * turn.transpose();
  geometry.camera_from_time = camera_from_moved * frame.rates;
  return geometry;
}

}  // namespace

FrameGeometry MakeGeometry(const NavState& state, const Pose& T_BC) {
  FrameGeometry geometry;
  geometry.T_WC = state.T_WB() * T_BC;
  geometry.camera_from_body = BodyToCameraJacobian(state.R_WB, T_BC);
  geometry.R_WB = state.R_WB;
  return geometry;
}

FrameGeometry MakeGeometry(const WindowFrame& frame, const NavState& state, const CameraCalibration& camera) {
  FrameGeometry geometry = Seeing(frame, state, camera);
  if (frame.first) {
    const FrameGeometry first = Seeing(frame, frame.first->Point(state), camera);
    geometry.T_WC_first = first.T_WC;
    geometry.camera_from_body = first.camera_from_body * frame.first->Chain(state).topLeftCorner<6, 6>();
    geometry.R_WB = first.R_WB;
    geometry.camera_from_time = first.camera_from_time;
  }
  if (camera.line_delay_s) {
    geometry.read_out = {&frame.motion, camera.T_BC, *camera.line_delay_s};
  }
  return geometry;
}

const FrameGeometry& AtRow(const FrameGeometry& frame, double row_px, FrameGeometry* scratch) {
  if (!frame.read_out) {
    return frame;
  }
  const auto& [motion, T_BC, line_delay_s] = *frame.read_out;
  const ExposedRow row = ExposeRow(*motion, T_BC, frame.R_WB, line_delay_s, row_px);
  scratch->T_WC = frame.T_WC * row.T_CR;
  scratch->T_WC_first.reset();
  if (frame.T_WC_first) {
    scratch->T_WC_first = *frame.T_WC_first * row.T_CR;
  }
  scratch->camera_from_body.noalias() = row.row_from_camera * frame.camera_from_body;
  scratch->camera_from_time.noalias() = row.row_from_camera * frame.camera_from_time;
  scratch->R_WB = row.R_WB;
  scratch->camera_from_line_delay = row.row_from_line_delay;
  scratch->read_out.reset();
  return *scratch;
}

std::vector<FrameGeometry> MakeGeometry(const Window& window, const CameraCalibration& camera) {
  std::vector<FrameGeometry> geometry;
  geometry.reserve(static_cast<size_t>(window.size()));
  for (const std::unique_ptr<WindowFrame>& frame : window.frames()) {
    geometry.push_back(MakeGeometry(*frame, frame->nav_state(), camera));
  }
  return geometry;
}

std::vector<FrameGeometry> MakeGeometry(const Window& window, const Pose& T_BC) {
  std::vector<FrameGeometry> geometry;
  for (const std::unique_ptr<WindowFrame>& frame : window.frames()) {
    const CameraCalibration camera{{}, T_BC, frame->time_offset_s};
    geometry.push_back(MakeGeometry(*frame, frame->nav_state(), camera));
  }
  return geometry;
}

CameraFromCalibration CalibrationChain(const CalibrationLayout& layout, const FrameGeometry& frame) {
  CameraFromCalibration chain = CameraFromCalibration::Zero(6, layout.size());
  if (layout.extrinsics() >= 0) {
    chain.middleCols<6>(layout.extrinsics()) = ExtrinsicsToCameraJacobian(frame.R_WB);
  }
  if (layout.time_offset() >= 0) {
    chain.col(layout.time_offset()) = frame.camera_from_time;
  }
  if (layout.line_delay() >= 0) {
    chain.col(layout.line_delay()) = frame.camera_from_line_delay;
  }
  return chain;
}

}  // namespace alidade
