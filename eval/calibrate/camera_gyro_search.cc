#include "eval/calibrate/camera_gyro_search.h"

#include <algorithm>
#include <array>
#include <optional>

#include "core/format.h"
#include "core/lie.h"
#include "eval/calibrate/gyro_path.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Of a view's error, as a share of the image's width: tracks that fit the gyroscope are within.
constexpr double kMostResidualShare = 0.003;
constexpr double kMostOutliers = 0.35;
/// A start that fits this well is not questioned.
constexpr double kGoodResidualShare = 0.001;
constexpr double kGoodOutliers = 0.1;

/// The pairs with the largest rotation, in the order of time, each with at most `views` of its views.
std::vector<FramePair> TurningPairs(const std::vector<FramePair>& pairs, const std::vector<ImuSample>& imu,
                                    double time_offset_s, std::size_t count, std::size_t views) {
  const GyroPath path(imu, Vector3d::Zero(), 1);
  std::vector<std::pair<double, std::size_t>> turns;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Matrix3d R_0i = path.At(pairs[k].t_i_s + time_offset_s).R_0t;
    const Matrix3d R_0j = path.At(pairs[k].t_j_s + time_offset_s).R_0t;
    turns.emplace_back(-so3::Log(R_0i.transpose() * R_0j).norm(), k);
  }
  std::sort(turns.begin(), turns.end());
  turns.resize(std::min(turns.size(), count));
  std::sort(turns.begin(), turns.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<FramePair> chosen;
  for (const auto& [turn, k] : turns) {
    FramePair pair{pairs[k].t_i_s, pairs[k].t_j_s, {}};
    const std::size_t total = pairs[k].views.size(), taken = std::min(views, total);
    for (std::size_t v = 0; v < taken; ++v) {
      pair.views.push_back(pairs[k].views[v * total / taken]);
    }
    chosen.push_back(std::move(pair));
  }
  return chosen;
}

/// All rotations that take axes into axes.
std::vector<Matrix3d> AxesConventions() {
  std::vector<Matrix3d> conventions;
  for (int x = 0; x < 3; ++x) {
    for (const int y : {(x + 1) % 3, (x + 2) % 3}) {
      for (const double sign_x : {1.0, -1.0}) {
        for (const double sign_y : {1.0, -1.0}) {
          Matrix3d R;
          R.col(0) = sign_x * Vector3d::Unit(x);
          R.col(1) = sign_y * Vector3d::Unit(y);
          R.col(2) = R.col(0).cross(R.col(1));
          conventions.push_back(R);
        }
      }
    }
  }
  return conventions;
}

/// Enough to distinguish a convention of axes from the others.
constexpr int kFewIterations = 5;

class Search {
 public:
  Search(const std::vector<ImuSample>& imu, const CameraGyroModel& given,
         const CameraGyroSearchOptions& options)
      : imu_(imu), given_(given), options_(options) {}

  void Try(const std::vector<FramePair>& pairs, const CameraGyroModel& start, double rotation_prior_rad,
           int iterations) {
    CameraGyroFitOptions fit;
    fit.iterations = iterations;
    fit.prior.segment<3>(CameraGyroCoordinate::kRotation).setConstant(rotation_prior_rad);
    fit.prior[CameraGyroCoordinate::kTimeOffset] = 0.05;
    fit.prior[CameraGyroCoordinate::kFocal] = 0.1;
    fit.pixel_noise_px = 1;
    fit.estimate_noise = false;
    for (const double factor : options_.focal_factors) {
      CameraGyroModel scaled = start;
      CameraGyroError focal = CameraGyroError::Zero();
      focal[CameraGyroCoordinate::kFocal] = factor - 1;
      if (!Retract(focal, &scaled)) {
        continue;
      }
      Result<CameraGyroFit> found = FitCameraToGyro(pairs, imu_, scaled, fit);
      if (found.ok() && (!best_ || found->cost < best_->cost)) {
        best_ = *std::move(found);
      }
    }
  }

  /// Spreads out from the middle, and ends at a start that fits well.
  void TryTimeOffsets(const std::vector<FramePair>& pairs, const CameraGyroModel& start, double step_s,
                      double rotation_prior_rad, int iterations) {
    constexpr double kReachS = 0.241;
    for (int step = 0; step * step_s < kReachS; ++step) {
      const double shift = step * step_s;
      for (const double sign : {1.0, -1.0}) {
        if ((step == 0 && sign < 0) || Fits(kGoodResidualShare, kGoodOutliers)) {
          continue;
        }
        CameraGyroModel shifted = start;
        shifted.time_offset_s += sign * shift;
        Try(pairs, shifted, rotation_prior_rad, iterations);
      }
    }
  }

  void TryConventions(const std::vector<FramePair>& pairs) {
    for (const double sign : {1.0, -1.0}) {
      for (const Matrix3d& R : AxesConventions()) {
        CameraGyroModel turned = given_;
        turned.gyro_sign = sign;
        turned.R_BC = R;
        TryTimeOffsets(pairs, turned, 0.12, 0.3, kFewIterations);
      }
    }
  }

  void Forget() { best_.reset(); }
  [[nodiscard]] const std::optional<CameraGyroFit>& best() const { return best_; }
  [[nodiscard]] bool explains() const { return Fits(kMostResidualShare, kMostOutliers); }

 private:
  [[nodiscard]] bool Fits(double residual_share, double outliers) const {
    return best_ && best_->residual_px < residual_share * given_.camera.width_px() &&
           best_->outliers < outliers;
  }

  const std::vector<ImuSample>& imu_;
  const CameraGyroModel& given_;
  const CameraGyroSearchOptions& options_;
  std::optional<CameraGyroFit> best_;
};

}  // namespace

Result<CameraGyroFit> FindCameraGyro(const std::vector<FramePair>& pairs, const std::vector<ImuSample>& imu,
                                     const CameraGyroModel& given, const CameraGyroSearchOptions& options) {
  constexpr double kNearRad = 0.2;
  constexpr int kIterations = 12;
  Search search(imu, given, options);
  const std::vector<FramePair> some = TurningPairs(pairs, imu, given.time_offset_s, 40, 30);
  search.TryTimeOffsets(some, given, 0.04, kNearRad, kIterations);
  if (!search.explains()) {
    const std::vector<FramePair> few = TurningPairs(pairs, imu, given.time_offset_s, 16, 20);
    search.Forget();
    search.TryConventions(few);
    if (search.best()) {
      const CameraGyroModel found = search.best()->model;
      search.Forget();
      search.TryTimeOffsets(some, found, 0.04, kNearRad, kIterations);
    }
  }
  if (!search.best()) {
    return FitCameraToGyro(some, imu, given, {}).status();
  }
  CameraGyroFitOptions all;
  all.prior = options.prior;
  Result<CameraGyroFit> fit = FitCameraToGyro(pairs, imu, search.best()->model, all);
  ALIDADE_RETURN_IF_ERROR(fit.status());
  if (fit->residual_px > kMostResidualShare * given.camera.width_px() || fit->outliers > kMostOutliers) {
    return Status::Input(
        Format("no rotation, time offset and focal length relate the images' motion to the "
               "gyroscope: tracks miss the epipolar lines by %.1f px, %.0f %% of them by four times "
               "that; expected at most %.1f px",
               fit->residual_px, 100 * fit->outliers, kMostResidualShare * given.camera.width_px()));
  }
  return fit;
}

}  // namespace alidade
