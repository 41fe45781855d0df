#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/format.h"
#include "eval/dataset/dataset_camera.h"
#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/log_tables.h"
#include "eval/dataset/sensor_table.h"

namespace alidade {
namespace {

/// Whether tracks of this largest coordinate are x/z, y/z instead of pixels: 3 is 72 deg off the axis, beyond
/// which no plane is used.
bool AreNormalized(size_t observations, double largest, const CameraModel& camera) {
  constexpr size_t kLeastObservations = 20;
  constexpr double kLargestOnPlane = 3;
  constexpr int kLeastWidthPx = 100;
  return observations >= kLeastObservations && largest <= kLargestOnPlane &&
         camera.width_px() >= kLeastWidthPx;
}

/// `longest`: observations of the longest track.
void CheckLives(const Dataset& dataset, size_t frames, int longest, Findings* findings) {
  constexpr size_t kLeastFrames = 3;  // of fewer no track can have three observations
  if (frames < kLeastFrames || longest >= 3) {
    return;
  }
  if (longest == 1) {
    ReportUseless(
        dataset,
        Format("cam0: no track lasts: in %zu frames every track_id occurs once, expected the same id in "
               "following frames: are the ids numbered anew in each?",
               frames),
        findings);
  } else if (longest == 0) {
    ReportUseless(dataset, Format("cam0: no observation in %zu frames, expected tracks", frames), findings);
  } else {
    findings->Warning(
        Format("cam0: no track of the %zu frames has more than %d observations, expected three or more",
               frames, longest));
  }
}

/// `outside`: how many of the observations are not in the image; `largest`: of all coordinates.
void CheckCoordinates(const CameraModel& camera, size_t observations, size_t outside, double largest,
                      Findings* findings) {
  if (AreNormalized(observations, largest, camera)) {
    findings->Error(
        Format("cam0: all coordinates of the tracks are within +-%.2f, the image has %d x %d px: they seem "
               "to be normalised (x/z, y/z); expected raw pixels",
               largest, camera.width_px(), camera.height_px()));
  } else if (outside > 0) {
    const std::string text = Format("cam0: %zu observations are outside %d x %d px", outside,
                                    camera.width_px(), camera.height_px());
    // A few per mille sit on the border; more means the resolution is not that of the tracks.
    if (outside * 20 > observations) {
      findings->Error(text + ": wrong resolution?");
    } else {
      findings->Warning(text);
    }
  }
}

void CheckTracks(const Dataset& dataset, Findings* findings) {
  struct Life {
    size_t last_frame = 0;
    int observations = 0;
  };
  std::map<std::int64_t, Life> lives;
  size_t frames = 0;
  size_t total = 0;
  size_t outside = 0;
  size_t returned = 0;
  double largest = 0;
  static_cast<void>(TablesOf(dataset).frames.ForEach([&](const TrackFrame& frame) {
    const size_t i = frames++;
    for (const TrackObservation& observation : frame.observations) {
      Life& life = lives[observation.track_id];
      returned += life.observations > 0 && life.last_frame + 1 < i ? 1 : 0;
      life = {i, life.observations + 1};
      outside += dataset.rig.camera.InImage(observation.pixel) ? 0 : 1;
      largest = std::max(largest, observation.pixel.cwiseAbs().maxCoeff());
      ++total;
    }
  }));
  size_t useful = 0;
  int longest = 0;
  for (const auto& [id, life] : lives) {
    useful += life.observations >= 3 ? 1 : 0;
    longest = std::max(longest, life.observations);
  }
  findings->Fact(
      Format("cam0: %zu observations of %zu tracks, %.1f a frame, mean length %.2f; %zu tracks of 3 or more",
             total, lives.size(), static_cast<double>(total) / static_cast<double>(frames),
             static_cast<double>(total) / static_cast<double>(std::max<size_t>(1, lives.size())), useful));
  CheckLives(dataset, frames, longest, findings);
  CheckCoordinates(dataset.rig.camera, total, outside, largest, findings);
  if (returned > 0) {
    findings->Warning(
        Format("cam0: %zu times a track is missing in some frames and reappears with the same id", returned));
  }
}

std::vector<TimeNs> CameraStamps(const Dataset& dataset) {
  if (!dataset.camera_stamps.empty()) {
    return dataset.camera_stamps;
  }
  std::vector<TimeNs> stamps;
  // A file that cannot be read again is reported by its next reader.
  static_cast<void>(TablesOf(dataset).frames.ForEach(
      [&stamps](const TrackFrame& frame) { stamps.push_back(frame.stamp_ns); }));
  if (stamps.empty()) {
    for (const ImageEntry& image : dataset.images) {
      stamps.push_back(image.stamp_ns);
    }
  }
  return stamps;
}

/// Rate and span, also against the IMU's.
void CheckTimes(const std::vector<TimeNs>& stamps, const Dataset& dataset, Findings* findings) {
  constexpr double kJitter = 1.1;
  std::optional<double> rate_hz = 0;
  if (stamps.size() == 1) {
    ReportUseless(
        dataset,
        "cam0: a single frame, expected at least two: a track begins in one and is seen again in another",
        findings);
  } else {
    rate_hz = CheckStamps("cam0", stamps, dataset.camera_rate_hz, kCameraRates, findings);
  }
  const TimeNs offset_ns = SecondsToNs(dataset.rig.camera_time_offset_s);
  const TimeNs first_ns = stamps.front() + offset_ns;
  const TimeNs last_ns = stamps.back() + offset_ns;
  // In this order: a span that reveals the unit explains the rate.
  if (!rate_hz || !CheckSpan("cam0", first_ns, last_ns, dataset, findings)) {
    return;
  }
  CheckTimeWithoutImu("cam0", first_ns, last_ns, stamps.size(), dataset, findings);
  CheckRate("cam0", *rate_hz, kCameraRates, findings);
  const Table<ImuSample> imu = TablesOf(dataset).imu;
  const double imu_rate_hz = MeasuredRate(imu.front().stamp_ns, imu.back().stamp_ns, imu.size());
  if (*rate_hz > kJitter * imu_rate_hz) {
    findings->Warning(
        Format("cam0: %.4g Hz, expected no more than imu0's %.4g Hz: there are frames without a "
               "sample of the IMU between them",
               *rate_hz, imu_rate_hz));
  }
}

}  // namespace

void CheckCamera(const Dataset& dataset, Findings* findings) {
  const std::vector<TimeNs> stamps = CameraStamps(dataset);
  if (stamps.empty()) {
    findings->Warning(dataset.gnss == nullptr ? "cam0: none; estimators need a camera or GNSS"
                                              : "cam0: none; only GNSS and IMU");
  } else {
    CheckTimes(stamps, dataset, findings);
  }
  if (dataset.rig.line_delay_s != 0) {
    findings->Fact(Format("cam0: rolling shutter: the rows of an image are exposed over %.1f ms",
                          1e3 * std::abs(dataset.rig.line_delay_s) * dataset.rig.camera.height_px()));
  }
  if (!TablesOf(dataset).frames.empty()) {
    CheckTracks(dataset, findings);
  } else if (!dataset.images.empty()) {
    findings->Fact(Format("cam0: %zu images, no tracks: the front end runs on them", dataset.images.size()));
  } else if (!stamps.empty()) {
    findings->Warning("cam0: only stamps, neither images nor tracks");
  }
}

void CheckExtraCameras(const Dataset& dataset, Findings* findings) {
  if (!dataset.extra_cameras.empty()) {
    findings->Fact(Format("%zu more cameras with tracks: recorded, but estimators read only cam0",
                          dataset.extra_cameras.size()));
  }
}

}  // namespace alidade
