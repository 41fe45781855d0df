#pragma once

#include <track/TrackKLT.h>

#include <memory>
#include <unordered_map>

#include "core/cpu_time.h"
#include "core/track_frame.h"
#include "eval/peers/open_vins/vio_names.h"

namespace alidade::open_vins {

using Cameras = std::unordered_map<size_t, std::shared_ptr<ov_core::CamBase>>;

/// In place of the system's tracker: the observations of `*frame` enter the database as they are.
class GivenTracks : public ov_core::TrackBase {
 public:
  GivenTracks(const Cameras& cameras, std::shared_ptr<ov_core::FeatureDatabase> shared,
              const TrackFrame* const* frame)
      : TrackBase(cameras, 0, 0, false, HistogramMethod::NONE), frame_(frame) {
    database = std::move(shared);
  }

  void feed_new_camera(const ov_core::CameraData& message) override {
    for (const TrackObservation& track : (*frame_)->observations) {
      const cv::Point2f pixel(static_cast<float>(track.pixel.x()), static_cast<float>(track.pixel.y()));
      const cv::Point2f plane = Undistorted(*camera_calib.at(0), pixel);
      database->update_feature(static_cast<size_t>(track.track_id), message.timestamp, 0, pixel.x, pixel.y,
                               plane.x, plane.y);
    }
  }

 private:
  const TrackFrame* const* frame_;
};

/// The system's tracker with its CPU time [s] of the newest frame in `*seconds`.
class TimedKlt : public ov_core::TrackKLT {
 public:
  TimedKlt(const Cameras& cameras, const vio::VioManagerOptions& options,
           std::shared_ptr<ov_core::FeatureDatabase> shared, double* seconds)
      : TrackKLT(cameras, options.init_options.init_max_features, 0, false, options.histogram_method,
                 options.fast_threshold, options.grid_x, options.grid_y, options.min_px_dist
#ifdef ALIDADE_SQRT_VINS
                 ,
                 options.ransac_th
#endif
                 ),
        seconds_(seconds) {
    database = std::move(shared);
  }

  void feed_new_camera(const ov_core::CameraData& message) override {
    const double before = ProcessCpuSeconds();
    TrackKLT::feed_new_camera(message);
    *seconds_ = ProcessCpuSeconds() - before;
  }

 private:
  double* seconds_;
};

}  // namespace alidade::open_vins
