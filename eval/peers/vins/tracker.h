#pragma once

#include <memory>
#include <vector>

#include "core/camera_model.h"
#include "core/status.h"
#include "eval/peers/vins_feature.h"
#include "frontend/tracking/image_reader.h"

namespace alidade::vins {

struct TrackerSettings {
  int max_features = 150;
  int min_distance_px = 30;
  double ransac_px = 1;  ///< at a focal length of 460 px
  bool equalize = true;
};

/// The tracker of VINS-Mono, or that of GVINS: this is compiled with either. Its settings are globals: one
/// object a process.
class __attribute__((visibility("default"))) Tracker {
 public:
  /// kInput: a lens model that it has not.
  static Result<std::unique_ptr<Tracker>> Create(const CameraModel& camera, const TrackerSettings& settings);
  virtual ~Tracker() = default;

  /// Tracks into an image of time `time_s`. Only of an image that is handed over are outliers rejected and
  /// gaps filled; returned are then the features seen in more than one image, else none.
  virtual std::vector<VinsFeature> Track(const GreyImage& image, double time_s, bool hand_over) = 0;

  /// Undistorts a pixel.
  [[nodiscard]] virtual Eigen::Vector3d Ray(const Eigen::Vector2d& pixel) const = 0;
};

}  // namespace alidade::vins
