#pragma once

#include <map>

#include "core/frontend_config.h"
#include "eval/run/session.h"
#include "frontend/tracking/image_reader.h"
#include "frontend/tracking/klt_tracker.h"

namespace alidade {

/// Images for a Session: tracks them once the IMU reaches them, in the order of their stamps, and hands the
/// tracks on. The samples of the IMU come through here; all else goes to the session itself.
class ImageFeed {
 public:
  /// `session` outlives the object. `lateness`: the session's own; images wait as frames do.
  ImageFeed(const FrontendConfig& config, const RigCalibration& rig, const Lateness& lateness,
            Session* session);

  /// kInput: the tracker refused an image that had waited.
  Status AddImu(const ImuSample& sample);
  /// Stamp in camera time. kInput: not of the camera's size, not after the last tracked image, a second one
  /// of its stamp; or an older image was dropped because too many wait for the IMU.
  Status AddImage(TimeNs stamp_ns, GreyImage image);
  /// Tracks the images that wait, and flushes the session: at the end of a log.
  Status Flush();

 private:
  /// Tracks the images with an IMU time up to `imu_ns`.
  Status TrackUntil(TimeNs imu_ns);

  const int width_px_;
  const int height_px_;
  const TimeNs offset_ns_;    ///< t_imu = t_camera + offset
  const TimeNs lateness_ns_;  ///< of an image, and of the samples around it
  Session& session_;
  KltTracker tracker_;
  ImuStream imu_{true};
  std::map<TimeNs, GreyImage> images_;  ///< waiting, by camera stamp
  TimeNs last_image_ns_ = INT64_MIN;    ///< tracked
};

}  // namespace alidade
