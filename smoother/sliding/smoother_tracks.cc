// The tracks of a SmootherEstimator: which of them a frame uses.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "core/scene_depth.h"
#include "smoother/sliding/smoother_estimator.h"
#include "smoother/tracks/outlying_views.h"
#include "smoother/tracks/track_landmark.h"
#include "smoother/tracks/track_system.h"

namespace alidade {
namespace {

// The filter linearises a track once and needs its depth to vision.max_relative_depth_deviation; here every
// solve linearises again, so a track may enter at this multiple of it: with the shipped 0.1, once its inverse
// depth is known to its own size. It is still held to that when it is marginalised, linearised for good.
constexpr double kParallaxSlack = 10;
// Largest deviation of an inverse depth in typical ones. At its own inverse depth, noise would choose: tracks
// whose noise looks like parallax of the motion that is estimated would confirm it.
constexpr double kMaxTypicalDeviation = 0.3;
// Tracks without parallax are assumed at the typical inverse depth, as uncertain as it is large. At rest,
// uncertain depths would fit the noise of their tracks to a motion of the camera, and the joint minimum would
// lie there; a wrong depth has no effect, since the camera does not move.
constexpr double kDepthPriorRelative = 1.0;
constexpr double kDepthPriorRelativeAtRest = 0.1;

}  // namespace

double SmootherEstimator::MaxInverseDepthDeviation() const {
  return config_.smoother.parallax_gate == ParallaxGate::kOwn ? std::numeric_limits<double>::infinity()
                                                              : kMaxTypicalDeviation * TypicalInverseDepth();
}

SmootherEstimator::Landmark SmootherEstimator::PrepareLandmark(const std::vector<FrameGeometry>& geometry,
                                                               double max_inverse_depth_deviation,
                                                               WindowTrack* track) const {
  if (track->has_landmark) {
    return Landmark::kReady;
  }
  Eigen::Vector3d landmark;
  if (std::isfinite(max_inverse_depth_deviation)) {
    // At the typical depth: where the baselines determine none, noise decides whether the track's own lies in
    // front of the camera, and one behind it contradicts nothing.
    landmark << track->views.front().observation.z, max_inverse_depth_deviation / kMaxTypicalDeviation;
    const std::optional<double> deviation = InverseDepthDeviation(track->views, geometry, kernel_, landmark);
    if (deviation && !(*deviation < max_inverse_depth_deviation)) {
      return Landmark::kWaiting;
    }
  }
  if (!InitializeLandmark(track->views, geometry,
                          kParallaxSlack * config_.vision.max_relative_depth_deviation, &landmark)) {
    return Landmark::kWaiting;
  }
  if (!SolveLandmark(track->views, geometry, kernel_, kMaxLandmarkIterations, &landmark) ||
      !DepthInRange(landmark)) {
    return TakeOutliersOut(geometry, track) ? PrepareLandmark(geometry, max_inverse_depth_deviation, track)
                                            : Landmark::kDegenerate;
  }
  if (std::isfinite(max_inverse_depth_deviation)) {
    const std::optional<double> deviation = InverseDepthDeviation(track->views, geometry, kernel_, landmark);
    if (!deviation || !(*deviation < max_inverse_depth_deviation)) {
      return Landmark::kWaiting;
    }
  }
  track->landmark = landmark;
  track->has_landmark = true;
  track->depth_prior = {};
  return Landmark::kReady;
}

bool SmootherEstimator::TakeOutliersOut(const std::vector<FrameGeometry>& geometry,
                                        WindowTrack* track) const {
  std::vector<int> outlying;
  if (config_.vision.gate_unit != GateUnit::kObservation ||
      !FindOutliersOfConsensus(*track, geometry, &outlying)) {
    return false;
  }
  track->RemoveViews(outlying);
  return true;
}

bool SmootherEstimator::DepthInRange(const Eigen::Vector3d& landmark) const {
  return landmark.z() >= 1 / config_.vision.max_depth_m && landmark.z() <= 1 / config_.vision.min_depth_m;
}

double SmootherEstimator::TypicalInverseDepth() const {
  std::vector<double> known;
  for (const auto& [id, track] : window_.tracks()) {
    if (track.has_landmark) {
      known.push_back(track.landmark.z());
    }
  }
  if (known.size() < SceneDepth::kLeastTracks) {
    return 1 / kRoomDepth;
  }
  std::nth_element(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2), known.end());
  return known[known.size() / 2];
}

std::vector<WindowTrack*> SmootherEstimator::SelectTracks() {
  const std::vector<FrameGeometry> geometry = Geometry();
  std::vector<WindowTrack*> selected;
  std::vector<WindowTrack*> without_depth;
  const double max_deviation = MaxInverseDepthDeviation();
  for (auto& [id, track] : window_.tracks()) {
    track.degenerate = false;
    if (track.anchor == nullptr && track.views.size() >= kMinViews) {
      const Landmark landmark = PrepareLandmark(geometry, max_deviation, &track);
      statistics_.features_waiting += landmark == Landmark::kWaiting ? 1 : 0;
      track.degenerate = landmark == Landmark::kDegenerate;
      statistics_.features_degenerate += track.degenerate ? 1 : 0;
      (landmark == Landmark::kReady ? selected : without_depth).push_back(&track);
    }
  }
  const double typical = TypicalInverseDepth();
  const double relative = statistics_.at_rest ? kDepthPriorRelativeAtRest : kDepthPriorRelative;
  // With enough depths known the others add little, and the assumed one would only bias them: they wait. Many
  // assumed depths together pretend to know the scale of a motion.
  const bool wait = static_cast<int>(selected.size()) >= config_.smoother.keyframe_min_tracked ||
                    (config_.smoother.parallax_gate == ParallaxGate::kTypical && !statistics_.at_rest);
  for (WindowTrack* track : without_depth) {
    if (wait) {
      track->depth_prior = {};
      continue;
    }
    // Not solved for here: where the prediction has drifted, the depth would be bent to excuse it.
    if (track->depth_prior.sqrt_information == 0) {
      track->landmark << track->views.front().observation.z, typical;
    }
    track->depth_prior = {typical, 1 / (relative * typical)};
    selected.push_back(track);
  }
  const size_t limit = static_cast<size_t>(config_.smoother.max_landmarks);
  if (selected.size() > limit) {
    std::stable_sort(selected.begin(), selected.end(), [](const WindowTrack* a, const WindowTrack* b) {
      return a->views.size() > b->views.size();
    });
    selected.resize(limit);
  }
  return selected;
}

PoseOnlyTerm* SmootherEstimator::AddVision(const std::vector<WindowTrack*>& tracks,
                                           WindowTerms* terms) const {
  if (tracks.empty()) {
    return nullptr;
  }
  const LandmarkMotion motion = config_.smoother.landmark == SmootherLandmark::kInverseDepth
                                    ? LandmarkMotion::kJointStep
                                    : LandmarkMotion::kSolved;
  auto vision = std::make_unique<PoseOnlyTerm>(
      window_, std::vector<const WindowTrack*>(tracks.begin(), tracks.end()), calibration_, kernel_, motion);
  PoseOnlyTerm* const added = vision.get();
  terms->push_back(std::move(vision));
  return added;
}

}  // namespace alidade
