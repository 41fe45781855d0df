#pragma once

#include <memory>

#include "core/frontend_config.h"
#include "core/rig_calibration.h"
#include "core/status.h"
#include "core/track_frame.h"

namespace alidade {

/// What the tracker did to one image; tracked + lost + rejected + thinned = tracks before it.
struct TrackerStatistics {
  int tracked = 0;               ///< tracks carried over
  int lost = 0;                  ///< KLT failed, left the image or failed the backward pass
  int rejected = 0;              ///< refused by the epipolar RANSAC
  int thinned = 0;               ///< dropped for crowding a longer track
  int detected = 0;              ///< new corners
  double mean_track_length = 0;  ///< frames, over the tracks alive after this image
  int imu_ignored = 0;           ///< since the start: samples out of order or not finite
};

/// Pyramidal Lucas-Kanade front end: images in, tracks out. Deterministic. OpenCV stays behind the
/// implementation.
class KltTracker {
 public:
  KltTracker(const FrontendConfig& config, const RigCalibration& rig);
  ~KltTracker();
  KltTracker(const KltTracker&) = delete;
  KltTracker& operator=(const KltTracker&) = delete;

  /// Gyroscope samples up to the next image predict where tracks start.
  void AddImu(const ImuSample& sample);
  /// grey: row-major 8-bit image of the camera's resolution (stride == width). An image that repeats the one
  /// before bit by bit leaves every track on its pixel. Error (kInput): wrong size, stamps not increasing.
  Result<TrackFrame> Track(TimeNs stamp_ns, const unsigned char* grey, int width_px, int height_px);

  [[nodiscard]] const TrackerStatistics& statistics() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace alidade
