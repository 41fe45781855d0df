#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/camera_model.h"
#include "core/status.h"
#include "frontend/tracking/image_reader.h"

namespace alidade::vins_mono {

/// A feature in an image, as the solver takes it.
struct Feature {
  int id = 0;
  Eigen::Vector2d plane = Eigen::Vector2d::Zero();     ///< undistorted, normalised plane
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();     ///< raw [px]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< of `plane` [1/s]
};

struct TrackerSettings {
  int max_features = 150;
  int min_distance_px = 30;
  double ransac_px = 1;  ///< at a focal length of 460 px
  bool equalize = true;
};

/// VINS-Mono's tracker. Its settings are globals: one object a process.
class __attribute__((visibility("default"))) Tracker {
 public:
  /// kInput: a lens model that it has not.
  static Result<std::unique_ptr<Tracker>> Create(const CameraModel& camera, const TrackerSettings& settings);
  virtual ~Tracker() = default;

  /// Tracks into an image of time `time_s`. Only of an image that is handed over are outliers rejected and
  /// gaps filled; returned are then the features seen in more than one image, else none.
  virtual std::vector<Feature> Track(const GreyImage& image, double time_s, bool hand_over) = 0;
};

}  // namespace alidade::vins_mono
