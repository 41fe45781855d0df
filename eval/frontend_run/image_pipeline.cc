#include "eval/frontend_run/image_pipeline.h"

#include "core/cpu_time.h"
#include "core/format.h"
#include "core/stopwatch.h"
#include "eval/bag/dataset_images.h"
#include "frontend/tracking/image_reader.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {
namespace {

/// Counts them, and ends the tracking when there are too many.
class UnreadableImages {
 public:
  explicit UnreadableImages(size_t images) : images_(images) {}

  Status Add(const std::string& sequence, const Status& fault) {
    if (count_++ == 0) {
      first_ = fault.message();
    }
    const double share = static_cast<double>(count_) / static_cast<double>(images_);
    return share <= kMaxUnreadableShare
               ? Status::Ok()
               : Status::Input(sequence +
                               Format(": %zu of %zu images cannot be used, expected at most %.0f %%; "
                                      "the first: ",
                                      count_, images_, 100 * kMaxUnreadableShare) +
                               first_);
  }

  void Tell(const std::string& sequence, const std::function<void(const std::string&)>& remark) const {
    if (count_ > 0) {
      remark(sequence + Format(": %zu of %zu images skipped, the first: ", count_, images_) + first_);
    }
  }

 private:
  size_t images_;
  size_t count_ = 0;
  std::string first_;
};

}  // namespace

Result<std::vector<TrackFrame>> TrackImages(const Dataset& dataset, const std::vector<TimeNs>& stamps,
                                            const ImageSource& image_of, const FrontendConfig& config,
                                            const PipelineOptions& options) {
  KltTracker tracker(config, dataset.rig);
  std::vector<TrackFrame> frames;
  frames.reserve(stamps.size());
  size_t next_imu = 0;
  size_t next_image = 0;
  for (const TimeNs stamp_ns : stamps) {
    if (options.stop != nullptr && options.stop->load()) {
      return Status::Diverged("interrupted");
    }
    const TimeNs imu_stamp = stamp_ns + SecondsToNs(dataset.rig.camera_time_offset_s);
    while (next_imu < dataset.imu.size() &&
           (next_imu == 0 || dataset.imu[next_imu - 1].stamp_ns < imu_stamp)) {
      tracker.AddImu(dataset.imu[next_imu++]);
    }
    const Result<GreyImage> grey = image_of(next_image++);
    if (!grey.ok()) {
      ALIDADE_RETURN_IF_ERROR(options.unreadable ? options.unreadable(grey.status()) : grey.status());
      continue;
    }
    const double cpu_start_s = ThreadCpuSeconds();
    Result<TrackFrame> frame = tracker.Track(stamp_ns, grey->pixels.data(), grey->width_px, grey->height_px);
    ALIDADE_RETURN_IF_ERROR(frame.status());
    if (options.cpu_ms != nullptr) {
      options.cpu_ms->push_back(1e3 * (ThreadCpuSeconds() - cpu_start_s));
    }
    frames.push_back(std::move(*frame));
    if (options.statistics != nullptr) {
      options.statistics->push_back(tracker.statistics());
    }
    if (options.progress) {
      options.progress(next_image, stamps.size());
    }
  }
  return frames;
}

Result<std::vector<TrackFrame>> TrackImages(const Dataset& dataset, const FrontendConfig& config,
                                            const PipelineOptions& options) {
  if (dataset.images.empty()) {
    return Status::Input(dataset.path + ": found no images, expected mav0/cam0/data.csv and its image files");
  }
  std::vector<TimeNs> stamps;
  for (const ImageEntry& image : dataset.images) {
    stamps.push_back(image.stamp_ns);
  }
  DatasetImages images;
  std::vector<double> decode_ms;
  const auto image_of = [&](size_t i) -> Result<GreyImage> {
    const Stopwatch stopwatch;
    Result<GreyImage> grey = images.ReadFor(dataset.rig.camera, dataset.images[i]);
    if (grey.ok()) {
      decode_ms.push_back(stopwatch.ElapsedMs());
    }
    return grey;
  };
  UnreadableImages unreadable(dataset.images.size());
  PipelineOptions skipping = options;
  skipping.unreadable = [&](const Status& fault) { return unreadable.Add(dataset.path, fault); };
  Result<std::vector<TrackFrame>> frames = TrackImages(dataset, stamps, image_of, config, skipping);
  if (options.remark) {
    unreadable.Tell(dataset.path, options.remark);
  }
  for (size_t i = 0; frames.ok() && i < frames->size(); ++i) {
    (*frames)[i].frontend_ms += decode_ms[i];
  }
  return frames;
}

Result<MeasurementLog> MakeLog(const Dataset& dataset, const FrontendConfig& config,
                               const PipelineOptions& options) {
  MeasurementLog log = MeasurementsOf(dataset);
  const bool no_camera = dataset.images.empty() && dataset.camera_stamps.empty();
  if (!log.frames.empty() || (log.gnss != nullptr && no_camera)) {
    return log;
  }
  if (dataset.images.empty()) {
    return Status::Input(dataset.path + ": found neither tracks nor images" +
                         (dataset.camera_stamps.empty() ? "" : " (camera stamps alone)") +
                         ", expected mav0/cam0/tracks.csv or mav0/cam0/data.csv");
  }
  Result<std::vector<TrackFrame>> frames = TrackImages(dataset, config, options);
  if (!frames.ok()) {
    return frames.status();
  }
  log.frames = std::move(*frames);
  return log;
}

std::string DescribeLog(const MeasurementLog& log, const std::string& digest) {
  size_t observations = 0;
  for (const TrackFrame& frame : log.frames) {
    observations += frame.observations.size();
  }
  return "measurement log " + digest + ": " + std::to_string(log.imu.size()) + " IMU samples, " +
         std::to_string(log.frames.size()) + " frames, " + std::to_string(observations) + " observations" +
         (log.gnss == nullptr ? "" : ", " + std::to_string(log.gnss->epochs.size()) + " GNSS epochs");
}

}  // namespace alidade
