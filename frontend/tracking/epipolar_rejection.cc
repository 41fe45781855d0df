#include "frontend/tracking/epipolar_rejection.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/calib3d.hpp>

#include "core/camera_model.h"
#include "core/lie.h"
#include "core/robust.h"
#include "core/turned_ray.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kMaxHypotheses = 100;
constexpr double kConfidence = 0.999;
constexpr int kRefinementSteps = 5;
// A rolling shutter and a poor calibration leave more than noise; beyond this it is another motion.
constexpr double kMaxThresholdGrowth = 3;

struct Consensus {
  std::vector<bool> inliers;
  int count = 0;
};

/// SplitMix64 (Steele, Lea, Flood 2014): the standard library's distributions differ between implementations.
class Sampler {
 public:
  size_t Below(size_t bound) {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return static_cast<size_t>((z ^ (z >> 31)) % bound);
  }

 private:
  std::uint64_t state_ = 1;
};

Consensus Count(std::vector<bool> inliers) {
  Consensus consensus{.inliers = std::move(inliers), .count = 0};
  consensus.count = static_cast<int>(std::count(consensus.inliers.begin(), consensus.inliers.end(), true));
  return consensus;
}

Consensus Score(const std::vector<BearingPair>& pairs, const CameraMotion& motion,
                const EpipolarOptions& options) {
  std::vector<bool> inliers(pairs.size());
  for (size_t i = 0; i < pairs.size(); ++i) {
    inliers[i] = IsInlier(EvaluateEpipolar(pairs[i], motion, options), options);
  }
  return Count(std::move(inliers));
}

/// Best translation direction over two-pair hypotheses with the rotation held.
Consensus SampleTranslation(const std::vector<BearingPair>& pairs, const EpipolarOptions& options,
                            CameraMotion* motion) {
  Sampler sampler;
  Consensus best;
  CameraMotion candidate = *motion;
  int hypotheses = kMaxHypotheses;
  for (int k = 0; k < hypotheses; ++k) {
    const size_t a = sampler.Below(pairs.size());
    const size_t b = (a + 1 + sampler.Below(pairs.size() - 1)) % pairs.size();
    const auto normal = [&](size_t i) -> Vector3d {
      return TurnedRay(candidate.R_21, pairs[i].first).cross(pairs[i].second);
    };
    const Vector3d direction = normal(a).cross(normal(b));
    // Neither pair moved, or both along one plane: any direction would do, this one decides nothing.
    if (direction.norm() > 0) {
      candidate.t = direction.normalized();
    }
    Consensus consensus = Score(pairs, candidate, options);
    if (consensus.count > best.count) {
      best = std::move(consensus);
      *motion = candidate;
      const double ratio = static_cast<double>(best.count) / static_cast<double>(pairs.size());
      const double needed = std::log(1 - kConfidence) / std::log(std::max(1e-12, 1 - ratio * ratio));
      hypotheses = std::min(kMaxHypotheses, static_cast<int>(std::ceil(needed)));
    }
  }
  return best;
}

/// Orthonormal basis of the plane normal to the unit vector t.
Eigen::Matrix<double, 3, 2> TangentBasis(const Vector3d& t) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = t.unitOrthogonal();
  basis.col(1) = t.cross(basis.col(0));
  return basis;
}

/// Gauss-Newton on (delta, t) over the inliers, Huber weights at threshold_px, prior on the total rotation
/// correction.
void Refine(const std::vector<BearingPair>& pairs, const std::vector<bool>& inliers,
            const Matrix3d& R_21_prior, double rotation_std, const EpipolarOptions& options,
            CameraMotion* motion) {
  using Matrix5d = Eigen::Matrix<double, 5, 5>;
  using Vector5d = Eigen::Matrix<double, 5, 1>;
  const double sigma_px = 0.5 * options.threshold_px;
  for (int step = 0; step < kRefinementSteps; ++step) {
    const Eigen::Matrix<double, 3, 2> basis = TangentBasis(motion->t);
    Matrix5d hessian = Matrix5d::Zero();
    Vector5d gradient = Vector5d::Zero();
    for (size_t i = 0; i < pairs.size(); ++i) {
      const EpipolarTerm term = EvaluateEpipolar(pairs[i], *motion, options);
      if (!inliers[i] || term.at_epipole) {
        continue;
      }
      // d/d delta of t . ((g + delta x g) x x_2), and d/dt along the tangent plane; the line's norm is held.
      Vector5d row;
      row.head<3>() = motion->t.dot(term.g) * term.x_2 - term.g.dot(term.x_2) * motion->t;
      row.tail<2>() = basis.transpose() * term.g.cross(term.x_2);
      const double distance_px = term.error * term.scale;
      const double weight =
          RobustWeight(RobustKernel::kHuber, options.threshold_px, distance_px * distance_px) /
          (sigma_px * sigma_px);
      hessian += weight * term.scale * term.scale * row * row.transpose();
      gradient += weight * term.scale * distance_px * row;
    }
    const Vector3d correction = so3::Log(motion->R_21 * R_21_prior.transpose());
    const double prior_weight = 1.0 / (rotation_std * rotation_std);
    hessian.topLeftCorner<3, 3>().diagonal().array() += prior_weight;
    gradient.head<3>() += prior_weight * correction;
    // Without parallax the data do not determine t: a step of a radian costs one sigma.
    hessian.bottomRightCorner<2, 2>().diagonal().array() += 1.0;
    const Vector5d update = -hessian.ldlt().solve(gradient);
    if (!update.allFinite()) {
      return;
    }
    motion->R_21 = so3::Exp(update.head<3>()) * motion->R_21;
    motion->t = (motion->t + basis * update.tail<2>()).normalized();
  }
}

/// Rejects inliers that moved along their epipolar line against the others: no point in front of both images
/// does. x_2 ~ g + t / depth, so (g x x_2) . (g x t) has the sign of the depth; the sign of t is that of the
/// majority.
Consensus RejectNegativeDepth(const std::vector<BearingPair>& pairs, const CameraMotion& motion,
                              const EpipolarOptions& options, Consensus consensus) {
  // Twice the threshold: a displacement within noise has no sign.
  const double min_displacement_px = 2 * options.threshold_px;
  std::vector<int> signs(pairs.size(), 0);
  int balance = 0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const EpipolarTerm term = EvaluateEpipolar(pairs[i], motion, options);
    if (consensus.inliers[i] && !term.at_epipole && DisplacementPx(term, options) > min_displacement_px) {
      signs[i] = term.g.cross(term.x_2).dot(term.g.cross(motion.t)) > 0 ? 1 : -1;
      balance += signs[i];
    }
  }
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (signs[i] * balance < 0) {
      consensus.inliers[i] = false;
    }
  }
  return Count(std::move(consensus.inliers));
}

/// Threshold that suits the scatter of the inliers: three robust standard deviations, at least that of the
/// options and at most kMaxThresholdGrowth times it.
double AdaptedThreshold(const std::vector<BearingPair>& pairs, const std::vector<bool>& inliers,
                        const CameraMotion& motion, const EpipolarOptions& options) {
  std::vector<double> distances_px;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const EpipolarTerm term = EvaluateEpipolar(pairs[i], motion, options);
    if (inliers[i] && !term.at_epipole) {
      distances_px.push_back(std::abs(term.error) * term.scale);
    }
  }
  if (distances_px.empty()) {
    return options.threshold_px;
  }
  const auto middle = distances_px.begin() + static_cast<std::ptrdiff_t>(distances_px.size() / 2);
  std::nth_element(distances_px.begin(), middle, distances_px.end());
  // The deviation of a normal distribution is 1.4826 times its median absolute deviation.
  return std::clamp(3 * 1.4826 * *middle, options.threshold_px, kMaxThresholdGrowth * options.threshold_px);
}

Consensus AgreeWithRotation(const std::vector<BearingPair>& pairs, const Matrix3d& R_21,
                            const EpipolarOptions& options) {
  // 1 mrad: rotation noise and calibration at high frame rates, where the bias alone gives too small a
  // deviation.
  const double rotation_std = std::max(1e-3, kGyroError * options.dt_s);
  EpipolarOptions loose = options;
  loose.threshold_px += 2 * rotation_std * options.focal_px;
  CameraMotion motion{.R_21 = R_21, .t = Vector3d::UnitZ()};
  Consensus consensus = SampleTranslation(pairs, loose, &motion);
  Refine(pairs, consensus.inliers, R_21, rotation_std, options, &motion);
  EpipolarOptions adapted = options;
  adapted.threshold_px = AdaptedThreshold(pairs, consensus.inliers, motion, options);
  consensus = Score(pairs, motion, adapted);
  Refine(pairs, consensus.inliers, R_21, rotation_std, adapted, &motion);
  consensus = Score(pairs, motion, adapted);
  return RejectNegativeDepth(pairs, motion, adapted, std::move(consensus));
}

cv::Point2f OnPlanePx(const Vector3d& direction, double focal_px) {
  const double scale = focal_px / direction.z();
  return {static_cast<float>(direction.x() * scale), static_cast<float>(direction.y() * scale)};
}

Consensus AgreeWithFundamental(const std::vector<BearingPair>& pairs, const EpipolarOptions& options) {
  std::vector<cv::Point2f> first;
  std::vector<cv::Point2f> second;
  std::vector<size_t> indices;
  const double least_z = options.on_sphere ? std::cos(CameraModel::kMaxPlaneAngle) : 0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].first.z() > least_z && pairs[i].second.z() > least_z) {
      first.push_back(OnPlanePx(pairs[i].first, options.focal_px));
      second.push_back(OnPlanePx(pairs[i].second, options.focal_px));
      indices.push_back(i);
    }
  }
  if (indices.size() < static_cast<size_t>(kMinPairs)) {
    return Count(std::vector<bool>(pairs.size(), true));
  }
  std::vector<unsigned char> mask;
  // This estimator seeds a generator of its own at each call, so cv::theRNG() is neither read nor advanced.
  const cv::Mat fundamental = cv::findFundamentalMat(first, second, cv::FM_RANSAC, options.threshold_px, 0.99,
                                                     kMaxHypotheses * 2, mask);
  std::vector<bool> inliers(pairs.size(), true);
  if (fundamental.empty() || mask.size() != indices.size()) {
    return Count(std::move(inliers));
  }
  for (size_t k = 0; k < indices.size(); ++k) {
    inliers[indices[k]] = mask[k] != 0;
  }
  return Count(std::move(inliers));
}

}  // namespace

std::vector<bool> FindEpipolarInliers(const std::vector<BearingPair>& pairs,
                                      const std::optional<Matrix3d>& R_21, const EpipolarOptions& options) {
  if (pairs.size() < static_cast<size_t>(kMinPairs)) {
    return std::vector<bool>(pairs.size(), true);
  }
  Consensus with_rotation;
  if (R_21.has_value()) {
    with_rotation = AgreeWithRotation(pairs, *R_21, options);
    if (2 * with_rotation.count > static_cast<int>(pairs.size())) {
      return with_rotation.inliers;
    }
  }
  Consensus without = AgreeWithFundamental(pairs, options);
  return without.count > with_rotation.count ? without.inliers : with_rotation.inliers;
}

}  // namespace alidade
