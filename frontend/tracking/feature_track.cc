#include "frontend/tracking/feature_track.h"

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "core/bearing_plane.h"
#include "core/turned_ray.h"

namespace alidade {
namespace {

// Smaller errors count little beside those of lens and calibration.
constexpr double kUsualErrorPx = 0.1;
// Of Lucas-Kanade alone, after a backward pass.
constexpr double kUnconfirmedErrorPx = 0.5;
// With a ten-thousandth of the weight an observation has no effect.
constexpr double kMostNoiseRatio = 100;

/// What makes two patches differ is not white noise but other depths, blur and light, and the more they
/// differ, the more of it shifts the match.
double MatchErrorPx(double deviation_px) {
  constexpr double kFactor = 4;
  constexpr double kGrowthPerPx = 25;
  return kFactor * deviation_px * (1 + kGrowthPerPx * deviation_px);
}

}  // namespace

double FeatureTrack::NoiseRatio() const {
  const double ratio = std::hypot(1, match_error_px / kUsualErrorPx, template_error_px / kUsualErrorPx);
  return ratio < kMostNoiseRatio ? ratio : kMostNoiseRatio;
}

std::vector<cv::Point2f> Pixels(const std::vector<FeatureTrack>& tracks) {
  std::vector<cv::Point2f> pixels;
  pixels.reserve(tracks.size());
  for (const FeatureTrack& track : tracks) {
    pixels.push_back(track.pixel);
  }
  return pixels;
}

TrackFrame ToFrame(TimeNs stamp_ns, const std::vector<FeatureTrack>& tracks) {
  TrackFrame frame;
  frame.stamp_ns = stamp_ns;
  frame.observations.reserve(tracks.size());
  for (const FeatureTrack& track : tracks) {
    frame.observations.push_back({track.id, ToVector(track.pixel), track.NoiseRatio()});
  }
  return frame;
}

std::vector<cv::Point2f> PredictedPixels(const std::vector<FeatureTrack>& tracks,
                                         const std::optional<Eigen::Matrix3d>& R_C1C0,
                                         const CameraModel& camera) {
  std::vector<cv::Point2f> predicted = Pixels(tracks);
  if (!R_C1C0.has_value()) {
    return predicted;
  }
  for (size_t i = 0; i < tracks.size(); ++i) {
    Eigen::Vector2d pixel;
    // A track the rotation takes out of the camera's domain is searched where it was, and lost there.
    if (camera.Project(TurnedRay(*R_C1C0, tracks[i].ray), &pixel)) {
      predicted[i] = ToPoint(pixel);
    }
  }
  return predicted;
}

int Keep(const std::vector<bool>& marked, std::vector<FeatureTrack>* tracks) {
  size_t kept = 0;
  for (size_t i = 0; i < tracks->size(); ++i) {
    if (marked[i]) {
      if (kept != i) {
        (*tracks)[kept] = std::move((*tracks)[i]);
      }
      ++kept;
    }
  }
  const int removed = static_cast<int>(tracks->size() - kept);
  tracks->resize(kept);
  return removed;
}

Eigen::Matrix2f DeformationBy(const std::optional<Eigen::Matrix3d>& R_C1C0, const CameraModel& camera,
                              const FeatureTrack& track) {
  Eigen::Vector2d before, after;
  Eigen::Matrix<double, 2, 3> before_from_bearing, after_from_bearing;
  if (!R_C1C0.has_value() || !camera.Project(track.ray, &before, &before_from_bearing) ||
      !camera.Project(*R_C1C0 * track.ray, &after, &after_from_bearing)) {
    return Eigen::Matrix2f::Identity();
  }
  if (camera.plane() == ObservationPlane::kTangent) {
    const Eigen::Matrix<double, 3, 2> across = BearingPlane::TangentAt(track.ray).axes().leftCols<2>();
    const Eigen::Matrix2d deformation =
        after_from_bearing * *R_C1C0 * across * (before_from_bearing * across).inverse();
    return deformation.cast<float>();
  }
  const Eigen::Matrix2d deformation =
      after_from_bearing * R_C1C0->leftCols<2>() * before_from_bearing.leftCols<2>().inverse();
  return deformation.cast<float>();
}

void BeginTemplate(const cv::Mat& image, const FrontendConfig& config, const cv::Point2f& pixel,
                   FeatureTrack* track) {
  const Eigen::Vector2f centre(pixel.x, pixel.y);
  track->patch = PatchTemplate::Fits(image, centre, config.template_px)
                     ? PatchTemplate(image, centre, config.template_px)
                     : PatchTemplate();
  track->affine = Eigen::Matrix2f::Identity();
  track->template_error_px = std::hypot(track->template_error_px, track->match_error_px);
  track->match_error_px = 0;
}

bool MatchTemplate(const cv::Mat& image, const FrontendConfig& config, const Eigen::Matrix2f& deformation,
                   FeatureTrack* track, cv::Point2f* pixel) {
  TemplateMatch match{
      .centre = {pixel->x, pixel->y}, .affine = deformation * track->affine, .correlation = 0};
  if (!track->patch.Align(image, &match) || static_cast<double>(match.correlation) < config.min_correlation) {
    track->match_error_px = kUnconfirmedErrorPx;
    return false;
  }
  track->match_error_px = MatchErrorPx(match.deviation_px);
  *pixel = {match.centre.x(), match.centre.y()};
  track->affine = match.affine;
  if (PatchTemplate::IsWornOut(match.affine) &&
      PatchTemplate::Fits(image, match.centre, config.template_px)) {
    BeginTemplate(image, config, *pixel, track);
  }
  return true;
}

}  // namespace alidade
