#include "core/outlying_observations.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/check.h"
#include "core/pose_only.h"
#include "core/reprojection.h"

namespace alidade {
namespace {

using Eigen::Index;

// At most one observation in so many is outlying.
constexpr int kOutlyingOneIn = 3;
// Least degrees of freedom before an observation is taken out, those of four views: of fewer, it is not
// determined which one is wrong.
constexpr int kLeastFreedom = 5;
// Least determinant of W_k^T W_k, over the square of its mean eigenvalue: below, an error of the observation
// cannot be told from the landmark's or from that of another observation.
constexpr double kLeastDeterminant = 1e-6;
// Whitened residual of an observation that agrees with a landmark of two views: that has their noise, and the
// poses are not exact. An error that leaves no landmark is much larger.
constexpr double kAgrees = 10;

/// T_k; zero where it is not determined.
double Contradiction(const Eigen::Ref<const Eigen::MatrixXd>& map,
                     const Eigen::Ref<const Eigen::VectorXd>& rows) {
  const Eigen::Matrix2d information = map.transpose() * map;
  const Eigen::Vector2d gradient = map.transpose() * rows;
  const double mean = information.trace() / 2;
  const double determinant = information.determinant();
  if (!(determinant > kLeastDeterminant * mean * mean)) {
    return 0;
  }
  return gradient.dot(information.inverse() * gradient);
}

/// Takes the direction of a column out of the rows and of the other columns; it vanishes itself.
void ProjectOut(Index column, Eigen::Ref<Eigen::MatrixXd> maps, Eigen::Ref<Eigen::VectorXd> rows) {
  auto direction = maps.col(column);
  direction.normalize();
  rows -= direction * direction.dot(rows);
  for (Index other = 0; other < maps.cols(); ++other) {
    if (other != column) {
      maps.col(other) -= direction * direction.dot(maps.col(other));
    }
  }
  direction.setZero();
}

bool Agrees(const Pose& T_WC, const NormalizedObservation& observation, const Eigen::Vector3d& p_W) {
  Eigen::Vector2d seen;
  return ProjectToPlane(observation.plane, PointInCamera(T_WC, p_W).q, kMinPointDepth, &seen) &&
         (observation.sqrt_information * (seen - observation.z)).squaredNorm() < kAgrees * kAgrees;
}

}  // namespace

bool FindOutlyingObservations(const ChiSquareGate& gate, Eigen::Ref<Eigen::MatrixXd> maps,
                              Eigen::Ref<Eigen::VectorXd> rows, std::vector<int>* outlying) {
  DCHECK_EQ(maps.rows(), rows.size());
  outlying->clear();
  const int observations = static_cast<int>(maps.cols() / 2);
  const int most = observations / kOutlyingOneIn;
  // The quantile 1 - e of two degrees of freedom is -2 log e.
  const double least = gate.Threshold(2) + 2 * std::log(static_cast<double>(observations));
  int dof = static_cast<int>(rows.size());
  while (!gate.Accepts(rows.squaredNorm(), dof)) {
    if (static_cast<int>(outlying->size()) == most || dof < kLeastFreedom) {
      return false;
    }
    int worst = -1;
    double largest = least;
    for (int k = 0; k < observations; ++k) {
      const double contradiction = Contradiction(maps.middleCols<2>(2 * k), rows);
      if (contradiction > largest) {
        largest = contradiction;
        worst = k;
      }
    }
    if (worst < 0) {
      return false;
    }
    ProjectOut(2 * worst, maps, rows);
    ProjectOut(2 * worst + 1, maps, rows);
    outlying->push_back(worst);
    dof -= 2;
  }
  return true;
}

void FrameOutliers::Begin(size_t frames) {
  counts_.assign(frames, {});
}

bool FrameOutliers::AnySuspect(double max_share) const {
  return std::any_of(counts_.begin(), counts_.end(), [&](const Count& count) {
    return StateIsSuspect(count.outlying, count.seen, max_share, kLeastOutlyingOfFrame);
  });
}

bool FindOutliersOfConsensus(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                             std::vector<int>* outlying) {
  const size_t views = T_WC.size();
  const size_t needed = views - views / kOutlyingOneIn;
  size_t most = needed - 1;
  Eigen::Vector3d landmark;
  for (size_t i = 0; i < views; ++i) {
    for (size_t k = i + 1; k < views; ++k) {
      const std::array<Pose, 2> poses = {T_WC[i], T_WC[k]};
      const std::array<NormalizedObservation, 2> seen = {observations[i], observations[k]};
      PoseOnlyDepth depth;
      if (!ComputePoseOnlyDepth(poses, seen, 0, DepthViews::kTwo, &depth) || !(depth.depth > 0)) {
        continue;
      }
      size_t agreeing = 0;
      for (size_t view = 0; view < views; ++view) {
        agreeing += Agrees(T_WC[view], observations[view], depth.p_W) ? 1 : 0;
      }
      if (agreeing > most) {
        most = agreeing;
        landmark = depth.p_W;
      }
    }
  }
  outlying->clear();
  for (size_t view = 0; most >= needed && view < views; ++view) {
    if (!Agrees(T_WC[view], observations[view], landmark)) {
      outlying->push_back(static_cast<int>(view));
    }
  }
  return !outlying->empty();
}

}  // namespace alidade
