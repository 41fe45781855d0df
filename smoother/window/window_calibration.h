#pragma once

#include "core/calibration.h"

namespace alidade {

/// The camera of a window, and which part of its calibration is estimated: with an empty layout nothing is,
/// and there is no parameter block. The block holds the error of `mean` in the layout's coordinates:
/// CalibrationLayout::kMaxSize numbers, of which the first layout.size() move.
struct WindowCalibration {
  CalibrationLayout layout;
  CameraCalibration mean;

  [[nodiscard]] int size() const { return layout.size(); }
  /// The block of the calibration among those of a factor; null when nothing is estimated.
  [[nodiscard]] const double* Block(const double* const* parameters, size_t index) const {
    return size() > 0 ? parameters[index] : nullptr;
  }
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
