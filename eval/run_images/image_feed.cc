#include "eval/run_images/image_feed.h"

#include <algorithm>
#include <utility>

namespace alidade {
namespace {

constexpr TimeNs kForgetNs = 10'000'000'000;  // a prediction over a longer silence is worth nothing
constexpr size_t kMaxWaiting = 100;           // images without IMU

}  // namespace

ImageFeed::ImageFeed(const FrontendConfig& config, const RigCalibration& rig, const Lateness& lateness,
                     Session* session)
    : width_px_(rig.camera.width_px()),
      height_px_(rig.camera.height_px()),
      offset_ns_(SecondsToNs(rig.camera_time_offset_s)),
      lateness_ns_(SecondsToNs(std::max(lateness.camera_s, lateness.imu_s))),
      session_(*session),
      tracker_(config, rig) {}

Status ImageFeed::AddImu(const ImuSample& sample) {
  const bool finite = sample.gyro.allFinite() && sample.accel.allFinite();
  Status status;
  if (finite && imu_.Add(sample) == ImuStream::Arrival::kTaken) {
    // Before the session gets the sample: a frame is then in time.
    status = TrackUntil(imu_.newest_ns() - lateness_ns_);
    while (imu_.PassOver(imu_.newest_ns() - lateness_ns_ - kForgetNs)) {
    }
  }
  session_.AddImu(sample);
  return status;
}

Status ImageFeed::AddImage(TimeNs stamp_ns, GreyImage image) {
  const auto size = static_cast<size_t>(width_px_) * static_cast<size_t>(height_px_);
  if (image.width_px != width_px_ || image.height_px != height_px_ || image.pixels.size() != size) {
    return Status::Input("image at " + FormatSeconds(stamp_ns) + " s: found " +
                         std::to_string(image.width_px) + " x " + std::to_string(image.height_px) +
                         " pixels, expected " + std::to_string(width_px_) + " x " +
                         std::to_string(height_px_));
  }
  if (stamp_ns <= last_image_ns_) {
    return Status::Input("image at " + FormatSeconds(stamp_ns) + " s came too late: the one at " +
                         FormatSeconds(last_image_ns_) + " s is tracked");
  }
  if (!images_.emplace(stamp_ns, std::move(image)).second) {
    return Status::Input("image at " + FormatSeconds(stamp_ns) + " s: there is one already");
  }
  if (images_.size() > kMaxWaiting) {
    const TimeNs oldest_ns = images_.begin()->first;
    images_.erase(images_.begin());
    return Status::Input("image at " + FormatSeconds(oldest_ns) + " s is dropped: the IMU does not reach it");
  }
  return imu_.newest_ns() == INT64_MIN ? Status::Ok() : TrackUntil(imu_.newest_ns() - lateness_ns_);
}

Status ImageFeed::Flush() {
  Status status = TrackUntil(INT64_MAX);
  session_.Flush();
  return status;
}

Status ImageFeed::TrackUntil(TimeNs imu_ns) {
  Status first;
  while (!images_.empty() && images_.begin()->first + offset_ns_ <= imu_ns) {
    const auto waiting = images_.extract(images_.begin());
    const TimeNs stamp_ns = last_image_ns_ = waiting.key();
    while (const ImuSample* sample = imu_.Deliver(stamp_ns + offset_ns_)) {
      tracker_.AddImu(*sample);
    }
    imu_.DropBefore(stamp_ns + offset_ns_);
    const GreyImage& image = waiting.mapped();
    Result<TrackFrame> frame = tracker_.Track(stamp_ns, image.pixels.data(), image.width_px, image.height_px);
    if (frame.ok()) {
      session_.AddFrame(*std::move(frame));
    } else {
      first = first.ok() ? frame.status() : first;
    }
  }
  return first;
}

}  // namespace alidade
