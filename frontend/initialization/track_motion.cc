#include "frontend/initialization/track_motion.h"

#include <Eigen/QR>
#include <algorithm>
#include <vector>

namespace alidade {
namespace {

using Eigen::Vector2d;

struct Displacement {
  Vector2d pixel;
  Vector2d shift;
};

std::vector<Displacement> CommonTracks(const TrackFrame& from, const TrackFrame& to) {
  std::vector<Displacement> displacements;
  auto a = from.observations.begin();
  auto b = to.observations.begin();
  while (a != from.observations.end() && b != to.observations.end()) {
    if (a->track_id < b->track_id) {
      ++a;
    } else if (b->track_id < a->track_id) {
      ++b;
    } else {
      displacements.push_back({a->pixel, b->pixel - a->pixel});
      ++a;
      ++b;
    }
  }
  return displacements;
}

/// Flow of each displacement by a model fitted to those marked `used`: affine from six of them on, else their
/// mean.
std::vector<Vector2d> FitFlow(const std::vector<Displacement>& displacements, const std::vector<bool>& used) {
  Vector2d centre = Vector2d::Zero();
  Eigen::Index count = 0;
  for (size_t i = 0; i < displacements.size(); ++i) {
    if (used[i]) {
      centre += displacements[i].pixel;
      ++count;
    }
  }
  centre /= static_cast<double>(std::max<Eigen::Index>(count, 1));
  const Eigen::Index terms = count >= 6 ? 3 : 1;
  const auto design_row = [&](const Vector2d& pixel) {
    const Eigen::Vector3d row(1, (pixel.x() - centre.x()) / 100, (pixel.y() - centre.y()) / 100);
    return Eigen::RowVectorXd(row.head(terms).transpose());
  };
  Eigen::MatrixXd design(count, terms);
  Eigen::MatrixXd shifts(count, 2);
  Eigen::Index row = 0;
  for (size_t i = 0; i < displacements.size(); ++i) {
    if (used[i]) {
      design.row(row) = design_row(displacements[i].pixel);
      shifts.row(row) = displacements[i].shift.transpose();
      ++row;
    }
  }
  const Eigen::MatrixXd solution = design.colPivHouseholderQr().solve(shifts);
  std::vector<Vector2d> flow;
  flow.reserve(displacements.size());
  for (const Displacement& displacement : displacements) {
    flow.emplace_back((design_row(displacement.pixel) * solution).transpose());
  }
  return flow;
}

/// Marks the displacements within three robust deviations (from the median residual) of the flow.
std::vector<bool> KeepInliers(const std::vector<Displacement>& displacements,
                              const std::vector<Vector2d>& flow) {
  std::vector<double> residuals;
  residuals.reserve(displacements.size());
  for (size_t i = 0; i < displacements.size(); ++i) {
    residuals.push_back((displacements[i].shift - flow[i]).norm());
  }
  std::vector<double> sorted = residuals;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double limit = 3.0 * *middle / 1.1774 + 1e-9;  // the median of a Rayleigh variable is 1.1774 sigma
  std::vector<bool> used;
  used.reserve(residuals.size());
  for (const double residual : residuals) {
    used.push_back(residual <= limit);
  }
  return used;
}

}  // namespace

TrackMotion MeasureTrackMotion(const TrackFrame& from, const TrackFrame& to) {
  const std::vector<Displacement> displacements = CommonTracks(from, to);
  TrackMotion motion;
  motion.common = static_cast<int>(displacements.size());
  motion.candidates = static_cast<int>(std::min(from.observations.size(), to.observations.size()));
  if (motion.common < 3) {
    return motion;
  }
  std::vector<bool> used(displacements.size(), true);
  std::vector<Vector2d> flow;
  for (int round = 0; round < 3; ++round) {
    flow = FitFlow(displacements, used);
    used = KeepInliers(displacements, flow);
  }
  double total = 0;
  for (const Vector2d& shift : flow) {
    total += shift.norm();
  }
  motion.motion_px = total / static_cast<double>(flow.size());
  return motion;
}

}  // namespace alidade
