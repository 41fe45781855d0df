#include "filter/filter_estimator.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <string>

#include "core/rest_model.h"
#include "core/stopwatch.h"

namespace alidade {
namespace {

using Eigen::Index;

// Fewer refusals are a matter of tracks, whatever their share.
constexpr int kMinRefusedForConsensus = 8;
// A remembered track that is refused more often in a row is taken for another point.
constexpr int kMaxRefusals = 1;

}  // namespace

FilterEstimator::FilterEstimator(const EstimatorConfig& config, const RigCalibration& rig)
    : config_(config),
      rig_(rig),
      noise_(config.imu.Scaled(rig.imu_noise)),
      gravity_W_(GravityInWorld(config.imu.gravity_mps2)),
      gate_(config.vision.gate_probability),
      state_(config.filter.error, config.filter.first_estimates, rig.T_BC,
             {config.filter.window + 1, config.filter.slam_features, config.gnss.enabled}),
      update_(config.filter, config.vision, config.filter.window + 1),
      slam_(config.filter, config.filter.window + 1),
      tracks_(config.filter.window + 1, config.filter.track_memory != TrackMemoryPolicy::kNone),
      gnss_(config.gnss, rig.gnss),
      rest_(config.vision, config.init, rig.camera),
      imu_(config.imu.max_gap_s),
      correction_(state_.covariance().capacity()) {}

Status FilterEstimator::Initialize(const NavEstimate& initial) {
  ALIDADE_RETURN_IF_ERROR(state_.Reset(initial));
  tracks_.Clear();
  gnss_.Reset();
  rest_.Clear();
  imu_.DropBefore(initial.stamp_ns);
  frame_stamp_ns_ = INT64_MIN;
  statistics_ = {};
  initialized_ = true;
  first_serial_ = serial_ + 1;
  return Status::Ok();
}

void FilterEstimator::SetObserver(FilterObserver* observer) {
  observer_ = observer;
  state_.SetObserver(observer);
  update_.SetTracing(observer != nullptr);
}

Status FilterEstimator::AddImu(const ImuSample& sample) {
  return imu_.Add(sample);
}

Status FilterEstimator::PropagateTo(TimeNs stamp_ns) {
  if (stamp_ns == state_.stamp_ns() && stamp_ns > frame_stamp_ns_) {
    return Status::Ok();  // where the filter was initialised, or the stamp of an epoch
  }
  ALIDADE_RETURN_IF_ERROR(imu_.Interval(state_.stamp_ns(), stamp_ns, &interval_));
  state_.Propagate(interval_, noise_, gravity_W_);
  imu_.DropBefore(stamp_ns);
  rest_.AddImu(interval_);
  last_gyro_radps_ = interval_.back().gyro;
  return Status::Ok();
}

Status FilterEstimator::AddFrame(const TrackFrame& frame) {
  if (!initialized_) {
    return Status::Diverged("filter: not initialised");
  }
  statistics_ = {};
  statistics_.tracks_in = static_cast<int>(frame.observations.size());
  Stopwatch stopwatch;
  ALIDADE_RETURN_IF_ERROR(PropagateTo(frame.stamp_ns + SecondsToNs(rig_.camera_time_offset_s)));
  frame_stamp_ns_ = state_.stamp_ns();
  ++serial_;
  state_.AddClone(serial_);
  statistics_.propagate_ms = stopwatch.ElapsedMs();
  stopwatch.Restart();
  statistics_.observations_invalid =
      tracks_.AddFrame(rig_.camera, config_.vision.pixel_noise_px, serial_, frame.observations);
  const int leaving = ChooseLeavingClone();
  const int leaving_serial = leaving >= 0 ? state_.clones()[static_cast<size_t>(leaving)].serial : -1;
  bool finite = true;
  if (config_.vision.rest_updates) {
    const RestVerdict rest = rest_.AddFrame(frame, state_.clones().back().T_WC.rotation);
    statistics_.at_rest = rest.no_translation;
    finite = UpdateAtRest(rest);
  }
  finite = finite && UpdateWithDueTracks(leaving_serial);
  SlamFeatures::RemoveEnded(serial_, &tracks_, &state_);
  tracks_.RemoveEnded(serial_);
  if (leaving >= 0) {
    LeaveMemories(static_cast<size_t>(leaving));
    tracks_.RemoveClone(leaving_serial);
    state_.RemoveClone(static_cast<size_t>(leaving));
  }
  statistics_.update_ms = stopwatch.ElapsedMs();
  if (!finite || !state_.AllFinite()) {
    initialized_ = false;
    return Status::Diverged("filter: state is not finite after the frame at " +
                            FormatSeconds(frame.stamp_ns) + " s");
  }
  if (observer_ != nullptr) {
    observer_->OnFrame(state_);
  }
  return Status::Ok();
}

int FilterEstimator::ChooseLeavingClone() const {
  const std::vector<Clone>& clones = state_.clones();
  if (static_cast<int>(clones.size()) <= config_.filter.window) {
    return -1;
  }
  if (config_.filter.clone_policy == ClonePolicy::kOldest) {
    return 0;
  }
  if (config_.filter.clone_policy == ClonePolicy::kAlternate) {
    return serial_ % 2 == 0 ? 0 : static_cast<int>(clones.size()) - 2;
  }
  // The newest clones hold views that still wait for their first update: they are not candidates.
  const size_t candidates =
      clones.size() - static_cast<size_t>(std::min<int>(config_.filter.min_observations,
                                                        static_cast<int>(clones.size()) - 1));
  size_t best = 0;
  int best_bases = INT_MAX;
  for (size_t i = 0; i < candidates; ++i) {
    int bases = 0;
    for (const Track& track : tracks_.tracks()) {
      bases += !track.views.empty() && track.views.front().serial == clones[i].serial ? 1 : 0;
    }
    if (bases < best_bases) {
      best_bases = bases;
      best = i;
    }
  }
  return static_cast<int>(best);
}

bool FilterEstimator::IsDue(const Track& track, int leaving_serial) const {
  const FilterConfig& filter = config_.filter;
  const int views = static_cast<int>(track.views.size());
  if (track.memory.active) {
    return track.last_serial == serial_;
  }
  if (views < filter.min_observations) {
    // Leftovers of a track that ends: any two rows per view beyond the landmark's three still inform.
    const bool ends = track.last_serial != serial_;
    return ends && filter.flush_lost_tracks && filter.update == UpdateTiming::kImmediate && views >= 3;
  }
  switch (filter.update) {
    case UpdateTiming::kImmediate:
    case UpdateTiming::kAtL:
      return true;
    case UpdateTiming::kDelayedAll:
      break;
  }
  // An uncertain start drifts far in a window's time: the first tracks must not wait for it to fill.
  if (filter.track_memory != TrackMemoryPolicy::kNone && serial_ - first_serial_ < filter.window) {
    return true;
  }
  return track.last_serial != serial_ || track.views.front().serial == leaving_serial;
}

bool FilterEstimator::UpdateAtRest(const RestVerdict& rest) {
  if (!rest.no_translation) {
    return true;
  }
  Vector6d residual;
  RestModel::Jacobian jacobian;
  MakeRestMeasurement(rest, rest_.MeanGyro(), config_.vision)
      .Evaluate(state_.nav(), state_.bias(), &residual, &jacobian);
  const int rows = rest.no_rotation ? RestModel::kRows : 3;
  rest_rows_.setZero(rows, state_.covariance().dimension());
  rest_rows_.middleCols<15>(state_.CoreOffset()) =
      (jacobian * ImuChartJacobian(state_.convention(), state_.nav())).topRows(rows);
  rest_innovation_ = -residual.head(rows);
  if (observer_ != nullptr) {
    observer_->OnUpdate(state_, {rest_rows_, rest_innovation_, {}});
  }
  state_.covariance().Prepare(rest_rows_);
  if (!state_.covariance().Apply(rest_rows_, rest_innovation_, Correction(), nullptr)) {
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
  state_.Correct(Correction());
}

void FilterEstimator::LeaveMemories(size_t leaving) {
  if (config_.filter.track_memory == TrackMemoryPolicy::kNone) {
    return;
  }
  const bool carry = config_.filter.track_memory == TrackMemoryPolicy::kCarry;
  const int leaving_serial = state_.clones()[leaving].serial;
  const Eigen::Index columns = 6 * state_.clones()[leaving].slot;
  const Eigen::Vector3d& camera = state_.clones().back().T_WC.translation;
  update_.keeper().Condition(state_, leaving, &conditional_);
  for (Track& track : tracks_.tracks()) {
    TrackMemory& memory = track.memory;
    if (!memory.active) {
      continue;
    }
    if (memory.anchor != leaving_serial && memory.clone_rows.middleCols<6>(columns).isZero(0)) {
      continue;
    }
    if (carry) {
      update_.keeper().Carry(state_, conditional_, &memory);
    }
    memory.active = carry && update_.keeper().MayStay(memory, camera);
  }
}

void FilterEstimator::AppendTrack(size_t index, int leaving_serial) {
  Track& track = tracks_.tracks()[index];
  TrackOutcome outcome = TrackOutcome::kWaiting;
  if (track.in_state) {
    if (track.last_serial != serial_) {
      return;
    }
    outcome = slam_.Append(state_, track, &update_);
  } else if (slam_.IsCandidate(state_, track, serial_)) {
    outcome = update_.AppendLandmark(state_, track, slam_.TakeRows());
    if (outcome == TrackOutcome::kReady) {
      slam_.AssignBlock(update_.blocks().size() - 1);
    } else {
      slam_.ReturnRows();
    }
  }
  if (outcome != TrackOutcome::kReady && !track.in_state) {
    if (!IsDue(track, leaving_serial)) {
      return;
    }
    outcome = AppendViews(track, leaving_serial);
  }
  switch (outcome) {
    case TrackOutcome::kReady:
      appended_.push_back(index);
      break;
    case TrackOutcome::kWaiting:
      ++statistics_.features_waiting;
      break;
    case TrackOutcome::kDegenerate:
      ++statistics_.features_degenerate;
      RetireViews(&track, false);
      track.memory.active = false;
      break;
  }
}

bool FilterEstimator::UpdateWithDueTracks(int leaving_serial) {
  std::vector<Track>& tracks = tracks_.tracks();
  slam_.Begin();
  slam_.Promote(serial_, &tracks_, &state_);
  update_.Begin(state_);
  appended_.clear();
  for (size_t i = 0; i < tracks.size(); ++i) {
    if (!tracks[i].in_state) {
      AppendTrack(i, leaving_serial);
    }
  }
  const int landmark_rows = update_.rows();  // where they begin
  for (size_t i = 0; i < tracks.size(); ++i) {
    if (tracks[i].in_state) {
      AppendTrack(i, leaving_serial);
    }
  }
  if (appended_.empty()) {
    return true;
  }
  if (observer_ != nullptr) {
    observed_ = {update_.jacobian(), update_.innovation(), update_.traces()};
  }
  state_.covariance().Prepare(update_.jacobian(), landmark_rows);
  GateBlocks();
  if (observer_ != nullptr) {
    observer_->OnUpdate(state_, observed_);
  }
  if (!state_.covariance().Apply(update_.jacobian(), update_.innovation(), Correction(), &statistics_.nis,
                                 landmark_rows)) {
    return false;
  }
  for (size_t block = 0; block < appended_.size(); ++block) {
    Track& track = tracks[appended_[block]];
    if (accepted_[block]) {
      update_.Remember(state_, block, weights_[block], &track);
    } else if (track.memory.active && ++track.memory.refusals > kMaxRefusals) {
      track.memory.active = false;
    }
  }
  const auto correction = Correction();  // of the dimension before landmarks enter
  Correct();
  slam_.Enter(correction, weights_, &state_, &tracks_);
  for (size_t block = 0; block < appended_.size(); ++block) {
    RetireViews(&tracks[appended_[block]], accepted_[block]);
  }
  return true;
}

TrackOutcome FilterEstimator::AppendViews(const Track& track, int leaving_serial) {
  if (track.memory.active) {
    return update_.AppendRemembered(state_, track);
  }
  // A memory wants a good depth to start from; the last chance to use the views does not.
  const bool last_chance = track.last_serial != serial_ || track.views.front().serial == leaving_serial;
  const bool to_remember = config_.filter.track_memory != TrackMemoryPolicy::kNone && !last_chance;
  return update_.Append(state_, track, to_remember);
}

void FilterEstimator::MeasureBlocks() {
  const Eigen::Ref<const Eigen::MatrixXd> prepared = update_.jacobian();
  const Eigen::Ref<const Eigen::VectorXd> innovation = update_.innovation();
  block_nis_.clear();
  for (const FeatureUpdate::Block& block : update_.blocks()) {
    block_nis_.push_back(state_.covariance().NormalizedInnovationSquared(
        prepared.middleRows(block.first, block.rows), innovation.segment(block.first, block.rows)));
  }
}

void FilterEstimator::GateBlocks() {
  MeasureBlocks();
  accepted_.assign(appended_.size(), true);
  weights_.assign(appended_.size(), 0);
  int refused = 0;
  for (size_t i = 0; i < appended_.size(); ++i) {
    accepted_[i] = std::isfinite(block_nis_[i]) && gate_.Accepts(block_nis_[i], update_.blocks()[i].rows);
    refused += accepted_[i] ? 0 : 1;
  }
  const bool state_is_suspect =
      refused >= kMinRefusedForConsensus &&
      refused > config_.vision.max_gated_share * static_cast<double>(appended_.size());
  Eigen::Ref<Eigen::MatrixXd> prepared = update_.jacobian();
  Eigen::Ref<Eigen::VectorXd> innovation = update_.innovation();
  for (size_t i = 0; i < appended_.size(); ++i) {
    const FeatureUpdate::Block& block = update_.blocks()[i];
    double weight = 0;
    if (accepted_[i]) {
      // The kernel acts on an observation's two rows; a track's rows share one weight of the same mean
      // square.
      weight = RobustWeight(config_.vision.robust_kernel, config_.vision.robust_scale_sigma,
                            2 * block_nis_[i] / block.rows);
    } else if (state_is_suspect && std::isfinite(block_nis_[i])) {
      accepted_[i] = true;
      weight = gate_.Threshold(block.rows) / block_nis_[i];
    }
    weights_[i] = weight;
    ++(accepted_[i] ? statistics_.features_used : statistics_.features_gated);
    statistics_.nis_dof += accepted_[i] ? block.rows : 0;
    if (weight < 1) {
      prepared.middleRows(block.first, block.rows) *= std::sqrt(weight);
      innovation.segment(block.first, block.rows) *= std::sqrt(weight);
      if (observer_ != nullptr) {
        observed_.jacobian.middleRows(block.first, block.rows) *= std::sqrt(weight);
        observed_.innovation.segment(block.first, block.rows) *= std::sqrt(weight);
        for (TracedBlock& trace : observed_.blocks) {
          // A block that a memory made has no trace.
          trace.noise *= trace.first == block.first ? std::sqrt(weight) : 1.0;
        }
      }
    }
  }
}

void FilterEstimator::RetireViews(Track* track, bool used) {
  const FilterConfig& filter = config_.filter;
  if (track->in_state) {
    track->views.clear();
    SlamFeatures::Judge(used, *track, &state_);
    return;
  }
  if (!used || filter.update != UpdateTiming::kImmediate || filter.track_memory != TrackMemoryPolicy::kNone) {
    track->views.clear();
    track->base_rounds = 0;
    return;
  }
  ++track->base_rounds;
  const bool base_exhausted =
      filter.base_reuse == BaseReuse::kDisjoint ||
      (filter.base_reuse == BaseReuse::kLimit && track->base_rounds >= filter.max_base_rounds);
  if (base_exhausted) {
    track->views.clear();
    track->base_rounds = 0;
    return;
  }
  track->views.resize(1);
}

}  // namespace alidade
