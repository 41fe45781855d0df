#include "eval/run/turn_misfit.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/median.h"
#include "frontend/initialization/epipolar_ray.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::optional<double> TurnMisfit(const RigCalibration& rig, double pixel_noise_px, const TrackFrame& a,
                                 const TrackFrame& b, const Matrix3d& R_ab) {
  const CameraModel& camera = rig.camera;
  const double sigma = std::sqrt(2.0) * pixel_noise_px / camera.mean_focal_px();
  const Matrix3d R_BC = rig.T_BC.rotation;
  std::vector<EpipolarRay> rays;
  auto seen = a.observations.begin();
  for (const TrackObservation& now : b.observations) {
    while (seen != a.observations.end() && seen->track_id < now.track_id) {
      ++seen;
    }
    if (seen == a.observations.end() || seen->track_id != now.track_id) {
      continue;
    }
    Vector3d ray_a;
    Vector3d ray_b;
    if (camera.Bearing(seen->pixel, &ray_a) && camera.Bearing(now.pixel, &ray_b)) {
      EpipolarRay ray{R_BC * ray_a, R_ab * (R_BC * ray_b), {}, sigma};
      ray.normal = ray.ray_i.cross(ray.ray_j);
      rays.push_back(ray);
    }
  }
  constexpr int kLeastTracks = 12;
  if (static_cast<int>(rays.size()) < kLeastTracks) {
    return std::nullopt;
  }
  constexpr double kKernelSigma = 2;
  constexpr double kMedianOfChiSquare = 0.455;
  std::vector<double> weights;
  const Vector3d direction = TranslationDirection(rays, kKernelSigma, &weights);
  std::vector<double> squares;
  for (const EpipolarRay& ray : rays) {
    const double distance = direction.dot(ray.normal);
    squares.push_back(distance * distance / EpipolarVariance(ray, direction));
  }
  return Median(std::move(squares)) / kMedianOfChiSquare;
}

ClockVerdict CompareTurns(const std::optional<double>& as_is, const std::optional<double>& jumped,
                          double contrast) {
  constexpr double kFits = 4;  // largest squared distance of an explanation that holds
  if (!as_is) {
    return ClockVerdict::kUnknown;
  }
  if (!jumped) {
    return ClockVerdict::kOpen;
  }
  if (*as_is > contrast * std::max(1.0, *jumped) && *jumped < kFits) {
    return ClockVerdict::kJumped;
  }
  return *jumped > contrast * *as_is && *as_is < kFits ? ClockVerdict::kHolds : ClockVerdict::kOpen;
}

ClockVerdict ClockVotes::Add(const std::optional<double>& as_is, const std::optional<double>& jumped) {
  const ClockVerdict alone = CompareTurns(as_is, jumped);
  if (alone != ClockVerdict::kOpen) {
    return alone;
  }
  const ClockVerdict vote = CompareTurns(as_is, jumped, kContrast);
  in_a_row_ = vote == last_ ? in_a_row_ + 1 : 1;
  last_ = vote;
  return in_a_row_ < kFrames ? ClockVerdict::kOpen : vote;
}

}  // namespace alidade
