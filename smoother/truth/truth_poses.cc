#include "smoother/truth/truth_poses.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"

namespace alidade {
namespace {

constexpr double kHuberSigma = 2;
// Deviations assumed before any residual is known [rad, m].
constexpr TruthNoise kFirstNoise{0.02, 0.01};
// Median of the chi-square distribution of three degrees of freedom.
constexpr double kMedianOfThree = 2.3660;
// Keeps a truth that was made with this IMU, which fits it exactly, from a noise of zero [rad, m], and one
// step from going too far. Files hold five or six digits.
constexpr TruthNoise kMinNoise{1e-5, 1e-5};
constexpr double kMinRatio = 0.01;
// The autocorrelation of the residuals is added up to here.
constexpr size_t kMaxLag = 2000;
constexpr double kVanishing = 0.05;

double Square(double x) {
  return x * x;
}

double OrientationSquare(const Vector6d& residual) {
  return residual.head<3>().squaredNorm();
}

double PositionSquare(const Vector6d& residual) {
  return residual.tail<3>().squaredNorm();
}

}  // namespace

TruthPoses::TruthPoses(std::span<const TruthPose> poses, double gate_probability, const TruthNoise& given)
    : gate_(gate_probability, 3), given_(given), noise_(kFirstNoise) {
  for (const TruthPose& pose : poses) {
    poses_.push_back({pose, std::nullopt});
  }
  TakeGivenNoise();
}

void TruthPoses::TakeGivenNoise() {
  noise_.orientation_rad = given_.orientation_rad > 0
                               ? given_.orientation_rad
                               : std::max(noise_.orientation_rad, kMinNoise.orientation_rad);
  noise_.position_m =
      given_.position_m > 0 ? given_.position_m : std::max(noise_.position_m, kMinNoise.position_m);
}

void TruthPoses::Attach(std::span<const ImuSample> imu, double time_offset_s) {
  size_t i = 0;
  for (GatedPose& pose : poses_) {
    const TimeNs stamp_ns = pose.pose.stamp_ns + SecondsToNs(time_offset_s);
    while (i + 2 < imu.size() && imu[i + 1].stamp_ns <= stamp_ns) {
      ++i;
    }
    const bool inside = stamp_ns >= imu[i].stamp_ns && stamp_ns < imu[i + 1].stamp_ns;
    pose.state = inside ? std::optional(i) : std::nullopt;
  }
}

double TruthPoses::RobustWeightOf(const Vector6d& residual) const {
  return RobustWeight(RobustKernel::kHuber, kHuberSigma,
                      OrientationSquare(residual) / Square(noise_.orientation_rad) +
                          PositionSquare(residual) / Square(noise_.position_m));
}

void TruthPoses::EstimateRobustNoise() {
  std::vector<double> orientation, position;
  for (const GatedPose& pose : poses_) {
    if (pose.state) {
      orientation.push_back(OrientationSquare(pose.residual));
      position.push_back(PositionSquare(pose.residual));
    }
  }
  if (!orientation.empty()) {
    noise_ = {std::sqrt(Median(std::move(orientation)) / kMedianOfThree),
              std::sqrt(Median(std::move(position)) / kMedianOfThree)};
    TakeGivenNoise();
  }
}

size_t TruthPoses::Gate() {
  size_t changed = 0;
  for (GatedPose& pose : poses_) {
    if (pose.state) {
      const bool passes =
          gate_.Accepts(OrientationSquare(pose.residual) / Square(noise_.orientation_rad), 3) &&
          gate_.Accepts(PositionSquare(pose.residual) / Square(noise_.position_m), 3);
      changed += passes == pose.passes ? 0 : 1;
      pose.passes = passes;
    }
  }
  return changed;
}

void TruthPoses::EstimateNoise(const TruthNoise& hat) {
  double rows = 0;
  TruthNoise squares;
  for (const GatedPose& pose : poses_) {
    if (pose.used()) {
      rows += 3;
      squares.orientation_rad += OrientationSquare(pose.residual);
      squares.position_m += PositionSquare(pose.residual);
    }
  }
  orientation_ = {squares.orientation_rad / Square(noise_.orientation_rad),
                  rows - hat.orientation_rad / Square(noise_.orientation_rad)};
  position_ = {squares.position_m / Square(noise_.position_m),
               rows - hat.position_m / Square(noise_.position_m)};
  noise_.orientation_rad *= std::sqrt(std::max(orientation_.ratio(), kMinRatio));
  noise_.position_m *= std::sqrt(std::max(position_.ratio(), kMinRatio));
  TakeGivenNoise();
}

double TruthPoses::Correlation(int row) const {
  std::vector<Eigen::Vector3d> series;
  double variance = 0;
  for (const GatedPose& pose : poses_) {
    if (pose.used()) {
      series.emplace_back(pose.residual.segment<3>(row));
      variance += series.back().squaredNorm();
    }
  }
  double sum = 1;
  for (size_t lag = 1; lag < std::min(series.size(), kMaxLag); ++lag) {
    double product = 0;
    for (size_t i = lag; i < series.size(); ++i) {
      product += series[i].dot(series[i - lag]);
    }
    if (!(product > kVanishing * variance)) {
      break;
    }
    sum += 2 * product / variance;
  }
  return sum;
}

std::vector<TruthSpan> TruthPoses::Gaps(double longer_than_s, double time_offset_s) const {
  const TimeNs offset_ns = SecondsToNs(time_offset_s);
  std::vector<TruthSpan> gaps;
  const GatedPose* last = nullptr;
  for (const GatedPose& pose : poses_) {
    if (pose.used()) {
      if (last != nullptr && SecondsBetween(last->pose.stamp_ns, pose.pose.stamp_ns) > longer_than_s) {
        gaps.push_back({last->pose.stamp_ns + offset_ns, pose.pose.stamp_ns + offset_ns});
      }
      last = &pose;
    }
  }
  return gaps;
}

TruthSpan TruthPoses::Extent(double time_offset_s) const {
  const TimeNs offset_ns = SecondsToNs(time_offset_s);
  const auto used = [](const GatedPose& pose) { return pose.used(); };
  const auto first = std::find_if(poses_.begin(), poses_.end(), used);
  const auto last = std::find_if(poses_.rbegin(), poses_.rend(), used);
  if (first == poses_.end()) {
    return {};
  }
  return {first->pose.stamp_ns + offset_ns, last->pose.stamp_ns + offset_ns};
}

}  // namespace alidade
