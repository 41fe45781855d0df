#include "smoother/batch/batch_sequence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/imu_propagation.h"
#include "core/observation_plane.h"
#include "core/pixel_noise.h"
#include "core/scene_depth.h"
#include "smoother/factors/imu_factor.h"
#include "smoother/factors/measurement_factor.h"
#include "smoother/tracks/track_landmark.h"
#include "smoother/tracks/track_system.h"

namespace alidade {
namespace {

// Every solve linearises anew and works on inverse depths, so a track may enter as soon as its depth is known
// to its own size; below that it would hold hardly more than rotation, and the inverse depth is not Gaussian.
constexpr double kMaxDepthDeviation = 1.0;
constexpr int kMaxLandmarkIterations = 50;
constexpr size_t kMinViews = 2;
// Deviations of the alignment in the prior [rad, m]. The alignment holds at its own time, and the odometry
// has drifted since the first state, so that its covariance is too small there; the fixes determine yaw and
// position anyway. Much more would be lost beside the information between frames.
constexpr double kFreeYawStd = 1;
constexpr double kFreeShiftStd = 10;

std::unique_ptr<WindowFrame> MakeFrame(const NavEstimate& estimate, int index) {
  auto frame = std::make_unique<WindowFrame>();
  frame->stamp_ns = estimate.stamp_ns;
  frame->index = index;
  PackNavState(estimate.nav, frame->nav.data());
  PackBias(estimate.bias, frame->bias.data());
  return frame;
}

/// Of the whitened residual at the frame's present state.
double SquaredNorm(const FrameMeasurement& attached, const WindowFrame& frame,
                   const Eigen::Vector3d& gravity_W) {
  const double* const blocks[] = {frame.nav.data(), frame.bias.data()};
  return std::visit(
      [&](const auto& kind) {
        using Kind = std::decay_t<decltype(kind)>;
        typename Kind::Residual residual;
        MeasurementFactor<Kind>(&attached, gravity_W).Evaluate(blocks, residual.data(), nullptr);
        return residual.squaredNorm();
      },
      attached.measurement);
}

}  // namespace

ObservationKernel GuardKernel(const VisionConfig& vision) {
  return {RobustKernel::kHuber, vision.robust_scale_sigma};
}

BatchSequence::BatchSequence(const EstimatorConfig& config, const RigCalibration& rig)
    : config_(config),
      rig_(OnPlane(rig, config.vision.observation_plane)),
      kernel_{config.batch.robust_kernel, config.vision.robust_scale_sigma},
      gate_(config.batch.gate_probability),
      rest_(config.vision, config.init, rig_.camera),
      calibration_{{}, GivenCamera(rig_, config.vision)},
      gnss_(config.gnss, rig.gnss, GravityInWorld(config.imu.gravity_mps2)) {
  calibration_.mean.time_offset_s = 0;  // frames come in IMU time
}

bool BatchSequence::Start(const NavEstimate& initial) {
  frames_.clear();
  invalid_.assign(1, 0);
  tracks_.clear();
  track_of_id_.clear();
  measurements_.clear();
  gnss_.Clear();
  rest_.Clear();
  frames_.push_back(MakeFrame(initial, 0));
  initial_ = initial;
  return MakeInitialPrior(config_.smoother.error, *frames_.front(), initial_.covariance, &prior_);
}

bool BatchSequence::Align(const GnssAlignment& alignment) {
  for (const std::unique_ptr<WindowFrame>& frame : frames_) {
    const NavEstimate local{frame->stamp_ns, frame->nav_state(), frame->imu_bias(), initial_.covariance};
    PackNavState(TurnIntoEnu(alignment, local).nav, frame->nav.data());
  }
  GnssAlignment free = alignment;
  free.covariance =
      Eigen::Vector4d(kFreeYawStd, kFreeShiftStd, kFreeShiftStd, kFreeShiftStd).cwiseAbs2().asDiagonal();
  initial_ = TurnIntoEnu(free, initial_);
  const bool made = MakeInitialPrior(config_.smoother.error, *frames_.front(), initial_.covariance, &prior_);
  if (made && alignment.clock) {
    gnss_.Align(alignment, frames_, &prior_);
  }
  return made;
}

void BatchSequence::AddGnss(const GnssEpoch& epoch, std::vector<ImuSample> imu) {
  gnss_.AddEpoch(epoch, std::move(imu), config_.imu.Scaled(rig_.imu_noise), frames_.back().get());
}

Status BatchSequence::AddMeasurement(const Measurement& measurement, bool accepted,
                                     std::vector<ImuSample> imu) {
  const Result<WhitenedMeasurement> whitened = Whiten(config_, rig_, measurement);
  ALIDADE_RETURN_IF_ERROR(whitened.status());
  BatchMeasurement& added = measurements_.emplace_back();
  added.attached.measurement = *whitened;
  added.attached.imu = std::move(imu);
  added.frame = frames_.back()->index;
  added.weight = accepted ? 1 : 0;
  return Status::Ok();
}

void BatchSequence::AddFrame(const NavEstimate& estimate, std::vector<ImuSample> imu,
                             std::span<const ImuSample> around) {
  rest_.AddImu(imu);
  const double span_s = ReadOutSpan(GivenCamera(rig_, config_.vision));
  if (!frames_.back()->turn) {
    frames_.back()->turn = TurnAround(around, frames_.back()->stamp_ns, span_s);
  }
  frames_.push_back(MakeFrame(estimate, static_cast<int>(frames_.size())));
  frames_.back()->turn = TurnAround(around, estimate.stamp_ns, span_s);
  frames_.back()->imu = std::move(imu);
  gnss_.AddFrame(frames_);
  invalid_.push_back(0);
}

void BatchSequence::AddTracks(const NavEstimate& estimate, const TrackFrame& frame) {
  WindowFrame& node = *frames_.back();
  AddObservations(frame, node);
  if (config_.vision.rest_updates && !frame.repeated) {
    const RestVerdict verdict = rest_.AddFrame(frame, config_.vision.pixel_noise_px, estimate, rig_.T_BC);
    if (verdict.no_translation) {
      node.rest =
          MakeRestMeasurement(verdict, kRoomDepth, rest_.Rates(), rig_.T_BC.translation, config_.vision);
    }
  }
}

void BatchSequence::AddObservations(const TrackFrame& frame, const WindowFrame& node) {
  const PixelNoise noise(config_.vision);
  for (const TrackObservation& measured : frame.observations) {
    NormalizedObservation observation;
    if (!NormalizeObservation(rig_.camera, measured.pixel, noise.Of(measured), &observation)) {
      ++invalid_.back();
      continue;
    }
    const auto [entry, is_new] = track_of_id_.try_emplace(measured.track_id, tracks_.size());
    if (is_new) {
      tracks_.emplace_back();
      tracks_.back().used.id = measured.track_id;
    }
    std::vector<WindowView>& views = tracks_[entry->second].views;
    if (!views.empty() && views.back().frame == &node) {  // twice in one frame: the first counts
      ++invalid_.back();
      continue;
    }
    views.push_back({&node, observation});
  }
}

void BatchSequence::Preintegrate() {
  const ImuNoise noise = config_.imu.Scaled(rig_.imu_noise);
  for (size_t i = 1; i < frames_.size(); ++i) {
    frames_[i]->preintegration.emplace(frames_[i - 1]->imu_bias(), noise);
    frames_[i]->preintegration->Add(frames_[i]->imu);
  }
  for (const std::unique_ptr<WindowFrame>& frame : frames_) {
    for (FrameMeasurement& measurement : frame->measurements) {
      measurement.Set(std::move(measurement.imu), frame->imu_bias(), noise);
    }
    for (FrameEpoch& epoch : frame->epochs) {
      epoch.Set(std::move(epoch.imu), frame->imu_bias(), noise);
    }
  }
}

void BatchSequence::SelectMeasurements(bool gate, TrackSelection* selection) {
  for (const std::unique_ptr<WindowFrame>& frame : frames_) {
    frame->measurements.clear();
  }
  const ImuNoise noise = config_.imu.Scaled(rig_.imu_noise);
  const Eigen::Vector3d gravity_W = GravityInWorld(config_.imu.gravity_mps2);
  MeasurementGates gates(config_);
  for (BatchMeasurement& measurement : measurements_) {
    WindowFrame& frame = *frames_[static_cast<size_t>(measurement.frame)];
    FrameMeasurement& attached = measurement.attached;
    attached.Set(std::move(attached.imu), frame.imu_bias(), noise);
    const bool was_used = measurement.weight > 0;
    if (gate) {
      measurement.weight =
          gates.Weigh(SensorOf(attached.measurement), SquaredNorm(attached, frame, gravity_W));
    }
    if (measurement.weight > 0) {
      ++selection->measurements;
      frame.measurements.push_back(attached);
      frame.measurements.back().ScaleSqrtInformation(std::sqrt(measurement.weight));
    }
    selection->changed = selection->changed || was_used != (measurement.weight > 0);
  }
}

TrackSelection BatchSequence::Select(bool gate) {
  std::vector<FrameGeometry> geometry;
  geometry.reserve(frames_.size());
  for (const std::unique_ptr<WindowFrame>& frame : frames_) {
    UpdateRates(frame.get());
    geometry.push_back(MakeGeometry(*frame, frame->nav_state(), calibration_.mean));
  }
  TrackSelection selection;
  SelectMeasurements(gate, &selection);
  selection.changed = gnss_.Select(gate, config_.imu.Scaled(rig_.imu_noise), frames_) || selection.changed;
  for (BatchTrack& track : tracks_) {
    if (track.views.size() < kMinViews) {
      continue;
    }
    const bool was_selected = track.selected;
    const size_t views_before = track.used.views.size();
    track.selected = SelectTrack(geometry, gate, &selection, &track);
    if (track.selected) {
      ++selection.tracks;
      selection.observations += static_cast<int>(track.used.views.size());
    }
    selection.changed = selection.changed || track.selected != was_selected ||
                        (track.selected && track.used.views.size() != views_before);
  }
  return selection;
}

bool BatchSequence::SelectTrack(const std::vector<FrameGeometry>& geometry, bool gate,
                                TrackSelection* selection, BatchTrack* track) const {
  WindowTrack& used = track->used;
  used.views = gate ? Inliers(geometry, *track) : track->views;
  selection->outliers += static_cast<int>(track->views.size() - used.views.size());
  used.has_landmark = used.views.size() >= kMinViews &&
                      InitializeLandmark(used.views, geometry, kMaxDepthDeviation, &used.landmark) &&
                      SolveLandmark(used.views, geometry, gate ? kernel_ : GuardKernel(config_.vision),
                                    kMaxLandmarkIterations, &used.landmark);
  if (!used.has_landmark) {
    ++selection->without_depth;
    return false;
  }
  const int dof = 2 * static_cast<int>(used.views.size()) - 3;
  if (gate && !gate_.Accepts(TrackChiSquare(used.views, geometry, used.landmark), dof)) {
    ++selection->gated;
    return false;
  }
  return true;
}

std::vector<WindowView> BatchSequence::Inliers(const std::vector<FrameGeometry>& geometry,
                                               const BatchTrack& track) const {
  const ObservationKernel guard = GuardKernel(config_.vision);
  Eigen::Vector3d landmark;
  if (!InitializeLandmark(track.views, geometry, kMaxDepthDeviation, &landmark) ||
      !SolveLandmark(track.views, geometry, guard, kMaxLandmarkIterations, &landmark)) {
    return track.views;
  }
  FrameGeometry base_row;
  FrameGeometry view_row;
  const FrameGeometry& base = AtRow(geometry, track.views.front(), &base_row);
  std::vector<WindowView> inliers;
  for (const WindowView& view : track.views) {
    ViewRows rows;
    if (LinearizeView(base, AtRow(geometry, view, &view_row), view.observation, guard, landmark, &rows,
                      track.views.front().observation.plane) &&
        gate_.Accepts(rows.squared_norm, 2)) {
      inliers.push_back(view);
    }
  }
  return inliers;
}

std::vector<WindowTrack*> BatchSequence::SelectedTracks() {
  std::vector<WindowTrack*> selected;
  for (BatchTrack& track : tracks_) {
    if (track.selected) {
      selected.push_back(&track.used);
    }
  }
  return selected;
}

}  // namespace alidade
