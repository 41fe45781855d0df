#pragma once

#include <atomic>
#include <functional>

#include "core/estimator_config.h"
#include "eval/dataset.h"

namespace alidade {

struct PipelineOptions {
  const std::atomic<bool>* stop = nullptr;  ///< polled once an image
  std::function<void(size_t images_done, size_t images)> progress;
};

/// Runs the front end over the images of a sequence, with the gyroscope up to each image. The tracks carry
/// the wall time of decoding and tracking. Errors (kInput): no images; an image that cannot be read or has
/// the wrong size; kDiverged: stopped.
Result<std::vector<TrackFrame>> TrackImages(const Dataset& dataset, const FrontendConfig& config,
                                            const PipelineOptions& options);

/// The measurement log of a sequence: its tracks as they are or, when it has images alone, those of the front
/// end. kInput: it has neither.
Result<MeasurementLog> MakeLog(const Dataset& dataset, const FrontendConfig& config,
                               const PipelineOptions& options);

/// "measurement log 3f2a...: 12000 IMU samples, 600 frames, 78421 observations".
[[nodiscard]] std::string DescribeLog(const MeasurementLog& log, const std::string& digest);

}  // namespace alidade
