// SLAM features of a SmootherEstimator, and what leaves with the oldest frame.

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "smoother/sliding/smoother_estimator.h"
#include "smoother/solve/marginalization.h"
#include "smoother/solve/vision_terms.h"

namespace alidade {
namespace {

// A landmark joins the prior once its depth is known so well that its rows are close to linear: largest
// relative deviation of the inverse depth with the poses held fixed. With 0.1 a slow figure-8 had a pose NEES
// of 35 where 6 is right, with 0.04 7 (docs/smoother.md).
constexpr double kMaxFeatureDepthDeviation = 0.04;
// Share of it that the poses' uncertainty may add. That part is the scale of the window: it is common to all
// landmarks and biases the scale, where a landmark's own part averages out.
constexpr double kStateShare = 0.5;
constexpr size_t kMinFeatureViews = 3;
// Largest product of three shares: the depth's own deviation, how far the camera has approached the landmark
// over the window, and the deviation of the window's scale. Rows are linear in the inverse depth at one
// place; while the camera approaches the landmark, what they neglect grows, with the same sign for all
// landmarks: that of a larger scale. It does not matter where the IMU tells the scale (docs/smoother.md).
constexpr double kMaxApproachDeviation = 7e-5;

/// Whether the depth is known well enough for how the camera has approached it: rho_before in the window's
/// oldest camera, `landmark` in `anchor`, the newest. Of the views in the window alone.
bool StaysLinear(const std::vector<FrameGeometry>& geometry, const std::vector<WindowView>& views,
                 double rho_before, const FrameGeometry& anchor, const Eigen::Vector3d& landmark,
                 const BearingPlane& plane, double scale_deviation) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const WindowView& view : views) {
    FrameGeometry row;
    AnchoredRows rows;
    if (LinearizeAnchoredView(anchor, AtRow(geometry, view, &row), view.observation, {}, landmark, &rows,
                              false, NotCalibrated(), plane)) {
      information.noalias() += rows.landmark.transpose() * rows.landmark;
    }
  }
  const double own = std::sqrt(information.inverse()(2, 2)) / landmark.z();
  const double deviation = own < 1 ? own : 1;  // not a number where the camera has not moved
  return deviation * std::abs(landmark.z() / rho_before - 1) * scale_deviation < kMaxApproachDeviation;
}

/// Relative standard deviation of the line from the oldest camera to the newest.
double ScaleDeviation(const WindowInformation& information, const std::vector<FrameGeometry>& geometry) {
  const Eigen::Vector3d line = geometry.back().T_WC.translation - geometry.front().T_WC.translation;
  if (!(line.squaredNorm() > 0)) {
    return 0;  // no camera has approached anything
  }
  const auto poses = kPoseColumns * static_cast<Eigen::Index>(geometry.size());
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(poses);
  row.segment<3>(3) = -line.transpose() / line.squaredNorm();
  row.tail<3>() = line.transpose() / line.squaredNorm();
  return information.Deviation(row);
}

/// Gives a feature the newest frame as its anchor; false when it is to have none. Its coordinates are those
/// of its anchor when the middle row was exposed; before, those of the base's row.
bool AnchorIn(const WindowFrame& newest, const std::vector<FrameGeometry>& geometry, double scale_deviation,
              WindowTrack* track) {
  FrameGeometry row;
  const FrameGeometry& before = track->anchor != nullptr ? geometry[static_cast<size_t>(track->anchor->index)]
                                                         : AtRow(geometry, track->views.front(), &row);
  const FrameGeometry& after = geometry[static_cast<size_t>(newest.index)];
  const AnchorPlanes planes{track->plane(), PlaneInAnchor(before, track->plane(), after, track->landmark)};
  AnchorChange change;
  if (!ChangeAnchor(before, after, track->landmark, &change, {}, planes) ||
      !StaysLinear(geometry, track->views, track->landmark.z(), after, change.to, planes.to,
                   scale_deviation)) {
    return false;
  }
  track->landmark = change.to;
  track->anchor = &newest;
  track->anchor_plane = planes.to;
  return true;
}

}  // namespace

SlamPriorTerm* SmootherEstimator::SetPriorTerm(const LinearPrior& prior, const WindowCalibration& calibration,
                                               WindowTerms* terms) const {
  if (terms->empty()) {
    terms->emplace_back();
  }
  if (prior.landmarks.empty()) {
    terms->front() = MakePriorTerm(prior, calibration);
    return nullptr;
  }
  auto slam = std::make_unique<SlamPriorTerm>(prior, window_, calibration, kernel_);
  SlamPriorTerm* const made = slam.get();
  terms->front() = std::move(slam);
  return made;
}

std::vector<WindowTrack*> SmootherEstimator::StayingFeatures(const std::vector<FrameGeometry>& geometry,
                                                             double scale_deviation) {
  std::vector<WindowTrack*> staying;
  for (const LinearPrior::Landmark& landmark : prior_.landmarks) {
    const auto found = window_.tracks().find(landmark.track_id);
    if (found == window_.tracks().end() || found->second.anchor == nullptr || !found->second.alive) {
      continue;
    }
    WindowTrack& track = found->second;
    if (track.anchor->index > 0 || AnchorIn(window_.newest(), geometry, scale_deviation, &track)) {
      staying.push_back(&track);
    }
  }
  return staying;
}

bool SmootherEstimator::DepthIsKnown(const std::vector<FrameGeometry>& geometry,
                                     const WindowTrack& track) const {
  const std::optional<InverseDepthError> error =
      LinearizeInverseDepth(track.views, geometry, kernel_, track.landmark);
  const double bound = kMaxFeatureDepthDeviation * track.landmark.z();
  return error && error->own_deviation < bound &&
         window_information_.Deviation(error->row) < kStateShare * bound;
}

std::vector<WindowTrack*> SmootherEstimator::NewFeatures(const std::vector<FrameGeometry>& geometry,
                                                         double scale_deviation, size_t free) {
  std::vector<WindowTrack*> candidates;
  for (auto& [id, track] : window_.tracks()) {
    if (free > 0 && track.anchor == nullptr && track.alive && track.views.size() >= kMinFeatureViews &&
        track.views.front().frame->index == 0 && PrepareLandmark(geometry, &track) == Landmark::kReady &&
        SolveLandmark(track.views, geometry, kernel_, kMaxLandmarkIterations, &track.landmark) &&
        DepthInRange(track.landmark) && DepthIsKnown(geometry, track)) {
      candidates.push_back(&track);
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const WindowTrack* a, const WindowTrack* b) {
    return a->views.size() > b->views.size();
  });
  std::vector<WindowTrack*> promoted;
  for (WindowTrack* track : candidates) {
    if (promoted.size() < free && AnchorIn(window_.newest(), geometry, scale_deviation, track)) {
      promoted.push_back(track);
    }
  }
  return promoted;
}

Status SmootherEstimator::MarginalizeOldestFrame() {
  const WindowFrame* oldest = &window_.frame(0);
  const std::vector<FrameGeometry> geometry = Geometry();
  const size_t limit = static_cast<size_t>(config_.smoother.slam_features);
  const double scale_deviation = limit > 0 ? ScaleDeviation(window_information_, geometry) : 0;
  SlamChange slam{PriorTracks(prior_, window_), {}, kernel_};
  const std::vector<WindowTrack*> staying = StayingFeatures(geometry, scale_deviation);
  const std::vector<WindowTrack*> promoted =
      NewFeatures(geometry, scale_deviation, limit - std::min(limit, staying.size()));
  slam.after.assign(staying.begin(), staying.end());
  slam.after.insert(slam.after.end(), promoted.begin(), promoted.end());

  std::vector<const WindowTrack*> leaving;
  for (auto& [id, track] : window_.tracks()) {
    if (track.anchor == nullptr && !track.views.empty() && track.views.front().frame == oldest &&
        track.views.size() >= kMinViews && PrepareLandmark(geometry, &track) == Landmark::kReady &&
        SolveLandmark(track.views, geometry, kernel_, kMaxLandmarkIterations, &track.landmark)) {
      leaving.push_back(&track);
    }
  }
  auto vision = std::make_unique<PoseOnlyTerm>(window_, std::move(leaving), calibration_, kernel_);
  const std::vector<const WindowTrack*> gone = vision->used();
  WindowTerms terms;
  if (const Status status = AddSensorTerms(Sensors(calibration_), window_.frames(), 2, &terms);
      !status.ok()) {
    return Lost(status.message());
  }
  terms.insert(terms.begin() + 1, std::move(vision));
  Result<LinearPrior> next = MarginalizeOldest(window_, prior_, calibration_, terms, slam);
  if (!next.ok()) {
    return Lost(next.message());
  }
  prior_ = std::move(*next);
  if (config_.smoother.first_estimates) {
    KeepFirstEstimates(prior_, &window_);
  }
  for (const WindowTrack* track : gone) {
    window_.tracks().at(track->id).Restart();
  }
  for (const WindowTrack* track : slam.before) {
    if (track != nullptr && std::find(slam.after.begin(), slam.after.end(), track) == slam.after.end()) {
      window_.tracks().at(track->id).Restart();
    }
  }
  window_.RemoveOldest();
  window_.Prune();
  return Status::Ok();
}

std::vector<WindowTrack*> SmootherEstimator::FeaturesInSight() {
  std::vector<WindowTrack*> features;
  for (auto& [id, track] : window_.tracks()) {
    if (track.anchor != nullptr && !track.views.empty()) {
      features.push_back(&track);
    }
  }
  return features;
}

Status SmootherEstimator::TakeLandmarks(const SlamPriorTerm& slam) {
  const Eigen::VectorXd* landmarks = slam.Landmarks();
  if (landmarks == nullptr) {
    return Lost("smoother: landmarks at " + FormatSeconds(window_.newest().stamp_ns) + " s have no solution");
  }
  const std::span<const WindowTrack* const> tracks = slam.slam().tracks();
  for (size_t i = 0; i < tracks.size(); ++i) {
    if (tracks[i] != nullptr) {
      window_.tracks().at(tracks[i]->id).landmark = landmarks->segment<3>(3 * static_cast<Eigen::Index>(i));
    }
  }
  return Status::Ok();
}

}  // namespace alidade
