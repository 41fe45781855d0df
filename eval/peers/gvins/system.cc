#include "eval/peers/gvins/system.h"

#include "core/cpu_time.h"

namespace alidade::gvins {
namespace {

/// Images that its tracker does not hand over at the start: their features have no velocity.
constexpr int kDroppedAtStart = 1;

}  // namespace

System::System(const PeerSequence& sequence, const PeerGnss& gnss, const SystemSettings& settings,
               std::unique_ptr<vins::Tracker> tracker)
    : sequence_(sequence),
      gnss_(gnss),
      solver_(sequence.dataset.rig, settings.solver, settings.gnss, gnss),
      tracker_(std::move(tracker)),
      rate_(settings.rate_hz),
      pairing_(settings.gnss.enabled),
      world_(sequence.dataset.rig.gnss.anchor_E) {
  run_.trajectory.has_velocity = run_.trajectory.has_bias = true;
  if (!gnss.epochs.empty()) {
    solver_.SetClock(Solver::GpstOf(gnss.epochs.front()), TimeOf(gnss.epochs.front().stamp_ns));
  }
}

double System::TimeOf(TimeNs stamp_ns) const {
  return SecondsBetween(sequence_.dataset.imu.front().stamp_ns, stamp_ns);
}

Result<std::vector<VinsFeature>> System::FeaturesOf(size_t frame, double time_s, bool hand_over) {
  if (tracker_ == nullptr) {
    return given_.Take(sequence_.dataset.rig.camera, sequence_.dataset.frames[frame], time_s);
  }
  const Result<GreyImage> image =
      images_.ReadFor(sequence_.dataset.rig.camera, sequence_.dataset.images[frame]);
  ALIDADE_RETURN_IF_ERROR(image.status());
  const double before = ProcessCpuSeconds();
  std::vector<VinsFeature> features = tracker_->Track(*image, time_s, hand_over);
  times_.frontend_ms += 1e3 * (ProcessCpuSeconds() - before);
  return features;
}

Status System::FeedFrame(size_t frame) {
  const double time_s = TimeOf(sequence_.frames_ns[frame]);
  const std::optional<bool> taken = rate_.Take(time_s);
  if (!taken) {
    return Status::Ok();
  }
  const Result<std::vector<VinsFeature>> features = FeaturesOf(frame, time_s, *taken);
  ALIDADE_RETURN_IF_ERROR(features.status());
  if (*taken && handed_over_++ >= kDroppedAtStart && pairing_.AddFrame(time_s, frame)) {
    features_[frame] = *features;
  }
  SolveWhatCan();
  return Status::Ok();
}

void System::SolveWhatCan() {
  while (const std::optional<GvinsPairing::Pair> pair = pairing_.Next()) {
    Solve(*pair);
  }
}

void System::Solve(const GvinsPairing::Pair& pair) {
  const double time_s = TimeOf(sequence_.frames_ns[pair.frame]);
  const double before = ProcessCpuSeconds();
  imu_.DeliverUntil(time_s + solver_.time_offset_s(),
                    [this](double step_s, const ImuDelivery::Sample& sample) {
                      solver_.AddImu(step_s, sample.gyro, sample.accel);
                    });
  if (pair.epoch) {
    solver_.AddEpoch(gnss_.epochs[*pair.epoch]);
  }
  solver_.AddImage(features_.at(pair.frame), time_s);
  times_.backend_ms += 1e3 * (ProcessCpuSeconds() - before);
  features_.erase(pair.frame);
  Record(pair.frame);
}

void System::Record(size_t frame) {
  if (solver_.running() && !was_running_) {
    ++starts_;
    world_.Restart();
  }
  was_running_ = solver_.running();
  if (was_running_) {
    TrajectoryPoint point = solver_.Newest();
    point.stamp_ns = sequence_.frames_ns[frame] + SecondsToNs(solver_.time_offset_s());
    world_.Add(point, solver_.T_EW());
    run_.times.push_back(times_);
  }
  times_ = {};
}

Result<PeerRun> System::Run() {
  std::vector<TimeNs> epochs_ns;
  for (const PeerGnss::Epoch& epoch : gnss_.epochs) {
    epochs_ns.push_back(epoch.stamp_ns);
  }
  PeerSink sink;
  sink.imu = [this](const ImuSample& sample) {
    imu_.Add({TimeOf(sample.stamp_ns), sample.gyro, sample.accel});
  };
  sink.time_offset_s = [this] { return solver_.time_offset_s(); };
  sink.frame = [this](size_t frame) { return FeedFrame(frame); };
  sink.epoch = [this](size_t epoch) {
    pairing_.AddEpoch(TimeOf(gnss_.epochs[epoch].stamp_ns), epoch);
    SolveWhatCan();
  };
  ALIDADE_RETURN_IF_ERROR(FeedPeer(sequence_, sink, epochs_ns));
  run_.trajectory.points = world_.points();
  return run_;
}

}  // namespace alidade::gvins
