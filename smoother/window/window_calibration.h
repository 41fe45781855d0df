#pragma once

#include "core/calibration.h"

namespace alidade {

/// The camera of a window, and which part of its calibration is estimated: nothing of it with an empty
/// layout. Its parameter block holds the error of `mean` in the layout's coordinates:
/// CalibrationLayout::kMaxSize numbers, of which the first layout.size() move.
struct WindowCalibration {
  CalibrationLayout layout;
  CameraCalibration mean;

  [[nodiscard]] int size() const { return layout.size(); }
  /// The calibration that a block stands for. False when that is no camera.
  bool At(const double* block, CameraCalibration* calibration) const;
  /// d (error of At(block)) / d block, size x size: the identity but for the rotation.
  [[nodiscard]] Eigen::MatrixXd BlockJacobian(const double* block) const;
};

/// The calibration of a window that estimates none.
[[nodiscard]] const WindowCalibration& NotCalibrated();

/// d Local(layout, origin, Retract(layout, error, estimate)) / d error at 0, size x size.
[[nodiscard]] Eigen::MatrixXd LocalJacobian(const CalibrationLayout& layout, const CameraCalibration& origin,
                                            const CameraCalibration& estimate);

}  // namespace alidade
