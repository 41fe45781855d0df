#include "frontend/initialization/gyro_bias_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/dense_solvers.h"
#include "frontend/initialization/epipolar_ray.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kBiasPriorRadps = 0.1;
constexpr int kIterations = 8;
constexpr double kConvergedRadps = 1e-5;
// Long pairs see the bias best, short ones keep the most tracks.
constexpr std::array<int, 3> kSpacings = {1, 2, 4};
constexpr int kMinPairTracks = 8;
constexpr double kInlierSigma = 4.0;

/// Rotation from frame j to frame i by the gyroscope and its derivative, both in the body.
struct PairRotation {
  Matrix3d R_ij = Matrix3d::Identity();
  Matrix3d bias_jacobian = Matrix3d::Zero();  // R_ij(b + d) = R_ij Exp(bias_jacobian d)
};

PairRotation RotationOver(const std::vector<Preintegration>& preintegrations, int i, int j,
                          const Vector3d& gyro_bias) {
  PairRotation pair;
  for (int k = i; k < j; ++k) {
    const Preintegration& step = preintegrations[static_cast<size_t>(k)];
    const Matrix3d gamma = step.Corrected({gyro_bias, step.bias().accel}).gamma;
    pair.R_ij = pair.R_ij * gamma;
    pair.bias_jacobian = gamma.transpose() * pair.bias_jacobian + step.bias_jacobian().topLeftCorner<3, 3>();
  }
  return pair;
}

/// The tracks seen by both frames of a pair; rays in the body's axes at the first frame.
struct PairRays {
  std::vector<EpipolarRay> rays;
  std::vector<size_t> tracks;
  std::vector<Matrix3d> normal_bias;  // d normal / d bias
};

PairRays CollectRays(const DynamicWindow& window, const PairRotation& rotation, const Matrix3d& R_BC, int i,
                     int j) {
  PairRays pair;
  for (size_t t = 0; t < window.tracks.size(); ++t) {
    const SharedTrack& track = window.tracks[t];
    const auto at_i = std::lower_bound(track.frames.begin(), track.frames.end(), i);
    const auto at_j = std::lower_bound(track.frames.begin(), track.frames.end(), j);
    if (at_i == track.frames.end() || *at_i != i || at_j == track.frames.end() || *at_j != j) {
      continue;
    }
    const NormalizedObservation& seen_i =
        track.observations[static_cast<size_t>(at_i - track.frames.begin())];
    const NormalizedObservation& seen_j =
        track.observations[static_cast<size_t>(at_j - track.frames.begin())];
    EpipolarRay ray;
    ray.ray_i = R_BC * BearingOf(seen_i);
    const Vector3d ray_body_j = R_BC * BearingOf(seen_j);
    ray.ray_j = rotation.R_ij * ray_body_j;
    ray.normal = ray.ray_i.cross(ray.ray_j);
    ray.sigma = std::hypot(AngularDeviation(seen_i), AngularDeviation(seen_j));
    pair.rays.push_back(ray);
    pair.tracks.push_back(t);
    pair.normal_bias.push_back(-Skew(ray.ray_i) * rotation.R_ij * Skew(ray_body_j) * rotation.bias_jacobian);
  }
  return pair;
}

/// Normal equations over the bias.
struct BiasEquations {
  Matrix3d information = Matrix3d::Zero();
  Vector3d gradient = Vector3d::Zero();
};

/// Adds a pair's rows with its translation direction eliminated.
void AddPair(const PairRays& pair, BiasEquations* equations) {
  std::vector<double> weights;
  const Vector3d direction = TranslationDirection(pair.rays, kCauchyScale, &weights);
  Eigen::Matrix<double, 3, 2> tangent;
  tangent.col(0) = direction.unitOrthogonal();
  tangent.col(1) = direction.cross(tangent.col(0));
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> right_side = Eigen::Matrix<double, 5, 1>::Zero();
  for (size_t k = 0; k < pair.rays.size(); ++k) {
    Eigen::Matrix<double, 5, 1> row;
    row << pair.normal_bias[k].transpose() * direction, tangent.transpose() * pair.rays[k].normal;
    normal += weights[k] * row * row.transpose();
    right_side += weights[k] * direction.dot(pair.rays[k].normal) * row;
  }
  // Without parallax the direction is loose: the unit prior on its two angles keeps the elimination regular.
  const Eigen::Matrix2d loose = normal.bottomRightCorner<2, 2>() + Eigen::Matrix2d::Identity();
  const Eigen::Matrix<double, 3, 2> gain = normal.topRightCorner<3, 2>() * loose.inverse();
  equations->information += normal.topLeftCorner<3, 3>() - gain * normal.bottomLeftCorner<2, 3>();
  equations->gradient += right_side.head<3>() - gain * right_side.tail<2>();
}

/// Rays of every pair of frames that shares enough tracks.
std::vector<PairRays> CollectPairs(const DynamicWindow& window,
                                   const std::vector<Preintegration>& preintegrations, const Matrix3d& R_BC,
                                   const Vector3d& gyro_bias) {
  std::vector<PairRays> pairs;
  const int frames = static_cast<int>(window.stamps_ns.size());
  for (const int spacing : kSpacings) {
    for (int i = 0; i + spacing < frames; ++i) {
      const PairRotation rotation = RotationOver(preintegrations, i, i + spacing, gyro_bias);
      PairRays pair = CollectRays(window, rotation, R_BC, i, i + spacing);
      if (static_cast<int>(pair.rays.size()) >= kMinPairTracks) {
        pairs.push_back(std::move(pair));
      }
    }
  }
  return pairs;
}

/// A track is an inlier unless it disagrees in most of its pairs.
std::vector<bool> ConsistentTracks(const std::vector<PairRays>& pairs, size_t tracks) {
  std::vector<int> votes(tracks, 0);
  std::vector<int> against(tracks, 0);
  std::vector<double> weights;
  for (const PairRays& pair : pairs) {
    const Vector3d direction = TranslationDirection(pair.rays, kCauchyScale, &weights);
    for (size_t k = 0; k < pair.rays.size(); ++k) {
      const EpipolarRay& ray = pair.rays[k];
      const double limit = kInlierSigma * std::sqrt(EpipolarVariance(ray, direction));
      ++votes[pair.tracks[k]];
      against[pair.tracks[k]] += std::abs(direction.dot(ray.normal)) > limit ? 1 : 0;
    }
  }
  std::vector<bool> inlier;
  for (size_t t = 0; t < tracks; ++t) {
    inlier.push_back(2 * against[t] <= votes[t]);
  }
  return inlier;
}

/// Median over the inliers of three or more views of the angle between first and last ray, rotation removed.
double MedianParallax(const DynamicWindow& window, const std::vector<Preintegration>& preintegrations,
                      const RigCalibration& rig, const GyroBiasFit& fit) {
  const Matrix3d& R_BC = rig.T_BC.rotation;
  std::vector<double> parallax;
  for (size_t t = 0; t < window.tracks.size(); ++t) {
    const SharedTrack& track = window.tracks[t];
    if (!fit.inlier[t] || track.frames.size() < 3) {
      continue;
    }
    const PairRotation rotation =
        RotationOver(preintegrations, track.frames.front(), track.frames.back(), fit.gyro_bias);
    const Vector3d first = R_BC * BearingOf(track.observations.front());
    const Vector3d last = rotation.R_ij * R_BC * BearingOf(track.observations.back());
    parallax.push_back(std::atan2(first.cross(last).norm(), first.dot(last)) * rig.camera.mean_focal_px());
  }
  if (parallax.empty()) {
    return 0;
  }
  const auto middle = parallax.begin() + static_cast<std::ptrdiff_t>(parallax.size() / 2);
  std::nth_element(parallax.begin(), middle, parallax.end());
  return *middle;
}

}  // namespace

GyroBiasFit FitGyroBias(const DynamicWindow& window, const std::vector<Preintegration>& preintegrations,
                        const RigCalibration& rig) {
  const Matrix3d& R_BC = rig.T_BC.rotation;
  GyroBiasFit fit;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    BiasEquations equations;
    equations.information = Matrix3d::Identity() / (kBiasPriorRadps * kBiasPriorRadps);
    equations.gradient = equations.information * fit.gyro_bias;
    for (const PairRays& pair : CollectPairs(window, preintegrations, R_BC, fit.gyro_bias)) {
      AddPair(pair, &equations);
    }
    const Vector3d step = SolveSymmetric(equations.information, equations.gradient);
    fit.gyro_bias -= step;
    if (step.norm() < kConvergedRadps) {
      break;
    }
  }
  fit.inlier =
      ConsistentTracks(CollectPairs(window, preintegrations, R_BC, fit.gyro_bias), window.tracks.size());
  fit.median_parallax_px = MedianParallax(window, preintegrations, rig, fit);
  return fit;
}

}  // namespace alidade
