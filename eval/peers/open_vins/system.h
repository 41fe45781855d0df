#pragma once

#include <core/VioManager.h>

#include <memory>

#include "core/status.h"
#include "eval/bag/dataset_images.h"
#include "eval/peers/open_vins/vio_names.h"
#include "eval/peers/peer_feed.h"
#include "eval/peers/peer_run.h"

namespace alidade::open_vins {

/// The system fed with a sequence. Its clock is that of the sequence less the first IMU stamp, plus 1000 s:
/// its doubles of seconds would resolve Unix time to 0.24 us, and times below its window mean "none" to it.
class System : private vio::VioManager {
 public:
  System(vio::VioManagerOptions options, const PeerSequence& sequence);

  /// Starts from the first row of the truth at or after the first IMU sample, with the system's own prior
  /// (deviations 0.017 rad, 0.05 m, 0.01 m/s, 0.02 rad/s, 0.02 m/s^2). Frames until then are left out.
  /// kInput: the truth has no such row, or no velocity and biases.
  Status StartFromTruth();

  /// Feeds everything. The front end's time is that of the system's own tracker, or none where tracks are
  /// given; the back end's is the rest, IMU delivery included. Errors: those of the images.
  Result<PeerRun> Run();

 private:
  [[nodiscard]] double TimeOf(TimeNs stamp_ns) const;
  [[nodiscard]] Result<cv::Mat> ImageOf(size_t frame);
  Status FeedFrame(size_t frame);
  void Record(size_t frame, double total_s);

  const PeerSequence& sequence_;
  DatasetImages images_;
  const TrackFrame* given_ = nullptr;  ///< tracks of the frame being fed
  double frontend_s_ = 0;              ///< CPU time of the tracker in the frame being fed
  double imu_s_ = 0;                   ///< CPU time of IMU delivery since the last frame
  double start_ = 0;                   ///< frames until then are left out
  PeerRun run_;
};

}  // namespace alidade::open_vins
