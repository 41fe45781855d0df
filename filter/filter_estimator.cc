#include "filter/filter_estimator.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/observation_plane.h"
#include "core/rest_model.h"
#include "core/stopwatch.h"
#include "filter/leaving_clone.h"

namespace alidade {
namespace {

// Of the window, the views of a track that updates together with all others after the first window: the
// depths of shorter ones are biased, and so is the motion that they alone determine.
constexpr double kLeastShareOfWindow = 0.4;

}  // namespace

FilterEstimator::FilterEstimator(const EstimatorConfig& config, const RigCalibration& rig)
    : config_(config),
      rig_(OnPlane(rig, config.vision.observation_plane)),
      noise_(config.imu.Scaled(rig.imu_noise)),
      gravity_W_(GravityInWorld(config.imu.gravity_mps2)),
      gate_(config.vision.gate_probability),
      state_(config.filter.error, config.filter.first_estimates,
             InitialCalibration(config.calibration, GivenCamera(rig_, config.vision),
                                AntennaToWatch(config, rig)),
             {config.filter.window + 1, config.filter.slam_features, config.gnss.enabled,
              config.filter.max_direction_deviation > 0, config.filter.update_precision}),
      update_(config.filter, config.vision, config.filter.window + 1, state_.layout().size()),
      slam_(config.filter, config.filter.window + 1),
      tracks_(config.filter.window + 1, config.filter.track_memory != TrackMemoryPolicy::kNone,
              state_.layout().size()),
      gnss_(config.gnss, rig.gnss),
      measurements_(config),
      rest_(config.vision, config.init, rig_.camera),
      imu_(config.imu.max_gap_s),
      read_out_span_s_(ReadOutSpan(state_.calibration())),
      pixel_noise_(config.vision),
      gate_noise_(config.vision),
      scale_direction_(state_.covariance().capacity()),
      correction_(state_.covariance().capacity()),
      corrected_(state_.covariance().capacity()),
      moved_(state_.covariance().capacity()),
      whitened_(state_.covariance().capacity()) {
  appended_.reserve(kUsualTracks);
  degenerate_.reserve(kUsualTracks);
  left_.reserve(kUsualTracks);
  accepted_.reserve(kUsualTracks);
  block_nis_.reserve(kUsualTracks);
  misfits_.reserve(kUsualTracks);
  weights_.reserve(kUsualTracks);
  outliers_.reserve(kUsualTracks);
  const auto clones = static_cast<size_t>(config.filter.window) + 1;
  outlying_.reserve(clones);
  clone_outliers_.Reserve(clones);
  snooped_.resize(2 * config.filter.window + 2);
}

Status FilterEstimator::Initialize(const NavEstimate& initial) {
  ALIDADE_RETURN_IF_ERROR(state_.Reset(initial));
  tracks_.Clear();
  gnss_.Reset();
  measurements_.Reset();
  pixel_noise_.Reset();
  gate_noise_.Reset();
  aligned_ = false;
  absolute_.reset();
  rest_.Clear();
  update_.ForgetSceneDepth();
  imu_.StartAt(initial.stamp_ns, read_out_span_s_);
  frame_stamp_ns_ = INT64_MIN;
  statistics_ = {};
  initialized_ = true;
  first_serial_ = serial_ + 1;
  return Status::Ok();
}

void FilterEstimator::SetObserver(FilterObserver* observer) {
  observer_ = observer;
  state_.SetObserver(observer);
  gnss_.SetObserver(observer);
  measurements_.SetObserver(observer);
  update_.SetTracing(observer != nullptr);
}

std::optional<CalibrationEstimate> FilterEstimator::LatestCalibration() const {
  return state_.layout().size() > 0 ? std::optional(state_.EstimatedCalibration()) : std::nullopt;
}

Status FilterEstimator::AddImu(const ImuSample& sample) {
  return imu_.Add(sample);
}

Status FilterEstimator::PropagateTo(TimeNs stamp_ns) {
  if (stamp_ns == state_.stamp_ns() && stamp_ns > frame_stamp_ns_) {
    return Status::Ok();  // where the filter was initialised, or the stamp of an epoch
  }
  ALIDADE_RETURN_IF_ERROR(imu_.Interval(state_.stamp_ns(), stamp_ns, &interval_));
  const Status propagated = state_.Propagate(interval_, noise_, gravity_W_);
  if (!propagated.ok()) {
    initialized_ = false;
    return Status::Diverged("filter: up to " + FormatSeconds(stamp_ns) + " s " + propagated.message());
  }
  imu_.DropBefore(stamp_ns, read_out_span_s_);
  if (config_.vision.rest_updates) {
    rest_.AddImu(interval_);
  }
  return Status::Ok();
}

Status FilterEstimator::AddFrame(const TrackFrame& frame) {
  if (!initialized_) {
    return Status::Diverged("filter: not initialised");
  }
  statistics_ = {};
  statistics_.tracks_in = static_cast<int>(frame.observations.size());
  statistics_.pixel_noise_px = pixel_noise_.px();
  Stopwatch stopwatch;
  ALIDADE_RETURN_IF_ERROR(PropagateTo(frame.stamp_ns + SecondsToNs(state_.calibration().time_offset_s)));
  frame_stamp_ns_ = state_.stamp_ns();
  if (frame.repeated) {
    statistics_.propagate_ms = stopwatch.ElapsedMs();
    return EndFrame(frame.stamp_ns, true);
  }
  ++serial_;
  state_.AddClone(serial_, TurnAround(imu_.samples(), state_.stamp_ns(), read_out_span_s_));
  statistics_.propagate_ms = stopwatch.ElapsedMs();
  stopwatch.Restart();
  statistics_.observations_invalid =
      tracks_.AddFrame(state_.calibration().camera, pixel_noise_, serial_, frame.observations);
  bool finite = true;
  if (config_.vision.rest_updates) {
    finite = UpdateAtRest(frame);
  }
  if (config_.filter.update_iterations > 1 || config_.filter.max_direction_deviation > 0 ||
      config_.filter.clone_policy == ClonePolicy::kSpread ||
      config_.filter.update_precision == UpdatePrecision::kSingle) {
    baseline_ = MeasureBaseline(state_);
  }
  const int leaving =
      ChooseLeavingClone(config_.filter, state_.clones(), tracks_.tracks(), serial_, ShapeIsKnown());
  const int leaving_serial = leaving >= 0 ? state_.clones()[static_cast<size_t>(leaving)].serial : -1;
  finite = finite && UpdateWithDueTracks(leaving_serial);
  pixel_noise_.EndFrame(frame_stamp_ns_, statistics_.suspect);
  gate_noise_.EndFrame(frame_stamp_ns_);
  SlamFeatures::RemoveEnded(serial_, &tracks_, &state_);
  tracks_.RemoveEnded(serial_);
  if (leaving >= 0) {
    slam_.Promote(serial_, &tracks_, &state_);
    LeaveMemories(static_cast<size_t>(leaving));
    tracks_.RemoveClone(leaving_serial);
    state_.RemoveClone(static_cast<size_t>(leaving));
  }
  statistics_.update_ms = stopwatch.ElapsedMs();
  return EndFrame(frame.stamp_ns, finite);
}

Status FilterEstimator::EndFrame(TimeNs stamp_ns, bool finite) {
  if (!finite || !state_.AllFinite()) {
    initialized_ = false;
    return Status::Diverged("filter: state is not finite after the frame at " + FormatSeconds(stamp_ns) +
                            " s");
  }
  if (observer_ != nullptr) {
    observer_->OnFrame(state_);
  }
  return Status::Ok();
}

bool FilterEstimator::IsDue(const Track& track, int leaving_serial) const {
  const FilterConfig& filter = config_.filter;
  const int views = static_cast<int>(track.views.size());
  const bool first_window = serial_ - first_serial_ < filter.window;
  if (track.memory.active) {
    return track.last_serial == serial_;
  }
  if (views < filter.min_observations) {
    // Leftovers of a track that ends: any two rows per view beyond the landmark's three still inform.
    const bool ends = track.last_serial != serial_;
    return ends && filter.flush_lost_tracks && filter.update == UpdateTiming::kImmediate && views >= 3;
  }
  if (due_ == DueTracks::kAll) {
    return first_window || views >= kLeastShareOfWindow * filter.window;
  }
  switch (filter.update) {
    case UpdateTiming::kImmediate:
    case UpdateTiming::kAtL:
      return true;
    case UpdateTiming::kDelayedAll:
      break;
  }
  // An uncertain start drifts far in a window's time: the first tracks must not wait for it to fill.
  if (filter.track_memory != TrackMemoryPolicy::kNone && first_window && due_ != DueTracks::kLeaving) {
    return true;
  }
  // One that was lost while most tracks still wait is dropped: alone, it would be taken for parallax.
  const bool lost = track.last_serial != serial_ && due_ != DueTracks::kLeaving;
  return lost || track.views.front().serial == leaving_serial;
}

bool FilterEstimator::UpdateAtRest(const TrackFrame& frame) {
  const NavEstimate estimate = state_.Estimate();
  const Pose& T_BC = state_.calibration().T_BC;
  // From a velocity that is all error, still scenery looks far, and ever farther.
  update_.LearnSceneDepth(rest_.TellsMotion(estimate, T_BC.translation));
  const RestVerdict rest = rest_.AddFrame(frame, pixel_noise_.px(), estimate, T_BC);
  statistics_.at_rest = rest.no_translation;
  if (!rest.no_translation) {
    return true;
  }
  Vector6d residual;
  RestModel::Jacobian jacobian;
  MakeRestMeasurement(rest, update_.scene_depth().Metres(), rest_.Rates(), T_BC.translation, config_.vision)
      .Evaluate(state_.nav(), state_.bias(), &residual, &jacobian);
  const int rows = rest.no_rotation ? RestModel::kRows : 3;
  rest_rows_.setZero(rows, state_.covariance().dimension());
  rest_rows_.middleCols<15>(state_.CoreOffset()) =
      (jacobian * ImuChartJacobian(state_.convention(), state_.nav())).topRows(rows);
  rest_innovation_ = -residual.head(rows);
  if (observer_ != nullptr) {
    observer_->OnUpdate(state_, {rest_rows_, rest_innovation_, {}, RowSource::kRest});
  }
  const PreparedRows prepared = state_.covariance().Prepare(rest_rows_, rest_innovation_);
  if (!state_.covariance().Apply(prepared, Correction(), nullptr)) {
    return false;
  }
  Correct();
  return true;
}

void FilterEstimator::Correct() {
  for (Track& track : tracks_.tracks()) {
    if (track.memory.active) {
      update_.keeper().Correct(state_, Correction(), &track.memory);
    }
  }
  if (gnss_.aligned()) {
    gnss_.Correct(Correction(), state_);
  }
  state_.Correct(Correction());
  tracks_.Renormalize(state_.layout(), state_.calibration().camera, pixel_noise_.px());
}

void FilterEstimator::LeaveMemories(size_t leaving) {
  if (config_.filter.track_memory == TrackMemoryPolicy::kNone) {
    return;
  }
  const bool carry = config_.filter.track_memory == TrackMemoryPolicy::kCarry;
  const int leaving_serial = state_.clones()[leaving].serial;
  const Eigen::Index columns = 6 * state_.clones()[leaving].slot;
  const Eigen::Vector3d& camera = state_.clones().back().T_WC.translation;
  left_.clear();
  for (Track& track : tracks_.tracks()) {
    TrackMemory& memory = track.memory;
    if (memory.active &&
        (memory.anchor == leaving_serial || !memory.clone_rows.middleCols<6>(columns).isZero(0))) {
      left_.push_back(&memory);
    }
  }
  if (carry && !left_.empty()) {
    ConditionClone(state_, leaving, left_.size(), &conditional_);
  }
  for (TrackMemory* memory : left_) {
    if (carry) {
      update_.keeper().Carry(state_, conditional_, memory);
    }
    memory->active = carry && update_.keeper().MayStay(*memory, camera);
  }
}

}  // namespace alidade
