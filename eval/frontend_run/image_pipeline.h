#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "core/frontend_config.h"
#include "eval/dataset/log_tables.h"
#include "frontend/tracking/image_reader.h"
#include "frontend/tracking/klt_tracker.h"

namespace alidade {

struct PipelineOptions {
  const std::atomic<bool>* stop = nullptr;                               ///< polled once an image
  std::function<void(size_t images_done, size_t images)> progress = {};  ///< by one thread at a time
  int jobs = 1;  ///< threads that draw images, where they are drawn; they change no byte
  /// Called for an image that cannot be read; Ok skips its frame, an error ends the tracking. None: it ends.
  std::function<Status(const Status& fault)> unreadable = {};
  std::function<void(const std::string& text)> remark = {};  ///< called with what was skipped
  std::vector<TrackerStatistics>* statistics = nullptr;      ///< one an image, where asked for
  std::vector<double>* cpu_ms = nullptr;  ///< CPU time of the tracker an image, where asked for
};

/// The image of a frame; called in order, once a frame.
using ImageSource = std::function<Result<GreyImage>(size_t frame)>;

/// Runs the front end over images, wherever they come from, with the gyroscope of `dataset` up to each. The
/// tracks carry the wall time of tracking. Errors: those of the source; an image of the wrong size (kInput);
/// kDiverged: stopped.
Result<std::vector<TrackFrame>> TrackImages(const Dataset& dataset, const std::vector<TimeNs>& stamps,
                                            const ImageSource& image_of, const FrontendConfig& config,
                                            const PipelineOptions& options);

/// Takes the frame of each image that was read, in order; what it does with the frame is its own.
using TakeFrame = std::function<Status(TrackFrame* frame)>;

/// Runs the front end over the images of a sequence, with the gyroscope up to each image. The tracks carry
/// the wall time of decoding and tracking. An image that cannot be read or has the wrong size is skipped,
/// with a remark. Errors (kInput): no images; more than kMaxUnreadableShare of them skipped; kDiverged:
/// stopped.
Result<std::vector<TrackFrame>> TrackImages(const Dataset& dataset, const FrontendConfig& config,
                                            const PipelineOptions& options);

/// The same frame by frame. Errors also: those of `take`.
Status TrackImages(const Dataset& dataset, const FrontendConfig& config, const PipelineOptions& options,
                   const TakeFrame& take);

/// The measurement log of a sequence: its tracks as they are or, when it has images alone, those of the front
/// end. kInput: it has neither.
Result<MeasurementLog> MakeLog(const Dataset& dataset, const FrontendConfig& config,
                               const PipelineOptions& options);

/// The same of a sequence that was read into files (DatasetStorage), as its long tables; what the front end
/// makes goes into `spool_folder`. Errors also: SpoolFile's.
Result<LogTables> MakeTables(const Dataset& dataset, const FrontendConfig& config,
                             const PipelineOptions& options, const std::string& spool_folder);

/// "measurement log 3f2a...: 12000 IMU samples, 600 frames, 78421 observations".
[[nodiscard]] std::string DescribeLog(const MeasurementLog& log, const std::string& digest);
[[nodiscard]] std::string DescribeLog(const MeasurementLog& log, const LogTables& tables,
                                      const std::string& digest);

}  // namespace alidade
