#include "eval/calibrate/camera_gyro_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/dense_solvers.h"
#include "core/format.h"
#include "core/median.h"
#include "core/robust.h"
#include "eval/calibrate/block_scatter.h"
#include "eval/calibrate/camera_gyro_equations.h"
#include "eval/calibrate/gyro_path.h"
#include "frontend/initialization/epipolar_ray.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Coordinate = CameraGyroCoordinate;

/// Cost of a view that the lens model cannot take, as of one four sigma off.
constexpr double kUnseenSquared = 16;
/// Variances of real recordings over those of independent errors, where one is too short to show it.
constexpr double kInflationOfShort = 10;
/// Share of the readout time: while rows are read the camera is taken to move as on average between its two
/// frames.
constexpr double kReadoutModel = 0.03;

/// The samples that pairs need at any time offset within its prior, so that few pairs of a long recording are
/// cheap. Between them the path makes a step that no pair sees.
std::vector<ImuSample> SamplesOf(const std::vector<FramePair>& pairs, const std::vector<ImuSample>& imu) {
  constexpr double kMarginS = 0.6;
  std::vector<ImuSample> samples;
  auto pair = pairs.begin();
  for (const ImuSample& sample : imu) {
    const double t_s = SecondsBetween(imu.front().stamp_ns, sample.stamp_ns);
    while (pair != pairs.end() && pair->t_j_s + kMarginS < t_s) {
      ++pair;
    }
    // The first sample is the origin of time.
    if (samples.empty() || (pair != pairs.end() && pair->t_i_s - kMarginS <= t_s)) {
      samples.push_back(sample);
    }
  }
  return samples;
}

class Fit {
 public:
  Fit(const std::vector<FramePair>& pairs, const std::vector<ImuSample>& imu, const CameraGyroModel& start,
      const CameraGyroFitOptions& options)
      : pairs_(pairs),
        imu_(SamplesOf(pairs, imu)),
        options_(options),
        start_(start),
        noise_px_(options.pixel_noise_px) {
    fit_.model = start;
    directions_.resize(pairs.size());
    FindDirections();
  }

  CameraGyroFit Execute() {
    constexpr int kRounds = 3;  // of the noise
    for (int round = 0; round < kRounds; ++round) {
      Iterate();
      MeasureNoise();
      if (!options_.estimate_noise || (std::abs(fit_.residual_px / noise_px_ - 1) < 0.02 && fit_.converged)) {
        break;
      }
      noise_px_ = fit_.residual_px;
    }
    Conclude();
    return fit_;
  }

 private:
  void FindDirections() {
    const GyroPath path(imu_, fit_.model.gyro_bias, fit_.model.gyro_sign);
    std::vector<double> weights;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const PairMotion motion = MotionOf(pairs_[k], fit_.model, path);
      std::vector<EpipolarRay> rays;
      for (const PairView& view : pairs_[k].views) {
        if (const ViewRays at = RaysOf(view, fit_.model, motion, path, noise_px_); at.seen) {
          rays.push_back(at.epipolar);
        }
      }
      directions_[k] =
          rays.empty() ? Vector3d::UnitX() : TranslationDirection(rays, kCameraGyroKernelSigma, &weights);
    }
  }

  /// Robust cost with the prior; `residuals`: whitened ones of all seen views.
  [[nodiscard]] double Cost(const CameraGyroModel& model, const std::vector<Vector3d>& directions,
                            std::vector<double>* residuals = nullptr) const {
    double cost = 0;
    const GyroPath path(imu_, model.gyro_bias, model.gyro_sign);
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const PairMotion motion = MotionOf(pairs_[k], model, path);
      for (const PairView& view : pairs_[k].views) {
        const ViewRays rays = RaysOf(view, model, motion, path, noise_px_);
        double squared = kUnseenSquared;
        if (rays.seen) {
          const double residual = directions[k].dot(rays.epipolar.normal) /
                                  std::sqrt(EpipolarVariance(rays.epipolar, directions[k]));
          squared = residual * residual;
          if (residuals != nullptr) {
            residuals->push_back(std::abs(residual));
          }
        }
        cost += RobustCost(RobustKernel::kCauchy, kCameraGyroKernelSigma, squared);
      }
    }
    const CameraGyroError offset = CameraGyroOffset(start_, model);
    for (int c = 0; c < Coordinate::kCount; ++c) {
      if (options_.prior[c] > 0) {
        cost += std::pow(offset[c] / options_.prior[c], 2);
      }
    }
    return cost;
  }

  [[nodiscard]] CameraGyroEquations EquationsAt(std::size_t k, const GyroPath& path) const {
    return EquationsOf(pairs_[k], fit_.model, path, directions_[k], intrinsics_free_, noise_px_);
  }

  /// Holds the fixed coordinates and adds the prior of the others.
  void AddPrior(CameraGyroMatrix* information, CameraGyroError* gradient) const {
    const CameraGyroError offset = CameraGyroOffset(start_, fit_.model);
    for (int c = 0; c < Coordinate::kCount; ++c) {
      if (options_.prior[c] > 0) {
        const double weight = 1 / (options_.prior[c] * options_.prior[c]);
        (*information)(c, c) += weight;
        (*gradient)[c] += weight * offset[c];
      } else {
        information->row(c).setZero();
        information->col(c).setZero();
        (*information)(c, c) = 1;
        (*gradient)[c] = 0;
      }
    }
  }

  void Iterate() {
    constexpr double kLargestDamping = 1e8;
    double damping = 1e-4;
    double cost = Cost(fit_.model, directions_);
    fit_.converged = false;
    for (int iteration = 0; iteration < options_.iterations && !fit_.converged; ++iteration) {
      const GyroPath path(imu_, fit_.model.gyro_bias, fit_.model.gyro_sign);
      std::vector<CameraGyroEquations> equations;
      CameraGyroMatrix information = CameraGyroMatrix::Zero();
      CameraGyroError gradient = CameraGyroError::Zero();
      for (std::size_t k = 0; k < pairs_.size(); ++k) {
        equations.push_back(EquationsAt(k, path));
        information += equations.back().information;
        gradient += equations.back().gradient;
      }
      AddPrior(&information, &gradient);
      for (bool better = false; !better;) {
        CameraGyroMatrix damped = information;
        damped.diagonal() *= 1 + damping;
        const CameraGyroError step = -SymmetricSolver(damped).Solve(gradient);
        CameraGyroModel model = fit_.model;
        std::vector<Vector3d> directions = directions_;
        better = Retract(step, &model);
        double next = cost;
        if (better) {
          for (std::size_t k = 0; k < pairs_.size(); ++k) {
            const Vector2d angles = -equations[k].direction_step - equations[k].direction_by_model * step;
            directions[k] = MovedDirection(directions_[k], angles);
          }
          next = Cost(model, directions);
          better = next <= cost;
        }
        if (better) {
          fit_.converged = cost - next < 1e-6 * (1 + cost) && damping <= 1e-2;
          fit_.model = model;
          directions_ = std::move(directions);
          cost = next;
          damping = std::max(damping / 10, 1e-9);
        } else if ((damping *= 10) > kLargestDamping) {
          fit_.converged = true;
          return;
        }
      }
    }
  }

  /// The noise from the median residual. A pair's direction takes two of its residuals.
  void MeasureNoise() {
    std::vector<double> residuals;
    fit_.cost = Cost(fit_.model, directions_, &residuals);
    if (residuals.empty()) {
      return;
    }
    constexpr double kNormalMedian = 0.6745;
    constexpr double kLeastNoisePx = 0.02;
    const double median = Median(residuals);
    const double views = static_cast<double>(residuals.size());
    const double free = std::max(1.0, views - 2.0 * static_cast<double>(pairs_.size()));
    const double whitened = median / kNormalMedian * std::sqrt(views / free);
    fit_.outliers = static_cast<double>(std::count_if(residuals.begin(), residuals.end(),
                                                      [&](double r) { return r > 4 * whitened; })) /
                    views;
    fit_.residual_px = std::max(kLeastNoisePx, noise_px_ * whitened);
  }

  void Conclude() {
    const GyroPath path(imu_, fit_.model.gyro_bias, fit_.model.gyro_sign);
    CameraGyroMatrix information = CameraGyroMatrix::Zero();
    CameraGyroError gradient = CameraGyroError::Zero();
    std::vector<CameraGyroError> gradients;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const CameraGyroEquations equations = EquationsAt(k, path);
      information += equations.information;
      gradient += equations.gradient;
      gradients.push_back(equations.gradient);
      fit_.views += static_cast<int>(pairs_[k].views.size());
    }
    fit_.pairs = static_cast<int>(pairs_.size());
    fit_.cost /= std::max(1, fit_.views);
    AddPrior(&information, &gradient);
    const CameraGyroMatrix covariance = SymmetricSolver(information).Solve(CameraGyroMatrix::Identity());
    const CameraGyroError alone = covariance.diagonal();
    CameraGyroError variances = alone;
    bool scattered = false;
    for (const double block_s : {options_.block_s, 2 * options_.block_s}) {
      if (const std::optional<CameraGyroError> scatter =
              VariancesByBlocks(pairs_, covariance, gradients, options_.prior, block_s)) {
        variances = variances.cwiseMax(*scatter);
        scattered = true;
      }
    }
    if (!scattered) {
      variances *= kInflationOfShort;
    }
    variances[Coordinate::kReadout] += std::pow(kReadoutModel * fit_.model.readout_s, 2);
    int free = 0;
    fit_.inflation = 0;
    for (int c = 0; c < Coordinate::kCount; ++c) {
      const double prior = options_.prior[c];
      fit_.deviations[c] = prior > 0 ? std::min(std::sqrt(variances[c]), prior) : 0;
      fit_.inflation += prior > 0 ? variances[c] / alone[c] : 0;
      free += prior > 0 ? 1 : 0;
    }
    fit_.inflation /= std::max(1, free);
  }

  const std::vector<FramePair>& pairs_;
  const std::vector<ImuSample> imu_;
  const CameraGyroFitOptions& options_;
  const CameraGyroModel start_;
  const bool intrinsics_free_ =
      (options_.prior.tail<Coordinate::kCount - Coordinate::kFocal>().array() > 0).any();
  double noise_px_;
  std::vector<Vector3d> directions_;  ///< translation of each pair, unit length
  CameraGyroFit fit_;
};

}  // namespace

Result<CameraGyroFit> FitCameraToGyro(const std::vector<FramePair>& pairs, const std::vector<ImuSample>& imu,
                                      const CameraGyroModel& start, const CameraGyroFitOptions& options) {
  constexpr std::size_t kLeastPairs = 6;
  if (pairs.size() < kLeastPairs) {
    return Status::Input(
        Format("%zu pairs of images in motion share enough tracks, expected at least %zu: the recording is "
               "too short, at rest, or its tracks are",
               pairs.size(), kLeastPairs));
  }
  return Fit(pairs, imu, start, options).Execute();
}

}  // namespace alidade
