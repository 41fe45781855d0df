#include "eval/calibrate/gyro_correlation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <optional>

#include "core/format.h"
#include "core/gyro_rotation.h"
#include "core/median.h"
#include "core/robust.h"
#include "eval/dataset/sensor_yaml.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLeastStepS = 0.09;
constexpr double kLongestStepS = 0.35;

/// A landmark's rays in two frames: their difference and their mean.
struct RayChange {
  Vector3d difference, mean;
};

std::vector<RayChange> SharedRays(const CameraModel& camera, const TrackFrame& i, const TrackFrame& j) {
  constexpr std::size_t kMostRays = 100;
  std::vector<RayChange> rays;
  auto in_j = j.observations.begin();
  for (const TrackObservation& seen : i.observations) {
    while (in_j != j.observations.end() && in_j->track_id < seen.track_id) {
      ++in_j;
    }
    Vector3d ray_i;
    Vector3d ray_j;
    if (in_j != j.observations.end() && in_j->track_id == seen.track_id &&
        camera.Bearing(seen.pixel, &ray_i) && camera.Bearing(in_j->pixel, &ray_j)) {
      rays.push_back({ray_i - ray_j, 0.5 * (ray_i + ray_j)});
    }
    if (rays.size() == kMostRays) {
      break;
    }
  }
  return rays;
}

/// Rotation vector of R_ij, f_i = R_ij f_j, to second order; empty with too few rays.
std::optional<Vector3d> RotationOf(const std::vector<RayChange>& rays) {
  constexpr std::size_t kLeastRays = 12;
  constexpr int kRounds = 6;
  if (rays.size() < kLeastRays) {
    return std::nullopt;
  }
  std::vector<double> weights(rays.size(), 1);
  Vector3d rotation = Vector3d::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Matrix3d information = Matrix3d::Zero();
    Vector3d gradient = Vector3d::Zero();
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const Vector3d& m = rays[k].mean;
      information += weights[k] * (m.squaredNorm() * Matrix3d::Identity() - m * m.transpose());
      gradient += weights[k] * m.cross(rays[k].difference);
    }
    rotation = information.ldlt().solve(gradient);
    std::vector<double> residuals;
    residuals.reserve(rays.size());
    for (const RayChange& ray : rays) {
      residuals.push_back((ray.difference - rotation.cross(ray.mean)).norm());
    }
    constexpr double kLeastScale = 1e-6;  // of noise-free rays
    const double scale = Median(residuals) + kLeastScale;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      weights[k] = RobustWeight(RobustKernel::kCauchy, scale, residuals[k] * residuals[k]);
    }
  }
  return rotation.allFinite() ? std::optional(rotation) : std::nullopt;
}

/// Integral of the angular rate's components over time: over a tenth of a second their differences are
/// rotation vectors, in whatever unit the gyroscope has.
class RateIntegral {
 public:
  void Add(const ImuSample& sample) {
    if (!stamps_ns_.empty()) {
      const double dt_s = SecondsBetween(stamps_ns_.back(), sample.stamp_ns);
      integrals_.emplace_back(integrals_.back() + TurnOverStep(last_, sample.gyro, dt_s));
    } else {
      integrals_.emplace_back(Vector3d::Zero());
    }
    stamps_ns_.push_back(sample.stamp_ns);
    last_ = sample.gyro;
  }

  /// Norm of the mean rate between two times; empty beyond the samples.
  [[nodiscard]] std::optional<double> MeanRate(TimeNs from_ns, TimeNs to_ns) const {
    if (stamps_ns_.size() < 2 || from_ns < stamps_ns_.front() || to_ns > stamps_ns_.back()) {
      return std::nullopt;
    }
    return (At(to_ns) - At(from_ns)).norm() / SecondsBetween(from_ns, to_ns);
  }

 private:
  [[nodiscard]] Vector3d At(TimeNs t_ns) const {
    const auto next = std::upper_bound(stamps_ns_.begin() + 1, stamps_ns_.end() - 1, t_ns);
    const auto k = static_cast<std::size_t>(next - stamps_ns_.begin());
    const double share =
        SecondsBetween(stamps_ns_[k - 1], t_ns) / SecondsBetween(stamps_ns_[k - 1], stamps_ns_[k]);
    return integrals_[k - 1] + share * (integrals_[k] - integrals_[k - 1]);
  }

  std::vector<TimeNs> stamps_ns_;
  std::vector<Vector3d> integrals_;
  Vector3d last_ = Vector3d::Zero();
};

LaggedRates RatesAt(const std::vector<ImageTurn>& turns, const RateIntegral& gyro, TimeNs offset_ns,
                    double lag_s) {
  double images = 0, rates = 0, images_square = 0, rates_square = 0, product = 0;
  LaggedRates nothing;
  nothing.lag_s = lag_s;
  LaggedRates lagged = nothing;
  const TimeNs shift_ns = offset_ns + SecondsToNs(lag_s);
  for (const ImageTurn& turn : turns) {
    if (const std::optional<double> rate = gyro.MeanRate(turn.i_ns + shift_ns, turn.j_ns + shift_ns)) {
      const double image = turn.rate_C.norm();
      images += image;
      rates += *rate;
      images_square += image * image;
      rates_square += *rate * *rate;
      product += image * *rate;
      lagged.span_s += SecondsBetween(turn.i_ns, turn.j_ns);
      ++lagged.turns;
    }
  }
  // Over a few seconds of smooth motion, some lag of the many that are tried agrees by chance.
  constexpr double kLeastSpanS = 15, kLeastNearS = 5;
  const double least_s = std::abs(lag_s) <= GyroCorrelation::kNearS ? kLeastNearS : kLeastSpanS;
  if (2 * lagged.turns < turns.size() || lagged.span_s < least_s) {
    return nothing;
  }
  const double n = static_cast<double>(lagged.turns);
  const double variances = (images_square - images * images / n) * (rates_square - rates * rates / n);
  lagged.correlation = variances > 0 ? (product - images * rates / n) / std::sqrt(variances) : 0;
  lagged.scale = images_square > 0 ? std::sqrt(rates_square / images_square) : 0;
  return lagged;
}

}  // namespace

std::vector<ImageTurn> TurnsOfImages(const CameraModel& camera, const Table<TrackFrame>& frames) {
  constexpr double kSpanS = 120;
  constexpr double kNotableRate = 0.05;  // [rad/s], five times what a pixel of noise makes of rest
  std::vector<ImageTurn> turns;
  std::optional<TrackFrame> before;
  Table<TrackFrame>::Pass pass(frames);
  // A file that cannot be read again is reported by its next reader.
  for (Result<const TrackFrame*> next = pass.Next(); next.ok() && *next != nullptr; next = pass.Next()) {
    const TrackFrame& frame = **next;
    if (!turns.empty() && SecondsBetween(turns.front().i_ns, frame.stamp_ns) > kSpanS) {
      break;
    }
    const double step_s = before ? SecondsBetween(before->stamp_ns, frame.stamp_ns) : INFINITY;
    if (step_s < kLeastStepS) {
      continue;
    }
    const std::optional<Vector3d> rotation =
        step_s < kLongestStepS ? RotationOf(SharedRays(camera, *before, frame)) : std::nullopt;
    if (rotation && (!turns.empty() || rotation->norm() > kNotableRate * step_s)) {
      turns.push_back({before->stamp_ns, frame.stamp_ns, *rotation / step_s});
    }
    before = frame;
  }
  return turns;
}

GyroCorrelation CorrelateGyro(const std::vector<ImageTurn>& turns, const Table<ImuSample>& imu,
                              double time_offset_s) {
  constexpr double kLagStepS = 0.04;
  constexpr double kPeakS = 0.5;
  GyroCorrelation result;
  if (turns.empty()) {
    return result;
  }
  const TimeNs offset_ns = SecondsToNs(time_offset_s);
  const TimeNs margin_ns = SecondsToNs(GyroCorrelation::kReachS + 1);
  RateIntegral gyro;
  static_cast<void>(imu.ForEach([&](const ImuSample& sample) {
    const TimeNs camera_ns = sample.stamp_ns - offset_ns;
    if (camera_ns > turns.front().i_ns - margin_ns && camera_ns < turns.back().j_ns + margin_ns) {
      gyro.Add(sample);
    }
  }));
  std::vector<LaggedRates> lags;
  const int steps = static_cast<int>(std::lround(GyroCorrelation::kReachS / kLagStepS));
  for (int k = -steps; k <= steps; ++k) {
    lags.push_back(RatesAt(turns, gyro, offset_ns, k * kLagStepS));
  }
  const auto take = [](const LaggedRates& lagged, LaggedRates* best) {
    if (lagged.turns > 0 && (best->turns == 0 || lagged.correlation > best->correlation)) {
      *best = lagged;
    }
  };
  for (const LaggedRates& lagged : lags) {
    take(lagged, &result.best);
    if (std::abs(lagged.lag_s) <= GyroCorrelation::kNearS) {
      take(lagged, &result.near);
    }
  }
  for (const LaggedRates& lagged : lags) {
    if (std::abs(lagged.lag_s - result.best.lag_s) > kPeakS) {
      take(lagged, &result.other);
    }
  }
  return result;
}

std::string DescribeClocks(const GyroCorrelation& rates, double sheet_time_offset_s) {
  const double offset_s = sheet_time_offset_s + rates.best.lag_s;
  const std::string expected =
      std::abs(offset_s) <= kMostCameraOffsetS
          ? Format("expected time_offset_s: %.2f in its sheet", offset_s)
          : Format("shift the stamps by %+.2f s, as time_offset_s is within +-%.0f s", rates.best.lag_s,
                   kMostCameraOffsetS);
  return Format(
      "the clocks of camera and imu0 differ: the rotation rates of images and gyroscope agree when the "
      "camera's stamps are moved by %+.2f s (correlation %.2f), and not as they are (%.2f); %s",
      rates.best.lag_s, rates.best.correlation, rates.near.correlation, expected.c_str());
}

}  // namespace alidade
