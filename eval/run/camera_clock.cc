#include "eval/run/camera_clock.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/median.h"
#include "frontend/initialization/epipolar_ray.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void CameraClock::AddImu(const ImuSample& sample) {
  if (gyro_.Add(sample)) {
    gyro_.DropBefore(sample.stamp_ns - SecondsToNs(1.5 * kMostStepS));
  }
}

std::optional<TimeNs> CameraClock::Period() const {
  constexpr std::size_t kLeast = 5;
  if (steps_.size() < kLeast) {
    return std::nullopt;
  }
  return static_cast<TimeNs>(Median({steps_.begin(), steps_.end()}));
}

std::optional<double> CameraClock::Misfit(const TrackFrame& a, const TrackFrame& b,
                                          const Matrix3d& R_ab) const {
  const CameraModel& camera = rig_.camera;
  const double sigma = std::sqrt(2.0) * pixel_noise_px_ / camera.mean_focal_px();
  const Matrix3d R_BC = rig_.T_BC.rotation;
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

std::optional<TimeNs> CameraClock::FindJump(const TrackFrame& frame, TimeNs imu_ns,
                                            const Vector3d& gyro_bias) {
  constexpr std::size_t kRemembered = 15;
  std::optional<TimeNs> jump;
  const std::optional<TimeNs> period = Period();
  const TimeNs step_ns = last_ ? imu_ns - last_->imu_ns : 0;
  const bool opens = !step_ && period && SecondsBetween(0, step_ns) > kLeastStepS &&
                     SecondsBetween(0, step_ns) < kMostStepS &&
                     SecondsBetween(0, step_ns) > kLeastPeriods * SecondsBetween(0, *period);
  if (opens) {
    step_ = Step{*last_, step_ns - *period, imu_ns + SecondsToNs(kDoubtS)};
  } else if (step_ns > 0) {
    steps_.push_back(step_ns);
  }
  while (steps_.size() > kRemembered) {
    steps_.pop_front();
  }
  if (step_) {
    const TimeNs before_ns = step_->before.imu_ns;
    const auto misfit = [&](TimeNs until_ns) {
      const std::optional<Matrix3d> turn = gyro_.Between(before_ns, until_ns, gyro_bias);
      return turn ? Misfit(step_->before.frame, frame, *turn) : std::nullopt;
    };
    const std::optional<double> as_is = misfit(imu_ns);
    const std::optional<double> jumped = misfit(imu_ns - step_->excess_ns);
    const bool stamps_hold = as_is && jumped && *jumped > kContrast * *as_is && *as_is < kFits;
    const bool stamps_jumped =
        as_is && jumped && *as_is > kContrast * std::max(1.0, *jumped) && *jumped < kFits;
    if (stamps_jumped) {
      jump = step_->excess_ns;
      imu_ns -= *jump;
    }
    if (stamps_jumped || stamps_hold || !as_is || imu_ns > step_->end_ns) {
      step_.reset();
    }
  }
  last_ = Seen{frame, imu_ns};
  return jump;
}

}  // namespace alidade
