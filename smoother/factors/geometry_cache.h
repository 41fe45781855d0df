#pragma once

#include <array>
#include <vector>

#include "smoother/manifold/lifted_cost.h"
#include "smoother/window/frame_geometry.h"
#include "smoother/window/window_calibration.h"

namespace alidade {

/// Where the camera was in the frames of a window, at the parameters of the last evaluation: the factors of
/// all views of a frame ask for the same.
class GeometryCache {
 public:
  /// `calibration` must outlive it.
  GeometryCache(const WindowCalibration& calibration, size_t frames);

  /// The camera of a calibration's block, for the frames asked for next. Null:
  /// the block is no camera.
  const WindowCalibration* Camera(const double* block);
  /// A frame at the state of its block, with that camera.
  const FrameGeometry& Frame(const WindowFrame& frame, const double* nav);

 private:
  struct Entry {
    std::array<double, kNavAmbientSize> nav;
    FrameGeometry geometry;
    bool valid = false;
  };

  const WindowCalibration* calibration_;
  WindowCalibration camera_;
  std::vector<double> block_;  ///< of camera_
  std::vector<Entry> entries_;
};

}  // namespace alidade
