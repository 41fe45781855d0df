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

  void Report(const std::string& sequence, const std::function<void(const std::string&)>& remark) const {
    if (count_ > 0) {
      remark(sequence + Format(": %zu of %zu images skipped, the first: ", count_, images_) + first_);
    }
  }

 private:
  size_t images_;
  size_t count_ = 0;
  std::string first_;
};

Status Track(const Dataset& dataset, const std::vector<TimeNs>& stamps, const ImageSource& image_of,
             const FrontendConfig& config, const PipelineOptions& options, const TakeFrame& take) {
  KltTracker tracker(config, dataset.rig);
  const LogTables tables = TablesOf(dataset);
  Table<ImuSample>::Pass imu(tables.imu);
  TimeNs last_imu_ns = INT64_MIN;
  size_t next_image = 0;
  for (const TimeNs stamp_ns : stamps) {
    if (options.stop != nullptr && options.stop->load()) {
      return Status::Diverged("interrupted");
    }
    const TimeNs imu_stamp = stamp_ns + SecondsToNs(dataset.rig.camera_time_offset_s);
    while (last_imu_ns < imu_stamp) {
      const Result<const ImuSample*> sample = imu.Next();
      ALIDADE_RETURN_IF_ERROR(sample.status());
      if (*sample == nullptr) {
        break;
      }
      last_imu_ns = (*sample)->stamp_ns;
      tracker.AddImu(**sample);
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
    ALIDADE_RETURN_IF_ERROR(take(&frame.value()));
    if (options.statistics != nullptr) {
      options.statistics->push_back(tracker.statistics());
    }
    if (options.progress) {
      options.progress(next_image, stamps.size());
    }
  }
  return Status::Ok();
}

/// Keeps the frames.
TakeFrame Into(std::vector<TrackFrame>* frames) {
  return [frames](TrackFrame* frame) {
    frames->push_back(std::move(*frame));
    return Status::Ok();
  };
}

Status HasNoInput(const Dataset& dataset) {
  return Status::Input(dataset.path + ": found neither tracks nor images" +
                       (dataset.camera_stamps.empty() ? "" : " (camera stamps alone)") +
                       ", expected mav0/cam0/tracks.csv or mav0/cam0/data.csv");
}

/// Whether the measurements are all there without the front end.
bool IsComplete(const Dataset& dataset) {
  const bool no_camera = dataset.images.empty() && dataset.camera_stamps.empty();
  return !TablesOf(dataset).frames.empty() || (dataset.gnss != nullptr && no_camera);
}

}  // namespace

Result<std::vector<TrackFrame>> TrackImages(const Dataset& dataset, const std::vector<TimeNs>& stamps,
                                            const ImageSource& image_of, const FrontendConfig& config,
                                            const PipelineOptions& options) {
  std::vector<TrackFrame> frames;
  frames.reserve(stamps.size());
  ALIDADE_RETURN_IF_ERROR(Track(dataset, stamps, image_of, config, options, Into(&frames)));
  return frames;
}

Status TrackImages(const Dataset& dataset, const FrontendConfig& config, const PipelineOptions& options,
                   const TakeFrame& take) {
  if (dataset.images.empty()) {
    return Status::Input(dataset.path + ": found no images, expected mav0/cam0/data.csv and its image files");
  }
  std::vector<TimeNs> stamps;
  for (const ImageEntry& image : dataset.images) {
    stamps.push_back(image.stamp_ns);
  }
  DatasetImages images;
  double decode_ms = 0;
  const auto image_of = [&](size_t i) -> Result<GreyImage> {
    const Stopwatch stopwatch;
    Result<GreyImage> grey = images.ReadFor(dataset.rig.camera, dataset.images[i]);
    decode_ms = stopwatch.ElapsedMs();
    return grey;
  };
  UnreadableImages unreadable(dataset.images.size());
  PipelineOptions skipping = options;
  skipping.unreadable = [&](const Status& fault) { return unreadable.Add(dataset.path, fault); };
  Status status = Track(dataset, stamps, image_of, config, skipping, [&](TrackFrame* frame) {
    frame->frontend_ms += decode_ms;
    return take(frame);
  });
  if (options.remark) {
    unreadable.Report(dataset.path, options.remark);
  }
  return status;
}

Result<std::vector<TrackFrame>> TrackImages(const Dataset& dataset, const FrontendConfig& config,
                                            const PipelineOptions& options) {
  std::vector<TrackFrame> frames;
  ALIDADE_RETURN_IF_ERROR(TrackImages(dataset, config, options, Into(&frames)));
  return frames;
}

Result<MeasurementLog> MakeLog(const Dataset& dataset, const FrontendConfig& config,
                               const PipelineOptions& options) {
  MeasurementLog log = MeasurementsOf(dataset);
  if (IsComplete(dataset)) {
    return log;
  }
  if (dataset.images.empty()) {
    return HasNoInput(dataset);
  }
  Result<std::vector<TrackFrame>> frames = TrackImages(dataset, config, options);
  if (!frames.ok()) {
    return frames.status();
  }
  log.frames = std::move(*frames);
  return log;
}

Result<LogTables> MakeTables(const Dataset& dataset, const FrontendConfig& config,
                             const PipelineOptions& options, const std::string& spool_folder) {
  LogTables tables = TablesOf(dataset);
  if (IsComplete(dataset)) {
    return tables;
  }
  if (dataset.images.empty()) {
    return HasNoInput(dataset);
  }
  tables.frames = Table<TrackFrame>::InFile(spool_folder);
  ALIDADE_RETURN_IF_ERROR(TrackImages(dataset, config, options,
                                      [&tables](TrackFrame* frame) { return tables.frames.Add(*frame); }));
  return tables;
}

std::string DescribeLog(const MeasurementLog& log, const std::string& digest) {
  return DescribeLog(log, TablesOf(log), digest);
}

std::string DescribeLog(const MeasurementLog& log, const LogTables& tables, const std::string& digest) {
  size_t observations = 0;
  // A file that cannot be read again is reported by its next reader.
  static_cast<void>(tables.frames.ForEach(
      [&observations](const TrackFrame& frame) { observations += frame.observations.size(); }));
  return "measurement log " + digest + ": " + std::to_string(tables.imu.size()) + " IMU samples, " +
         std::to_string(tables.frames.size()) + " frames, " + std::to_string(observations) + " observations" +
         (log.gnss == nullptr ? "" : ", " + std::to_string(log.gnss->epochs.size()) + " GNSS epochs");
}

}  // namespace alidade
