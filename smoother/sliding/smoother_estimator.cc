#include "smoother/sliding/smoother_estimator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/imu_propagation.h"
#include "core/stopwatch.h"
#include "smoother/factors/imu_factor.h"
#include "smoother/manifold/nav_state_manifold.h"
#include "smoother/sliding/smoother.h"
#include "smoother/solve/window_system.h"

namespace alidade {

std::unique_ptr<Estimator> MakeSmoother(const EstimatorConfig& config, const RigCalibration& rig) {
  return std::make_unique<SmootherEstimator>(config, rig);
}

SmootherEstimator::SmootherEstimator(const EstimatorConfig& config, const RigCalibration& rig)
    : config_(config),
      rig_(rig),
      noise_(config.imu.Scaled(rig.imu_noise)),
      solve_options_{config.smoother, config.vision, rig.T_BC, GravityInWorld(config.imu.gravity_mps2)},
      kernel_{config.vision.robust_kernel, config.vision.robust_scale_sigma},
      gate_(config.vision.gate_probability),
      imu_(config.imu.max_gap_s),
      rest_(config.vision, config.init, rig.camera),
      gnss_(config.gnss, rig.gnss, solve_options_.gravity_W),
      given_(InitialCalibration(config.calibration, {rig.camera, rig.T_BC, rig.camera_time_offset_s})),
      calibration_{given_.layout, given_.mean} {}

Status SmootherEstimator::Initialize(const NavEstimate& initial) {
  calibration_.mean = given_.mean;
  ALIDADE_RETURN_IF_ERROR(Begin(initial));
  if (calibrates()) {
    calibration_deviations_ = given_.deviations;
    AddCalibrationPrior(given_, &prior_);
  }
  return Status::Ok();
}

Status SmootherEstimator::Begin(const NavEstimate& initial) {
  ALIDADE_RETURN_IF_ERROR(CheckInitialState(initial));
  auto frame = std::make_unique<WindowFrame>();
  frame->stamp_ns = initial.stamp_ns;
  frame->time_offset_s = camera().time_offset_s;
  PackNavState(initial.nav, frame->nav.data());
  PackBias(initial.bias, frame->bias.data());
  LinearPrior prior;
  if (!MakeInitialPrior(config_.smoother.error, *frame, initial.covariance, &prior)) {
    return Status::Input("smoother: initial covariance is not positive semi-definite");
  }
  window_.Clear();
  window_.AddFrame(std::move(frame));
  prior_ = std::move(prior);
  gnss_.Reset();
  imu_.DropBefore(initial.stamp_ns);
  rest_.Clear();
  latest_ = initial;
  statistics_ = {};
  initialized_ = true;
  return Status::Ok();
}

std::optional<CalibrationEstimate> SmootherEstimator::LatestCalibration() const {
  return calibrates() ? std::optional(CalibrationEstimate{calibration_.layout, calibration_.mean,
                                                          calibration_deviations_})
                      : std::nullopt;
}

std::vector<FrameGeometry> SmootherEstimator::Geometry() const {
  return calibrates() ? MakeGeometry(window_, camera()) : MakeGeometry(window_, camera().T_BC);
}

Status SmootherEstimator::AddImu(const ImuSample& sample) {
  return imu_.Add(sample);
}

Status SmootherEstimator::Lost(const std::string& message) {
  initialized_ = false;
  return Status::Diverged(message);
}

Status SmootherEstimator::AddFrame(const TrackFrame& frame) {
  if (!initialized_) {
    return Status::Diverged("smoother: not initialised");
  }
  const Stopwatch stopwatch;
  statistics_ = {};
  has_frames_ = true;
  statistics_.tracks_in = static_cast<int>(frame.observations.size());
  ALIDADE_RETURN_IF_ERROR(BeginFrame(frame.stamp_ns + SecondsToNs(camera().time_offset_s)));
  statistics_.propagate_ms = stopwatch.ElapsedMs();
  statistics_.observations_invalid =
      window_.AddObservations(camera().camera, config_.vision.pixel_noise_px, frame.observations);
  window_.Prune();
  DetectRest(frame);
  if (window_.size() > 1) {
    std::vector<WindowTrack*> tracks = SelectTracks();
    ALIDADE_RETURN_IF_ERROR(SolveAndGate(&tracks));
  }
  statistics_.update_ms = stopwatch.ElapsedMs() - statistics_.propagate_ms;
  return Status::Ok();
}

Status SmootherEstimator::BeginFrame(TimeNs stamp_ns) {
  const bool first = window_.size() == 1 && window_.tracks().empty();
  if (first && stamp_ns == window_.newest().stamp_ns) {
    return Status::Ok();  // the frame the smoother was initialised on
  }
  ALIDADE_RETURN_IF_ERROR(imu_.Interval(window_.newest().stamp_ns, stamp_ns, &interval_));
  imu_.DropBefore(stamp_ns);
  rest_.AddImu(interval_);
  std::unique_ptr<WindowFrame> dropped;
  if (!NewestIsKeyframe()) {
    dropped = window_.RemoveNewest();
    gnss_.Reattach(dropped.get(), &window_.newest());
  } else if (window_.size() > config_.smoother.window) {
    MarginalizeOldestFrame();
  }
  PropagateToNewest(std::move(dropped), stamp_ns);
  return Status::Ok();
}

bool SmootherEstimator::NewestIsKeyframe() const {
  // The prior holds the first frame; with fewer than three frames every one is needed.
  if (config_.smoother.frames == FramePolicy::kEveryFrame || window_.size() <= 2) {
    return true;
  }
  // A frame at rest has no parallax, but its zero velocity is all that holds the position: taken out, the
  // interval around it would be one of free motion, whose scale nothing fixes.
  if (window_.newest().rest) {
    return true;
  }
  const FrameParallax parallax =
      ComputeParallax(window_, window_.frame(window_.size() - 2), window_.newest(), camera().T_BC);
  const auto seen = std::count_if(window_.tracks().begin(), window_.tracks().end(),
                                  [](const auto& item) { return item.second.alive; });
  // Most tracks without a view in the last keyframe would lose the one view they have.
  return parallax.common < config_.smoother.keyframe_min_tracked || 2 * parallax.common < seen ||
         parallax.mean * rig_.camera.mean_focal_px() >= config_.smoother.keyframe_parallax_px;
}

void SmootherEstimator::PropagateToNewest(std::unique_ptr<WindowFrame> dropped, TimeNs stamp_ns) {
  const WindowFrame& from = dropped ? *dropped : window_.newest();
  auto frame = std::make_unique<WindowFrame>();
  frame->stamp_ns = stamp_ns;
  frame->bias = from.bias;
  frame->time_offset_s = camera().time_offset_s;
  frame->gyro_radps = interval_.back().gyro;
  if (!window_.newest().gyro_radps) {
    window_.newest().gyro_radps = interval_.front().gyro;  // of the frame it was initialised on
  }
  Preintegration preintegration(from.imu_bias(), noise_);
  preintegration.Add(interval_);
  PackNavState(
      CarryState(preintegration, from.nav_state(), from.imu_bias(), solve_options_.gravity_W, nullptr),
      frame->nav.data());
  gnss_.PredictClock(from, frame.get());
  if (dropped) {
    frame->preintegration = std::move(dropped->preintegration);
    frame->preintegration->Add(interval_);
    frame->imu = std::move(dropped->imu);
    frame->imu.insert(frame->imu.end(), interval_.begin() + 1, interval_.end());
  } else {
    frame->preintegration = preintegration;
    frame->imu = interval_;
  }
  window_.AddFrame(std::move(frame));
}

void SmootherEstimator::DetectRest(const TrackFrame& frame) {
  if (!config_.vision.rest_updates) {
    return;
  }
  WindowFrame& newest = window_.newest();
  const RestVerdict verdict = rest_.AddFrame(frame, newest.nav_state().R_WB * camera().T_BC.rotation);
  statistics_.at_rest = verdict.no_translation;
  if (verdict.no_translation) {
    newest.rest = MakeRestMeasurement(verdict, rest_.MeanGyro(), config_.vision);
  }
}

std::optional<SlamPrior> SmootherEstimator::MakeSlamPrior() const {
  if (prior_.landmarks.empty()) {
    return std::nullopt;
  }
  return calibrates() ? SlamPrior(&prior_, PriorTracks(prior_, window_), window_, calibration_, kernel_)
                      : SlamPrior(&prior_, PriorTracks(prior_, window_), window_, rig_.T_BC, kernel_);
}

Status SmootherEstimator::SolveAndGate(std::vector<WindowTrack*>* tracks) {
  for (int i = 1; i < window_.size(); ++i) {
    UpdatePreintegration(window_.frame(i - 1), noise_, &window_.frame(i));
  }
  if (calibrates()) {
    window_.UpdateRates();
  }
  std::optional<SlamPrior> slam = MakeSlamPrior();
  const Result<WindowSolveReport> report =
      SolveWindow(solve_options_, prior_, *tracks, &window_, gnss_.context(), slam ? &*slam : nullptr,
                  calibrates() ? &calibration_ : nullptr);
  if (!report.ok()) {
    return Lost(report.message());
  }
  statistics_.iterations = report->iterations;
  if (calibration_.layout.intrinsics() >= 0) {
    window_.Renormalize(camera().camera);
  }

  const std::vector<FrameGeometry> geometry = Geometry();
  SlamPrior::Reduced reduced;
  if (slam && !ReduceSlamPrior(*slam, &reduced)) {
    return Lost("smoother: landmarks at " + FormatSeconds(window_.newest().stamp_ns) + " s have no solution");
  }
  std::vector<WindowTrack*> gated = *tracks;
  for (auto& [id, track] : window_.tracks()) {
    if (track.anchor != nullptr && !track.views.empty()) {
      gated.push_back(&track);
    }
  }
  if (GateTracks(geometry, gated) && slam) {
    slam = MakeSlamPrior();
    if (!ReduceSlamPrior(*slam, &reduced)) {
      return Lost("smoother: landmarks at " + FormatSeconds(window_.newest().stamp_ns) +
                  " s have no solution");
    }
  }
  if (gnss_.aligned()) {
    gnss_.Gate(&window_, &statistics_);
  }
  PoseSystem vision(window_.size(), Calibration());
  for (const WindowTrack* track : *tracks) {
    if (track->views.size() >= kMinViews) {
      AddTrack(track->views, geometry, kernel_, track->landmark, &workspace_, &vision, track->depth_prior);
    }
  }
  statistics_.features_used = vision.tracks + static_cast<int>(gated.size() - tracks->size());
  statistics_.nis = vision.chi2;
  statistics_.nis_dof = vision.dof;
  return UpdateLatest(vision, slam ? &reduced : nullptr);
}

bool SmootherEstimator::ReduceSlamPrior(const SlamPrior& slam, SlamPrior::Reduced* reduced) {
  Eigen::VectorXd landmarks = slam.StartingLandmarks();
  WindowPoint point = PointOf(window_);
  point.camera = camera();
  if (!slam.Reduce(point, &landmarks, reduced)) {
    return false;
  }
  for (size_t i = 0; i < slam.tracks().size(); ++i) {
    if (const WindowTrack* track = slam.tracks()[i]) {
      window_.tracks().at(track->id).landmark = landmarks.segment<3>(3 * static_cast<Eigen::Index>(i));
    }
  }
  return true;
}

Status SmootherEstimator::UpdateLatest(const PoseSystem& vision, const SlamPrior::Reduced* slam) {
  const WindowFrame& newest = window_.newest();
  latest_.stamp_ns = newest.stamp_ns;
  latest_.nav = newest.nav_state();
  latest_.bias = newest.imu_bias();
  if (gnss_.aligned()) {
    latest_clock_.mean = newest.clock_state();
  }
  if (!NewestCovariance(window_, prior_, vision, solve_options_.gravity_W, &latest_.covariance,
                        gnss_.context(), &latest_clock_.covariance, slam,
                        calibrates() ? &calibration_deviations_ : nullptr)) {
    return Lost("smoother: information at " + FormatSeconds(newest.stamp_ns) + " s is not positive definite");
  }
  return Status::Ok();
}

}  // namespace alidade
