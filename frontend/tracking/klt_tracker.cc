#include "frontend/tracking/klt_tracker.h"

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <numeric>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <utility>

#include "core/gyro_rotation.h"
#include "core/stopwatch.h"
#include "core/visual_observation.h"
#include "frontend/tracking/corner_grid.h"
#include "frontend/tracking/epipolar_rejection.h"
#include "frontend/tracking/feature_track.h"
#include "frontend/tracking/image_preparation.h"
#include "frontend/tracking/optical_flow.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Of a track that its template does not confirm: what noise and blur leave of a track that did not slide.
constexpr double kReturnPx = 0.7;
// A camera that repeats its image for longer: the rotation since then finds no track again.
constexpr double kMaxRepeatedS = 1;

/// Runs are parallel across sequences, never inside one: a pool of threads under each run would only fight
/// over the cores.
void ForbidThreadsInside() {
  static std::once_flag once;
  std::call_once(once, [] { cv::setNumThreads(1); });
}

/// In which no track begins: its first template would not fit. Tracks that come closer to the edge live on
/// without one as long as the window of Lucas-Kanade is inside.
int BorderPx(const FrontendConfig& config) {
  return std::max(config.window_px / 2, config.template_px > 0 ? config.template_px / 2 + 3 : 0);
}

}  // namespace

struct KltTracker::Implementation {
  Implementation(const FrontendConfig& front_end, const RigCalibration& rig_calibration)
      : config(front_end),
        rig(rig_calibration),
        flow(front_end),
        grid(front_end, rig_calibration.camera.width_px(), rig_calibration.camera.height_px(),
             BorderPx(front_end)),
        images(front_end, rig_calibration.camera.width_px(), rig_calibration.camera.height_px()) {}

  [[nodiscard]] Status CheckInput(TimeNs stamp_ns, const unsigned char* grey, int width_px,
                                  int height_px) const;
  /// R_C1C0 from the last image to this one, when the gyroscope covers the time between.
  std::optional<Matrix3d> RotationSinceLast(TimeNs stamp_ns);
  void Follow(const std::optional<Matrix3d>& R_C1C0, double dt_s);
  /// Improves pixels where Lucas-Kanade found them by the tracks' templates. A track that its template does
  /// not confirm lives on if it can be followed back; then it begins a new template. Returns which are alive.
  std::vector<bool> Confirm(const std::optional<Matrix3d>& R_C1C0, std::vector<bool> alive,
                            std::vector<cv::Point2f>* pixels);
  /// Ends those of the marked tracks that do not return to within tolerance_px of where they were in the
  /// image before.
  void RequireReturn(const std::vector<bool>& marked, const std::vector<cv::Point2f>& pixels,
                     double tolerance_px, std::vector<bool>* alive) const;
  void Spread();
  void Detect();
  /// A repeated image: all tracks stay where they are.
  void KeepAll(TimeNs stamp_ns);
  /// To the newest of `images`.
  void Advance(TimeNs stamp_ns);

  FrontendConfig config;
  RigCalibration rig;
  OpticalFlow flow;
  CornerGrid grid;
  ImagePreparation images;
  GyroRotation gyro;

  std::optional<TimeNs> last_stamp_ns;
  std::optional<TimeNs> image_ns;    // of the last image that did not repeat the one before it
  std::vector<FeatureTrack> tracks;  // sorted by id
  std::int64_t next_id = 0;
  TrackerStatistics statistics;
};

Status KltTracker::Implementation::CheckInput(TimeNs stamp_ns, const unsigned char* grey, int width_px,
                                              int height_px) const {
  const std::string frame = "image at " + std::to_string(stamp_ns) + " ns: ";
  if (grey == nullptr) {
    return Status::Input(frame + "no pixels");
  }
  if (width_px != rig.camera.width_px() || height_px != rig.camera.height_px()) {
    return Status::Input(frame + "size " + std::to_string(width_px) + " x " + std::to_string(height_px) +
                         ", expected the camera's " + std::to_string(rig.camera.width_px()) + " x " +
                         std::to_string(rig.camera.height_px()));
  }
  if (last_stamp_ns.has_value() && stamp_ns <= *last_stamp_ns) {
    return Status::Input(frame + "expected a stamp after the last image's " + std::to_string(*last_stamp_ns) +
                         " ns");
  }
  return Status::Ok();
}

std::optional<Matrix3d> KltTracker::Implementation::RotationSinceLast(TimeNs stamp_ns) {
  if (!config.imu_prediction || !image_ns.has_value()) {
    return std::nullopt;
  }
  const TimeNs offset_ns = SecondsToNs(rig.camera_time_offset_s);
  gyro.DropBefore(*image_ns + offset_ns);
  // Without a bias: 0.1 rad/s over 50 ms is 5 mrad, a good start for a search.
  const std::optional<Matrix3d> R_B0B1 = gyro.Between(*image_ns + offset_ns, stamp_ns + offset_ns);
  if (!R_B0B1.has_value()) {
    return std::nullopt;
  }
  const Matrix3d& R_BC = rig.T_BC.rotation;
  return R_BC.transpose() * R_B0B1->transpose() * R_BC;
}

std::vector<bool> KltTracker::Implementation::Confirm(const std::optional<Matrix3d>& R_C1C0,
                                                      std::vector<bool> alive,
                                                      std::vector<cv::Point2f>* pixels) {
  std::vector<bool> unconfirmed(tracks.size());
  for (size_t i = 0; i < tracks.size(); ++i) {
    unconfirmed[i] =
        alive[i] && !MatchTemplate(images.smoothed(), config, DeformationBy(R_C1C0, rig.camera, tracks[i]),
                                   &tracks[i], &(*pixels)[i]);
  }
  RequireReturn(unconfirmed, *pixels, kReturnPx, &alive);
  for (size_t i = 0; i < tracks.size(); ++i) {
    if (unconfirmed[i] && alive[i]) {
      BeginTemplate(images.smoothed(), config, (*pixels)[i], &tracks[i]);
    }
  }
  return alive;
}

void KltTracker::Implementation::RequireReturn(const std::vector<bool>& marked,
                                               const std::vector<cv::Point2f>& pixels, double tolerance_px,
                                               std::vector<bool>* alive) const {
  std::vector<size_t> indices;
  std::vector<cv::Point2f> from, to;
  for (size_t i = 0; i < tracks.size(); ++i) {
    if (marked[i]) {
      indices.push_back(i);
      from.push_back(tracks[i].pixel);
      to.push_back(pixels[i]);
    }
  }
  const std::vector<bool> returned = flow.Return(from, to, tolerance_px);
  for (size_t k = 0; k < indices.size(); ++k) {
    (*alive)[indices[k]] = returned[k];
  }
}

void KltTracker::Implementation::Follow(const std::optional<Matrix3d>& R_C1C0, double dt_s) {
  if (tracks.empty()) {
    return;
  }
  std::vector<cv::Point2f> pixels = PredictedPixels(tracks, R_C1C0, rig.camera);
  std::vector<bool> alive = flow.Follow(Pixels(tracks), &pixels);
  if (config.forward_backward_px > 0) {
    const std::vector<bool> followed = alive;
    RequireReturn(followed, pixels, config.forward_backward_px, &alive);
  }
  if (config.template_px > 0) {
    alive = Confirm(R_C1C0, std::move(alive), &pixels);
  }
  std::vector<BearingPair> pairs;
  const int reach_px = config.window_px / 2;
  for (size_t i = 0; i < tracks.size(); ++i) {
    BearingPair pair{.first = tracks[i].ray, .second = Vector3d::UnitZ()};
    const Vector2d pixel = ToVector(pixels[i]);
    alive[i] = alive[i] && rig.camera.InImage(pixel, reach_px) && PixelRay(rig.camera, pixel, &pair.second);
    if (alive[i]) {
      tracks[i].pixel = pixels[i];
      tracks[i].ray = pair.second;
      ++tracks[i].length;
      pairs.push_back(pair);
    }
  }
  statistics.lost = Keep(alive, &tracks);
  const EpipolarOptions options{.threshold_px = config.ransac_threshold_px,
                                .focal_px = rig.camera.mean_focal_px(),
                                .dt_s = dt_s,
                                .on_sphere = rig.camera.plane() == ObservationPlane::kTangent};
  statistics.rejected = Keep(FindEpipolarInliers(pairs, R_C1C0, options), &tracks);
}

void KltTracker::Implementation::Spread() {
  std::vector<size_t> order(tracks.size());
  std::iota(order.begin(), order.end(), size_t{0});
  // Stable: of equally long tracks the one with the smaller id wins.
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return tracks[a].length > tracks[b].length; });
  std::vector<cv::Point2f> preferred;
  preferred.reserve(order.size());
  for (const size_t i : order) {
    preferred.push_back(tracks[i].pixel);
  }
  const std::vector<bool> kept = grid.Thin(preferred);
  std::vector<bool> marked(tracks.size());
  for (size_t k = 0; k < order.size(); ++k) {
    marked[order[k]] = kept[k];
  }
  statistics.thinned = Keep(marked, &tracks);
  statistics.tracked = static_cast<int>(tracks.size());
}

void KltTracker::Implementation::KeepAll(TimeNs stamp_ns) {
  if (SecondsBetween(*image_ns, stamp_ns) > kMaxRepeatedS) {
    static_cast<void>(RotationSinceLast(stamp_ns));  // forgets the samples before
    image_ns = stamp_ns;
  }
  for (FeatureTrack& track : tracks) {
    ++track.length;
  }
  statistics.tracked = static_cast<int>(tracks.size());
}

void KltTracker::Implementation::Advance(TimeNs stamp_ns) {
  flow.Add(images.contrasted());
  if (image_ns.has_value()) {
    Follow(RotationSinceLast(stamp_ns), SecondsBetween(*image_ns, stamp_ns));
    Spread();
  }
  Detect();
  image_ns = stamp_ns;
}

void KltTracker::Implementation::Detect() {
  for (const cv::Point2f& corner : grid.Detect(flow.image(), flow.derivatives(), Pixels(tracks))) {
    FeatureTrack track;
    track.id = next_id;
    track.pixel = corner;
    if (!rig.camera.InImage(ToVector(corner), BorderPx(config)) ||
        !PixelRay(rig.camera, ToVector(corner), &track.ray)) {
      continue;
    }
    if (config.template_px > 0) {
      BeginTemplate(images.smoothed(), config, corner, &track);
    }
    tracks.push_back(std::move(track));
    ++next_id;
    ++statistics.detected;
  }
}

KltTracker::KltTracker(const FrontendConfig& config, const RigCalibration& rig)
    : implementation_(std::make_unique<Implementation>(config, rig)) {
  ForbidThreadsInside();
}

KltTracker::~KltTracker() = default;

void KltTracker::AddImu(const ImuSample& sample) {
  if (implementation_->config.imu_prediction && !implementation_->gyro.Add(sample)) {
    ++implementation_->statistics.imu_ignored;
  }
}

Result<TrackFrame> KltTracker::Track(TimeNs stamp_ns, const unsigned char* grey, int width_px,
                                     int height_px) {
  const Stopwatch stopwatch;
  Implementation& tracker = *implementation_;
  ALIDADE_RETURN_IF_ERROR(tracker.CheckInput(stamp_ns, grey, width_px, height_px));
  tracker.statistics = TrackerStatistics{.imu_ignored = tracker.statistics.imu_ignored};
  if (tracker.images.Add(grey)) {
    tracker.Advance(stamp_ns);
  } else {
    tracker.KeepAll(stamp_ns);
  }
  tracker.last_stamp_ns = stamp_ns;
  double length_sum = 0;
  for (const FeatureTrack& track : tracker.tracks) {
    length_sum += track.length;
  }
  tracker.statistics.mean_track_length =
      length_sum / static_cast<double>(std::max<size_t>(1, tracker.tracks.size()));
  TrackFrame frame = ToFrame(stamp_ns, tracker.tracks);
  frame.frontend_ms = stopwatch.ElapsedMs();
  return frame;
}

const TrackerStatistics& KltTracker::statistics() const {
  return implementation_->statistics;
}

}  // namespace alidade
