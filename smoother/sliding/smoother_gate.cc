// What becomes of the tracks of a SmootherEstimator once a solve has used them: which of them pass the gate.

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/outlying_observations.h"
#include "smoother/sliding/smoother_estimator.h"
#include "smoother/tracks/anchored_landmark.h"
#include "smoother/tracks/outlying_views.h"
#include "smoother/tracks/track_landmark.h"

namespace alidade {

bool SmootherEstimator::IsSuspect(size_t refused, size_t tracks) const {
  return StateIsSuspect(static_cast<int>(refused), static_cast<int>(tracks), config_.vision.max_gated_share,
                        kLeastRefusedTracks);
}

bool SmootherEstimator::KeepTrack(WindowTrack* track) {
  if (track->anchor != nullptr && !DepthInRange(track->landmark)) {
    ++statistics_.features_degenerate;
    track->Restart();
    return false;
  }
  if (track->has_landmark && !DepthInRange(track->landmark)) {
    // It fits, but its depth was none: it falls back on an assumed one.
    ++statistics_.features_degenerate;
    track->has_landmark = false;
  }
  return true;
}

Status SmootherEstimator::Gate(const std::vector<WindowTrack*>& tracks, bool has_features,
                               std::unique_ptr<PoseOnlyTerm> vision, WindowTerms* terms) {
  std::vector<WindowTrack*> gated = FeaturesInSight();
  gated.insert(gated.begin(), tracks.begin(), tracks.end());
  if (GateTracks(Geometry(), gated, vision.get()) && has_features) {
    ALIDADE_RETURN_IF_ERROR(TakeLandmarks(*SetPriorTerm(terms)));
  }
  for (int i = 0; gnss_.aligned() && i < window_.size(); ++i) {
    gnss_.Gate(&window_.frame(i), &statistics_);
  }
  if (!vision || statistics_.suspect) {  // suspect: the tracks have less information now
    std::vector<const WindowTrack*> used;
    std::copy_if(tracks.begin(), tracks.end(), std::back_inserter(used),
                 [](const WindowTrack* track) { return track->views.size() >= kMinViews; });
    vision = std::make_unique<PoseOnlyTerm>(window_, std::move(used), calibration_, kernel_);
  }
  const PoseSystem& system = vision->system();
  statistics_.features_used = system.tracks + static_cast<int>(FeaturesInSight().size());
  statistics_.nis = system.chi2;
  statistics_.nis_dof = system.dof;
  terms->push_back(std::move(vision));
  return Status::Ok();
}

bool SmootherEstimator::SolveOwnLandmark(const std::vector<FrameGeometry>& geometry,
                                         std::span<const std::optional<Eigen::Vector3d>> solved, size_t index,
                                         WindowTrack* track) const {
  if (index >= solved.size()) {
    return SolveLandmark(track->views, geometry, kernel_, kMaxLandmarkIterations, &track->landmark,
                         track->depth_prior);
  }
  track->landmark = solved[index].value_or(track->landmark);
  return solved[index].has_value();
}

std::vector<SmootherEstimator::RefusedTrack> SmootherEstimator::FindOutliers(
    const std::vector<FrameGeometry>& geometry, const std::vector<WindowTrack*>& tracks,
    std::vector<RefusedTrack>* refused) const {
  if (config_.vision.gate_unit != GateUnit::kObservation || refused->empty()) {
    return {};
  }
  FrameOutliers frames;
  frames.Begin(geometry.size());
  for (const WindowTrack* track : tracks) {
    for (const WindowView& view : track->views) {
      frames.AddSeen(view.frame->index);
    }
  }
  for (RefusedTrack& entry : *refused) {
    entry.passes = FindOutlyingViews(*entry.track, geometry, gate_, gate_noise_.variance(), &entry.outlying);
    for (size_t i = 0; entry.passes && i < entry.outlying.size(); ++i) {
      frames.AddOutlying(entry.track->views[static_cast<size_t>(entry.outlying[i])].frame->index);
    }
  }
  if (frames.AnySuspect(config_.vision.max_gated_share)) {
    return {};
  }
  const auto mended = std::stable_partition(refused->begin(), refused->end(),
                                            [](const RefusedTrack& entry) { return !entry.passes; });
  std::vector<RefusedTrack> taken(mended, refused->end());
  refused->erase(mended, refused->end());
  return taken;
}

std::vector<SmootherEstimator::RefusedTrack> SmootherEstimator::RefuseTracks(
    const std::vector<FrameGeometry>& geometry, const std::vector<WindowTrack*>& tracks,
    std::span<const std::optional<Eigen::Vector3d>> landmarks, bool* feature_refused) {
  std::vector<RefusedTrack> refused;
  for (size_t i = 0; i < tracks.size(); ++i) {
    WindowTrack* track = tracks[i];
    if (track->anchor == nullptr && !SolveOwnLandmark(geometry, landmarks, i, track)) {
      statistics_.features_degenerate += track->degenerate ? 0 : 1;  // it is counted once
      track->Restart();
      continue;
    }
    const double chi_square = TrackChiSquare(*track, geometry);
    const double at_gate = chi_square / gate_noise_.variance();
    gate_noise_.AddTrack(at_gate, track->dof());
    if (gate_.Accepts(at_gate, track->dof())) {
      pixel_noise_.AddTrack(chi_square, track->dof());
      *feature_refused = !KeepTrack(track) || *feature_refused;
    } else {
      refused.push_back({track, chi_square, {}, false});
    }
  }
  if (IsSuspect(refused.size(), tracks.size()) && gate_noise_.lowered()) {
    gate_noise_.Reset();
    std::erase_if(refused, [&](const RefusedTrack& entry) {
      const bool fits = gate_.Accepts(entry.chi_square, entry.track->dof());
      *feature_refused = (fits && !KeepTrack(entry.track)) || *feature_refused;
      return fits;
    });
  }
  return refused;
}

bool SmootherEstimator::GateTracks(const std::vector<FrameGeometry>& geometry,
                                   const std::vector<WindowTrack*>& tracks, PoseOnlyTerm* solved) {
  bool feature_refused = false;
  std::vector<RefusedTrack> refused = RefuseTracks(
      geometry, tracks,
      solved != nullptr ? solved->SolvedLandmarks() : std::span<const std::optional<Eigen::Vector3d>>(),
      &feature_refused);
  const std::vector<RefusedTrack> mended = FindOutliers(geometry, tracks, &refused);
  statistics_.suspect = IsSuspect(refused.size(), tracks.size());
  if (solved != nullptr && !statistics_.suspect) {
    std::vector<const WindowTrack*> gone;
    for (const std::vector<RefusedTrack>* each : {&std::as_const(refused), &mended}) {
      std::transform(each->begin(), each->end(), std::back_inserter(gone),
                     [](const RefusedTrack& entry) { return entry.track; });
    }
    solved->Remove(gone);
  }
  for (const RefusedTrack& entry : mended) {
    feature_refused = feature_refused || entry.track->anchor != nullptr;
    entry.track->RemoveViews(entry.outlying);
  }
  for (const RefusedTrack& entry : refused) {
    WindowTrack* const track = entry.track;
    feature_refused = feature_refused || track->anchor != nullptr;
    if (statistics_.suspect) {
      track->ScaleInformation(gate_.Threshold(track->dof()) / entry.chi_square);
    } else {
      statistics_.features_gated += track->degenerate ? 0 : 1;
      track->Restart();
    }
  }
  return feature_refused;
}

}  // namespace alidade
