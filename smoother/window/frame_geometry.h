#pragma once

#include <optional>
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

  [[nodiscard]] const Pose& Linearized() const { return T_WC_first ? *T_WC_first : T_WC; }
};
[[nodiscard]] FrameGeometry MakeGeometry(const NavState& state, const Pose& T_BC);
/// A frame of the window at a state, with its first estimate: where its body was when the camera saw.
[[nodiscard]] FrameGeometry MakeGeometry(const WindowFrame& frame, const NavState& state,
                                         const CameraCalibration& camera);
/// Of all frames, at their present states.
[[nodiscard]] std::vector<FrameGeometry> MakeGeometry(const Window& window, const CameraCalibration& camera);
/// With a camera that saw at the frames' stamps.
[[nodiscard]] std::vector<FrameGeometry> MakeGeometry(const Window& window, const Pose& T_BC);

/// d zeta_C / d calibration of a frame's camera at a fixed body pose, in the layout's columns. The intrinsics
/// do not move it.
using CameraFromCalibration =
    Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, CalibrationLayout::kMaxSize>;
[[nodiscard]] CameraFromCalibration CalibrationChain(const CalibrationLayout& layout,
                                                     const FrameGeometry& frame);

}  // namespace alidade
