#pragma once

#include <optional>
#include <span>
#include <vector>

#include "smoother/window/window.h"
#include "smoother/window/window_calibration.h"

namespace alidade {

/// Camera pose of a frame and its error's chain to the body error; computed once a frame and evaluation
/// point.
struct FrameGeometry {
  Pose T_WC;
  Matrix6d camera_from_body;
  std::optional<Pose> T_WC_first;  ///< where the Jacobians are taken, if elsewhere (FirstEstimate)
  Eigen::Matrix3d R_WB = Eigen::Matrix3d::Identity();  ///< when the camera saw
  Vector6d camera_from_time = Vector6d::Zero();        ///< d zeta_C / d time offset
  /// Of a rolling shutter: how AtRow moves the camera on. Empty: all rows are exposed at once.
  struct ReadOut {
    const BodyMotion* motion = nullptr;  ///< of the frame
    Pose T_BC;
    double line_delay_s = 0;
  };
  std::optional<ReadOut> read_out;
  Vector6d camera_from_line_delay = Vector6d::Zero();  ///< d zeta_C / d line delay, of one row

  [[nodiscard]] const Pose& Linearized() const { return T_WC_first ? *T_WC_first : T_WC; }
};
[[nodiscard]] FrameGeometry MakeGeometry(const NavState& state, const Pose& T_BC);
/// A frame of the window at a state, with its first estimate: where its body was when the camera saw.
[[nodiscard]] FrameGeometry MakeGeometry(const WindowFrame& frame, const NavState& state,
                                         const CameraCalibration& camera);
/// The camera of a frame when it exposed a row, `row_px` below the image's middle: `frame` itself, or with a
/// rolling shutter what is computed in `scratch`.
[[nodiscard]] const FrameGeometry& AtRow(const FrameGeometry& frame, double row_px, FrameGeometry* scratch);
/// That of a view.
[[nodiscard]] inline const FrameGeometry& AtRow(std::span<const FrameGeometry> geometry,
                                                const WindowView& view, FrameGeometry* scratch) {
  return AtRow(geometry[static_cast<size_t>(view.frame->index)], view.observation.row_px, scratch);
}
/// Of all frames, at their present states.
[[nodiscard]] std::vector<FrameGeometry> MakeGeometry(const Window& window, const CameraCalibration& camera);
/// With a camera that saw at the frames' stamps.
[[nodiscard]] std::vector<FrameGeometry> MakeGeometry(const Window& window, const Pose& T_BC);

/// d zeta_C / d calibration of a frame's camera, or of one of its rows, at a fixed body pose, in the layout's
/// columns. The intrinsics do not move it.
using CameraFromCalibration =
    Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, CalibrationLayout::kMaxSize>;
[[nodiscard]] CameraFromCalibration CalibrationChain(const CalibrationLayout& layout,
                                                     const FrameGeometry& frame);

}  // namespace alidade
