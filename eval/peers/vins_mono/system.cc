#include "eval/peers/vins_mono/system.h"

#include "core/cpu_time.h"

namespace alidade::vins_mono {
namespace {

/// Images that its two programs drop at the start: their features have no velocity.
constexpr int kDroppedAtStart = 2;

}  // namespace

System::System(const PeerSequence& sequence, const VinsSettings& settings, double rate_hz,
               std::unique_ptr<vins::Tracker> tracker)
    : sequence_(sequence),
      solver_(sequence.dataset.rig, settings),
      tracker_(std::move(tracker)),
      rate_(rate_hz) {
  run_.trajectory.has_velocity = run_.trajectory.has_bias = true;
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
  if (!*taken || handed_over_++ < kDroppedAtStart) {
    return Status::Ok();
  }
  const double before = ProcessCpuSeconds();
  imu_.DeliverUntil(time_s + solver_.time_offset_s(),
                    [this](double step_s, const ImuDelivery::Sample& sample) {
                      solver_.AddImu(step_s, sample.gyro, sample.accel);
                    });
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
  sink.imu = [this](const ImuSample& sample) {
    imu_.Add({TimeOf(sample.stamp_ns), sample.gyro, sample.accel});
  };
  sink.time_offset_s = [this] { return solver_.time_offset_s(); };
  sink.frame = [this](size_t frame) { return FeedFrame(frame); };
  ALIDADE_RETURN_IF_ERROR(FeedPeer(sequence_, sink));
  return run_;
}

}  // namespace alidade::vins_mono
