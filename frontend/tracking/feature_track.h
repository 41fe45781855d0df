#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "core/camera_model.h"
#include "core/frontend_config.h"
#include "core/track_frame.h"
#include "frontend/tracking/patch_template.h"

namespace alidade {

/// A corner that is followed from image to image.
struct FeatureTrack {
  std::int64_t id = 0;
  cv::Point2f pixel;                                     ///< in the last image
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();        ///< the same as a direction (PixelRay)
  int length = 1;                                        ///< images it was seen in
  PatchTemplate patch;                                   ///< what it looked like when it began
  Eigen::Matrix2f affine = Eigen::Matrix2f::Identity();  ///< how that lies in the last image
  // Expected errors of a coordinate, as root mean squares [px]; 0 without templates.
  double match_error_px = 0;     ///< in the last image, from where the patch began
  double template_error_px = 0;  ///< of that place, from where the track began

  /// TrackObservation's, in the last image: sqrt(1 + (error / kUsualErrorPx)^2), at most 100.
  [[nodiscard]] double NoiseRatio() const;
};

[[nodiscard]] inline cv::Point2f ToPoint(const Eigen::Vector2d& pixel) {
  return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}
[[nodiscard]] inline Eigen::Vector2d ToVector(const cv::Point2f& pixel) {
  return {pixel.x, pixel.y};
}

[[nodiscard]] std::vector<cv::Point2f> Pixels(const std::vector<FeatureTrack>& tracks);

/// Their observations in the last image, of this stamp.
[[nodiscard]] TrackFrame ToFrame(TimeNs stamp_ns, const std::vector<FeatureTrack>& tracks);

/// Where the camera's rotation since the last image takes them; where they were without a rotation.
[[nodiscard]] std::vector<cv::Point2f> PredictedPixels(const std::vector<FeatureTrack>& tracks,
                                                       const std::optional<Eigen::Matrix3d>& R_C1C0,
                                                       const CameraModel& camera);

/// Removes the tracks not marked; the others keep their order. Returns how many went.
int Keep(const std::vector<bool>& marked, std::vector<FeatureTrack>* tracks);

/// d pixel in this image / d pixel in the last one, 2x2, of a track far away when the camera turns by R_C1C0.
/// Identity without a rotation, or where the lens model ends.
[[nodiscard]] Eigen::Matrix2f DeformationBy(const std::optional<Eigen::Matrix3d>& R_C1C0,
                                            const CameraModel& camera, const FeatureTrack& track);

/// Takes the patch around `pixel` as the track's template; none where the image ends too near. The track's
/// error there becomes one of the template.
void BeginTemplate(const cv::Mat& image, const FrontendConfig& config, const cv::Point2f& pixel,
                   FeatureTrack* track);

/// Matches a track that went to `pixel` of `image` with its template, deformed by `deformation` since the
/// last image: improves pixel and affine, and begins a new template where the old one is worn out. False when
/// the image does not look like the template (frontend.min_correlation) or there is none; pixel then stays,
/// as Lucas-Kanade alone found it.
bool MatchTemplate(const cv::Mat& image, const FrontendConfig& config, const Eigen::Matrix2f& deformation,
                   FeatureTrack* track, cv::Point2f* pixel);

}  // namespace alidade
