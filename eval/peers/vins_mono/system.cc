#include "eval/peers/vins_mono/system.h"

#include "core/cpu_time.h"

namespace alidade::vins_mono {
namespace {

/// Images that its two programs drop at the start: their features have no velocity.
constexpr int kDroppedAtStart = 2;

}  // namespace

System::System(const PeerSequence& sequence, const SolverSettings& settings, double rate_hz,
               std::unique_ptr<Tracker> tracker)
    : sequence_(sequence),
      solver_(sequence.dataset.rig, settings),
      tracker_(std::move(tracker)),
      rate_(rate_hz) {
  run_.trajectory.has_velocity = run_.trajectory.has_bias = true;
}

double System::TimeOf(TimeNs stamp_ns) const {
  return SecondsBetween(sequence_.dataset.imu.front().stamp_ns, stamp_ns);
}

std::vector<Feature> System::GivenFeatures(const TrackFrame& frame, double time_s) {
  std::vector<Feature> features;
  std::map<std::int64_t, Seen> seen;
  for (const TrackObservation& track : frame.observations) {
    Feature feature;
    feature.id = static_cast<int>(track.track_id);
    feature.pixel = track.pixel;
    if (!sequence_.dataset.rig.camera.Unproject(track.pixel, &feature.plane)) {
      continue;
    }
    if (const auto before = seen_.find(track.track_id); before != seen_.end()) {
      feature.velocity = (feature.plane - before->second.plane) / (time_s - before->second.time_s);
      features.push_back(feature);
    }
    seen[track.track_id] = {time_s, feature.plane};
  }
  seen_ = std::move(seen);
  return features;
}

Result<std::vector<Feature>> System::FeaturesOf(size_t frame, double time_s, bool hand_over) {
  if (tracker_ == nullptr) {
    return GivenFeatures(sequence_.dataset.tracks[frame], time_s);
  }
  const Result<GreyImage> image =
      images_.ReadFor(sequence_.dataset.rig.camera, sequence_.dataset.images[frame]);
  ALIDADE_RETURN_IF_ERROR(image.status());
  const double before = ProcessCpuSeconds();
  std::vector<Feature> features = tracker_->Track(*image, time_s, hand_over);
  times_.frontend_ms += 1e3 * (ProcessCpuSeconds() - before);
  return features;
}

void System::DeliverImu(double until_s) {
  const auto deliver = [this](double time_s, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel) {
    solver_.AddImu(imu_time_s_ < 0 ? 0 : time_s - imu_time_s_, gyro, accel);
    imu_time_s_ = time_s;
    last_.gyro = gyro;
    last_.accel = accel;
  };
  size_t used = 0;
  for (; used < waiting_.size() && TimeOf(waiting_[used].stamp_ns) <= until_s; ++used) {
    deliver(TimeOf(waiting_[used].stamp_ns), waiting_[used].gyro, waiting_[used].accel);
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(used));
  if (!waiting_.empty() && imu_time_s_ >= 0 && imu_time_s_ < until_s) {
    const ImuSample& next = waiting_.front();
    const double share = (until_s - imu_time_s_) / (TimeOf(next.stamp_ns) - imu_time_s_);
    deliver(until_s, (1 - share) * last_.gyro + share * next.gyro,
            (1 - share) * last_.accel + share * next.accel);
  }
}

Status System::FeedFrame(size_t frame) {
  const double time_s = TimeOf(sequence_.frames_ns[frame]);
  const std::optional<bool> taken = rate_.Take(time_s);
  if (!taken) {
    return Status::Ok();
  }
  const Result<std::vector<Feature>> features = FeaturesOf(frame, time_s, *taken);
  ALIDADE_RETURN_IF_ERROR(features.status());
  if (!*taken || handed_over_++ < kDroppedAtStart) {
    return Status::Ok();
  }
  const double before = ProcessCpuSeconds();
  DeliverImu(time_s + solver_.time_offset_s());
  solver_.AddImage(*features, time_s);
  times_.backend_ms += 1e3 * (ProcessCpuSeconds() - before);
  Record(frame);
  return Status::Ok();
}

void System::Record(size_t frame) {
  starts_ += solver_.running() && !was_running_ ? 1 : 0;
  was_running_ = solver_.running();
  if (was_running_) {
    TrajectoryPoint point = solver_.Newest();
    point.stamp_ns = sequence_.frames_ns[frame] + SecondsToNs(solver_.time_offset_s());
    run_.trajectory.points.push_back(point);
    run_.times.push_back(times_);
  }
  times_ = {};
}

Result<PeerRun> System::Run() {
  PeerSink sink;
  sink.imu = [this](const ImuSample& sample) { waiting_.push_back(sample); };
  sink.time_offset_s = [this] { return solver_.time_offset_s(); };
  sink.frame = [this](size_t frame) { return FeedFrame(frame); };
  ALIDADE_RETURN_IF_ERROR(FeedPeer(sequence_, sink));
  return run_;
}

}  // namespace alidade::vins_mono
