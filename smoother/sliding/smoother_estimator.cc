#include "smoother/sliding/smoother_estimator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/imu_propagation.h"
#include "core/observation_plane.h"
#include "core/stopwatch.h"
#include "smoother/manifold/nav_state_manifold.h"
#include "smoother/sliding/smoother.h"
#include "smoother/solve/sensor_terms.h"
#include "smoother/solve/vision_terms.h"
#include "smoother/solve/window_solver.h"

namespace alidade {
std::unique_ptr<Estimator> MakeSmoother(const EstimatorConfig& config, const RigCalibration& rig) {
  return std::make_unique<SmootherEstimator>(config, rig);
}

SmootherEstimator::SmootherEstimator(const EstimatorConfig& config, const RigCalibration& rig)
    : config_(config),
      rig_(OnPlane(rig, config.vision.observation_plane)),
      noise_(config.imu.Scaled(rig.imu_noise)),
      gravity_W_(GravityInWorld(config.imu.gravity_mps2)),
      kernel_{config.vision.robust_kernel, config.vision.robust_scale_sigma},
      gate_(config.vision.gate_probability),
      imu_(config.imu.max_gap_s),
      read_out_span_s_(ReadOutSpan(GivenCamera(rig_, config.vision))),
      pixel_noise_(config.vision),
      gate_noise_(config.vision),
      rest_(config.vision, config.init, rig_.camera),
      gnss_(config.gnss, rig.gnss, gravity_W_),
      measurements_(config),
      given_(InitialCalibration(config.calibration, GivenCamera(rig_, config.vision),
                                AntennaToWatch(config, rig))),
      calibration_{given_.layout, given_.mean},
      fixed_{{}, given_.mean} {}

Status SmootherEstimator::Initialize(const NavEstimate& initial) {
  calibration_.mean = given_.mean;
  ALIDADE_RETURN_IF_ERROR(Begin(initial));
  calibration_deviations_ = given_.deviations;
  calibration_error_ = given_.error;
  calibration_state_covariance_ = given_.state_covariance;
  AddCalibrationPrior(given_, &prior_);
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
  measurements_.Reset();
  pixel_noise_.Reset();
  gate_noise_.Reset();
  aligned_ = false;
  imu_.StartAt(initial.stamp_ns);
  rest_.Clear();
  latest_ = initial;
  absolute_.reset();
  newest_update_.Begin(latest_, latest_clock_, Eigen::Matrix<double, 6, 15>::Zero());
  statistics_ = {};
  start_shape_is_known_ = false;
  initialized_ = true;
  return Status::Ok();
}

std::optional<CalibrationEstimate> SmootherEstimator::LatestCalibration() const {
  return calibration_.size() > 0 ? std::optional(CalibrationEstimate{
                                       calibration_.layout, calibration_.mean, calibration_deviations_,
                                       given_.watched, calibration_error_, calibration_state_covariance_})
                                 : std::nullopt;
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
  statistics_.pixel_noise_px = pixel_noise_.px();
  window_.newest().repeated = frame.repeated;
  if (!frame.repeated) {
    statistics_.observations_invalid =
        window_.AddObservations(camera().camera, pixel_noise_, frame.observations);
    window_.Prune();
    DetectRest(frame);
  }
  if (window_.size() > 1) {
    std::vector<WindowTrack*> tracks = SelectTracks();
    ALIDADE_RETURN_IF_ERROR(SolveAndGate(&tracks));
  }
  pixel_noise_.EndFrame(window_.newest().stamp_ns, statistics_.suspect);
  gate_noise_.EndFrame(window_.newest().stamp_ns);
  statistics_.update_ms = stopwatch.ElapsedMs() - statistics_.propagate_ms;
  return Status::Ok();
}

Status SmootherEstimator::BeginFrame(TimeNs stamp_ns) {
  const bool first = window_.size() == 1 && window_.tracks().empty();
  if (first && stamp_ns == window_.newest().stamp_ns) {
    return Status::Ok();  // the frame the smoother was initialised on
  }
  ALIDADE_RETURN_IF_ERROR(imu_.Interval(window_.newest().stamp_ns, stamp_ns, &interval_));
  if (!window_.newest().turn) {  // of the frame the smoother was initialised on
    window_.newest().turn = TurnAround(imu_.samples(), window_.newest().stamp_ns, read_out_span_s_);
  }
  imu_.DropBefore(stamp_ns, read_out_span_s_);
  if (config_.vision.rest_updates) {
    rest_.AddImu(interval_);
  }
  std::unique_ptr<WindowFrame> dropped;
  if (!NewestIsKeyframe()) {
    dropped = window_.RemoveNewest();
    MoveMeasurements(dropped.get(), &window_.newest());
  } else if (window_.size() > config_.smoother.window) {
    ALIDADE_RETURN_IF_ERROR(MarginalizeOldestFrame());
  }
  PropagateToNewest(std::move(dropped), stamp_ns);
  return Status::Ok();
}

bool SmootherEstimator::NewestIsKeyframe() const {
  if (window_.newest().repeated && window_.size() > 1) {
    return !MayTakeOutNewest();
  }
  // The prior holds the first frame; with fewer than three frames every one is needed.
  if (config_.smoother.frames == FramePolicy::kEveryFrame || window_.size() <= 2) {
    return true;
  }
  // A frame at rest has no parallax, but its zero velocity is all that holds the position: taken out, the
  // interval around it would be one of free motion, whose scale nothing fixes.
  if (window_.newest().rest) {
    return true;
  }
  if (!MayTakeOutNewest()) {
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
  frame->turn = TurnAround(imu_.samples(), stamp_ns, read_out_span_s_);
  Preintegration preintegration(from.imu_bias(), noise_);
  preintegration.Add(interval_);
  PackNavState(CarryState(preintegration, from.nav_state(), from.imu_bias(), gravity_W_, nullptr),
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
  const RestVerdict verdict = rest_.AddFrame(frame, pixel_noise_.px(), latest_, camera().T_BC);
  statistics_.at_rest = verdict.no_translation;
  if (verdict.no_translation) {
    window_.newest().rest = MakeRestMeasurement(verdict, 1 / TypicalInverseDepth(), rest_.Rates(),
                                                camera().T_BC.translation, config_.vision);
  }
}

Status SmootherEstimator::SolveAndGate(std::vector<WindowTrack*>* tracks) {
  for (int i = 1; i < window_.size(); ++i) {
    UpdatePreintegration(window_.frame(i - 1), noise_, &window_.frame(i));
  }
  window_.UpdateRates();
  DropViewsFromBehind();
  WindowTerms terms;
  SlamPriorTerm* slam = SetPriorTerm(&terms);
  if (const Status status = AddSensorTerms(Sensors(), window_.frames(), window_.size(), &terms);
      !status.ok()) {
    return Lost(status.message());
  }
  const size_t without_vision = terms.size();
  PoseOnlyTerm* pose_only = AddVision(*tracks, &terms);
  AppendScaleVolume(&terms);
  // A watched calibration is none of the solver's unknowns, only of what is known afterwards.
  WindowCalibration& solved = given_.watched ? fixed_ : calibration_;
  const Result<WindowSolveReport> report = SolveWindow(config_.smoother, terms, &window_, &solved);
  if (!report.ok()) {
    return Lost(report.message());
  }
  std::unique_ptr<PoseOnlyTerm> vision;
  if (pose_only != nullptr && !pose_only->SolvedLandmarks().empty()) {
    (void)terms[without_vision].release();
    vision.reset(pose_only);
  }
  terms.resize(without_vision);
  statistics_.iterations = report->iterations;
  window_.Renormalize(solved);
  if (slam != nullptr) {
    ALIDADE_RETURN_IF_ERROR(TakeLandmarks(*slam));
  }
  ALIDADE_RETURN_IF_ERROR(Gate(*tracks, slam != nullptr, std::move(vision), &terms));
  return UpdateLatest(terms);
}

Status SmootherEstimator::UpdateLatest(const WindowTerms& terms) {
  const WindowFrame& newest = window_.newest();
  latest_.stamp_ns = newest.stamp_ns;
  latest_.nav = newest.nav_state();
  latest_.bias = newest.imu_bias();
  if (gnss_.aligned()) {
    latest_clock_.mean = newest.clock_state();
  }
  NewestEstimate known;
  if (!NewestCovariance(window_.frames(), terms, &known, given_.watched)) {
    return Lost("smoother: information at " + FormatSeconds(newest.stamp_ns) + " s is not positive definite");
  }
  latest_.covariance = known.covariance;
  latest_clock_.covariance = known.clock_covariance;
  if (config_.calibration.watch) {
    newest_update_.Begin(latest_, latest_clock_, known.clock_state_covariance);
  }
  calibration_deviations_ = known.calibration_deviations;
  if (given_.watched) {
    calibration_error_ = std::move(known.calibration_error);
    calibration_state_covariance_ = std::move(known.calibration_state_covariance);
  }
  window_information_ = std::move(known.window);
  start_shape_is_known_ = StartShapeIsKnown();
  return Status::Ok();
}

}  // namespace alidade
