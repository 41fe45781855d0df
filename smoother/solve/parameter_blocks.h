#pragma once

#include <ceres/evaluation_callback.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "smoother/manifold/lifted_cost.h"
#include "smoother/window/window.h"
#include "smoother/window/window_calibration.h"
#include "smoother/window/window_point.h"

namespace alidade {

/// The parameter blocks of one solve. They lie in one array in a fixed order: Ceres sorts the blocks of an
/// elimination group by ADDRESS, so blocks scattered over the heap would make the rounding depend on its
/// history.
class ParameterBlocks {
 public:
  /// Copies states and landmarks; `frames`, `tracks` and `calibration` must outlive the blocks. The centre of
  /// the states' manifold is the last frame.
  ParameterBlocks(ErrorConvention error, const WindowFrames& frames, const std::vector<WindowTrack*>& tracks,
                  const WindowCalibration& calibration);

  [[nodiscard]] double* Nav(int frame) { return &parameters_[kFrameStride * static_cast<size_t>(frame)]; }
  [[nodiscard]] double* Bias(int frame) { return Nav(frame) + kNavAmbientSize; }
  [[nodiscard]] double* Landmark(int track) {
    return &parameters_[kFrameStride * frames_.size() + kLandmarkStride * static_cast<size_t>(track)];
  }
  /// Of an aligned window.
  [[nodiscard]] double* Clock(int frame) {
    return Landmark(static_cast<int>(tracks_.size())) + kClockStride * static_cast<size_t>(frame);
  }
  /// Its error; coordinates beyond those of the layout are constant.
  [[nodiscard]] double* Calibration() { return Clock(static_cast<int>(has_clocks_ ? frames_.size() : 0)); }
  /// A block by its kind and the index of its frame or track.
  [[nodiscard]] double* Find(BlockKind kind, int index);

  [[nodiscard]] int frames() const { return static_cast<int>(frames_.size()); }
  [[nodiscard]] int landmarks() const { return static_cast<int>(tracks_.size()); }
  [[nodiscard]] bool has_clocks() const { return has_clocks_; }

  [[nodiscard]] const WindowCalibration& calibration() const { return calibration_; }
  /// All parameters.
  [[nodiscard]] const std::vector<double>& values() const { return parameters_; }
  /// The states that they stand for. False: the calibration is no camera.
  bool PointAt(WindowPoint* point);

  /// A problem that owns nothing, with the blocks of all frames and of the calibration.
  [[nodiscard]] std::unique_ptr<ceres::Problem> MakeProblem(ceres::EvaluationCallback* callback);

  /// True when every parameter is a finite number.
  [[nodiscard]] bool IsFinite() const;
  /// Puts the parameters back into the frames and tracks they came from.
  void WriteBack() const;

 private:
  static constexpr size_t kFrameStride = 16;    // nav (10) and bias (6)
  static constexpr size_t kLandmarkStride = 4;  // one spare, so that every block stays 16-byte aligned
  static constexpr size_t kClockStride = 6;
  static constexpr size_t kCalibrationStride = 16;

  const WindowFrames& frames_;
  const std::vector<WindowTrack*>& tracks_;
  const WindowCalibration& calibration_;
  bool has_clocks_;
  std::vector<double> parameters_;
  NavStateManifold manifold_;
  std::unique_ptr<ceres::SubsetManifold> calibration_manifold_;
};

}  // namespace alidade
