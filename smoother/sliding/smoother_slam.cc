// SLAM features of a SmootherEstimator, what leaves with the oldest frame, and the scale of the start.

#include <algorithm>
#include <cmath>

#include "smoother/factors/scale_volume_factor.h"
#include "smoother/factors/spread.h"
#include "smoother/sliding/smoother_estimator.h"
#include "smoother/solve/factor_term.h"
#include "smoother/solve/marginalization.h"
#include "smoother/solve/vision_terms.h"

namespace alidade {
namespace {

// A landmark joins the prior once its depth is known so well, relative to the window's scale, that its rows
// are close to linear: largest relative deviation of the inverse depth with the poses held fixed.
constexpr double kMaxFeatureDepthDeviation = 0.1;
// Largest deviation of the shape of the window, relative to its size, with which the prior separates shape
// and scale. Above (rest, rotation in place) the spread is hardly more than the errors of single positions.
constexpr double kMaxShapeDeviation = 0.1;
// The same where the volume of the start's scales counts: the first frames determine the shape less well.
constexpr double kMaxStartShapeDeviation = 0.3;
// Of the start's velocity. Tracks determine two components of three, but the velocity that is given is longer
// than the true one already, in the mean, by the same two.
constexpr double kStartFreedom = 1;
// Largest relative deviation of the window's scale with which it takes in landmarks.
constexpr double kMaxScaleDeviation = 0.1;
constexpr size_t kMinFeatureViews = 3;

/// Standard deviations of the camera's positions about their mean, up to rotation and shift of the whole
/// window, relative to their root sum of squares: along their scale, and root sum of squares of the rest.
/// Infinite or not a number without motion.
struct PositionDeviations {
  double scale;
  double shape;
};
PositionDeviations DeviationsOf(const WindowInformation& information, const Window& window,
                                const CameraCalibration& camera) {
  const Shape shape = ShapeOf(PointOf(window, camera).states, camera.T_BC.translation);
  const Eigen::MatrixXd whitened = information.Whitened(shape.jacobian);
  const double size = shape.positions.norm();
  const double scale = (whitened * shape.positions.reshaped().normalized()).squaredNorm();
  return {std::sqrt(scale) / size, std::sqrt(std::max(0.0, whitened.squaredNorm() - scale)) / size};
}

/// Gives a feature the newest frame as its anchor; false when it lies behind it. Its coordinates are those of
/// its anchor when the middle row was exposed; before, those of the base's row.
bool AnchorIn(const WindowFrame& newest, const std::vector<FrameGeometry>& geometry, WindowTrack* track) {
  FrameGeometry row;
  const FrameGeometry& before = track->anchor != nullptr ? geometry[static_cast<size_t>(track->anchor->index)]
                                                         : AtRow(geometry, track->views.front(), &row);
  const FrameGeometry& after = geometry[static_cast<size_t>(newest.index)];
  const AnchorPlanes planes{track->plane(), PlaneInAnchor(before, track->plane(), after, track->landmark)};
  AnchorChange change;
  if (!ChangeAnchor(before, after, track->landmark, &change, {}, planes)) {
    return false;
  }
  track->landmark = change.to;
  track->anchor = &newest;
  track->anchor_plane = planes.to;
  return true;
}

}  // namespace

void SmootherEstimator::DropViewsFromBehind() {
  const std::vector<WindowTrack*> features = FeaturesInSight();
  if (features.empty()) {
    return;
  }
  const std::vector<FrameGeometry> geometry = Geometry();
  AnchoredRows rows;
  for (WindowTrack* feature : features) {
    const size_t before = feature->views.size();
    std::erase_if(feature->views, [&](const WindowView& view) {
      return !LinearizeAnchoredView(*feature, view, geometry, {}, feature->landmark, &rows, false,
                                    NotCalibrated());
    });
    statistics_.features_degenerate += feature->views.size() < before ? 1 : 0;
  }
}

SlamPriorTerm* SmootherEstimator::SetPriorTerm(WindowTerms* terms) const {
  if (terms->empty()) {
    terms->emplace_back();
  }
  if (prior_.landmarks.empty() && !(prior_.spread > 0)) {
    terms->front() = MakePriorTerm(prior_, calibration_);
    return nullptr;
  }
  auto slam = std::make_unique<SlamPriorTerm>(prior_, window_, calibration_, kernel_);
  SlamPriorTerm* const made = slam.get();
  terms->front() = std::move(slam);
  return made;
}

std::vector<WindowTrack*> SmootherEstimator::StayingFeatures(const std::vector<FrameGeometry>& geometry) {
  std::vector<WindowTrack*> staying;
  for (const LinearPrior::Landmark& landmark : prior_.landmarks) {
    const auto found = window_.tracks().find(landmark.track_id);
    if (found == window_.tracks().end() || found->second.anchor == nullptr || !found->second.alive) {
      continue;
    }
    WindowTrack& track = found->second;
    if (track.anchor->index > 0 || AnchorIn(window_.newest(), geometry, &track)) {
      staying.push_back(&track);
    }
  }
  return staying;
}

bool SmootherEstimator::DepthIsKnown(const std::vector<FrameGeometry>& geometry,
                                     const WindowTrack& track) const {
  const std::optional<double> deviation =
      InverseDepthDeviation(track.views, geometry, kernel_, track.landmark);
  return deviation && *deviation < kMaxFeatureDepthDeviation * track.landmark.z();
}

std::vector<WindowTrack*> SmootherEstimator::NewFeatures(const std::vector<FrameGeometry>& geometry,
                                                         size_t free) {
  std::vector<WindowTrack*> candidates;
  const double max_deviation = MaxInverseDepthDeviation();
  for (auto& [id, track] : window_.tracks()) {
    if (free > 0 && track.anchor == nullptr && track.alive && track.views.size() >= kMinFeatureViews &&
        track.views.front().frame->index == 0 &&
        PrepareLandmark(geometry, max_deviation, &track) == Landmark::kReady &&
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
    if (promoted.size() < free && AnchorIn(window_.newest(), geometry, track)) {
      promoted.push_back(track);
    }
  }
  return promoted;
}

std::vector<const WindowTrack*> SmootherEstimator::LeavingTracks(const std::vector<FrameGeometry>& geometry) {
  std::vector<const WindowTrack*> leaving;
  const double max_deviation = MaxInverseDepthDeviation();
  for (auto& [id, track] : window_.tracks()) {
    if (track.anchor == nullptr && track.views.size() >= kMinViews && track.views.front().frame->index == 0 &&
        PrepareLandmark(geometry, max_deviation, &track) == Landmark::kReady &&
        SolveLandmark(track.views, geometry, kernel_, kMaxLandmarkIterations, &track.landmark)) {
      leaving.push_back(&track);
    }
  }
  return leaving;
}

Status SmootherEstimator::MarginalizeOldestFrame() {
  const std::vector<FrameGeometry> geometry = Geometry();
  const size_t limit = static_cast<size_t>(config_.smoother.slam_features);
  SlamChange slam{PriorTracks(prior_, window_), {}, kernel_};
  bool takes_in = false;
  if (limit > 0) {
    const PositionDeviations known = DeviationsOf(window_information_, window_, calibration_.mean);
    slam.relative_to_spread = known.shape < kMaxShapeDeviation;
    takes_in = slam.relative_to_spread && known.scale < kMaxScaleDeviation;
  }
  const std::vector<WindowTrack*> staying = StayingFeatures(geometry);
  const std::vector<WindowTrack*> promoted =
      NewFeatures(geometry, takes_in ? limit - std::min(limit, staying.size()) : 0);
  slam.after.assign(staying.begin(), staying.end());
  slam.after.insert(slam.after.end(), promoted.begin(), promoted.end());

  auto vision = std::make_unique<PoseOnlyTerm>(window_, LeavingTracks(geometry), calibration_, kernel_);
  const std::vector<const WindowTrack*> gone = vision->used();
  WindowTerms terms;
  if (const Status status = AddSensorTerms(Sensors(), window_.frames(), 2, &terms); !status.ok()) {
    return Lost(status.message());
  }
  terms.insert(terms.begin() + 1, std::move(vision));
  AppendScaleVolume(&terms);
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

bool SmootherEstimator::StartShapeIsKnown() const {
  return config_.smoother.scale_volume && StartIsInWindow() &&
         DeviationsOf(window_information_, window_, calibration_.mean).shape < kMaxStartShapeDeviation;
}

void SmootherEstimator::AppendScaleVolume(WindowTerms* terms) const {
  if (!start_shape_is_known_ || !StartIsInWindow()) {
    return;
  }
  std::vector<TermBlock> blocks;
  for (int i = 0; i < window_.size(); ++i) {
    blocks.push_back(NavBlock(window_.frame(i)));
    blocks.back().width = kPoseColumns;
  }
  const Eigen::Vector3d point_B = calibration_.mean.T_BC.translation;
  const double spread_m = SpreadOf(PointOf(window_, calibration_.mean).states, point_B).metres;
  terms->push_back(
      MakeTerm(ScaleVolumeFactor(window_.size(), point_B, spread_m, kStartFreedom), std::move(blocks)));
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
