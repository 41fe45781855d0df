#include "eval/bag/frozen_images.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/format.h"
#include "eval/bag/dataset_images.h"
#include "eval/dataset/log_tables.h"
#include "eval/dataset/quiet_seconds.h"

namespace alidade {
namespace {

/// Whether the IMU is at rest in the span of camera time, but for the hand that starts and ends a recording.
bool IsAtRest(const Dataset& dataset, TimeSpan span) {
  constexpr std::size_t kLeastOfTen = 9;
  const TimeNs offset_ns = SecondsToNs(dataset.rig.camera_time_offset_s);
  QuietSeconds quiet;
  // A file that cannot be read again is reported by its next reader.
  static_cast<void>(TablesOf(dataset).imu.ForEach([&](const ImuSample& sample) {
    const TimeNs camera_ns = sample.stamp_ns - offset_ns;
    if (span.first_ns <= camera_ns && camera_ns <= span.last_ns) {
      quiet.Add(sample);
    }
  }));
  return quiet.judged() > 0 && 10 * quiet.count() >= kLeastOfTen * quiet.judged();
}

}  // namespace

void CheckFrozenImages(const Dataset& dataset, Findings* findings) {
  constexpr std::size_t kSample = 8;
  constexpr std::size_t kLeast = 3;
  const std::size_t count = std::min(kSample, dataset.images.size());
  if (count < kLeast || !TablesOf(dataset).frames.empty()) {
    return;
  }
  DatasetImages images;
  std::optional<GreyImage> first;
  std::size_t equal = 0;
  TimeSpan span;
  for (std::size_t i = 0; i < count; ++i) {
    const ImageEntry& entry = dataset.images[i * (dataset.images.size() - 1) / (count - 1)];
    Result<GreyImage> image = images.Read(entry);
    if (!image.ok()) {
      continue;  // named by whoever reads all of them
    }
    if (!first) {
      first = std::move(*image);
      span.first_ns = entry.stamp_ns;
    } else if (image->pixels != first->pixels) {
      return;
    }
    span.last_ns = entry.stamp_ns;
    ++equal;
  }
  if (equal < kLeast) {
    return;
  }
  const std::string text = Format(
      "cam0: %zu images, sampled evenly from %zu, are equal to the pixel, expected at least noise: a "
      "camera that is frozen or covered",
      equal, dataset.images.size());
  if (IsAtRest(dataset, span)) {
    findings->Warning(text + ", or images without noise of a recording at rest?");
  } else {
    ReportUseless(dataset, text + "?", findings);
  }
}

}  // namespace alidade
