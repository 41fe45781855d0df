#pragma once

#include <memory>
#include <vector>

#include "core/status.h"
#include "eval/bag/dataset_images.h"
#include "eval/peers/given_features.h"
#include "eval/peers/imu_delivery.h"
#include "eval/peers/peer_feed.h"
#include "eval/peers/peer_run.h"
#include "eval/peers/publish_rate.h"
#include "eval/peers/vins/tracker.h"
#include "eval/peers/vins_mono/solver.h"

namespace alidade::vins_mono {

/// VINS-Mono fed with a sequence. Its clock is that of the sequence less the first IMU stamp: its doubles of
/// seconds would resolve Unix time to 0.24 us.
class System {
 public:
  /// `tracker` null: the sequence's tracks are given to the solver.
  System(const PeerSequence& sequence, const VinsSettings& settings, double rate_hz,
         std::unique_ptr<vins::Tracker> tracker);

  /// Feeds everything. A row is written for each image that the solver gets once it is initialised. Times: of
  /// all images since the row before. Errors: those of the images.
  Result<PeerRun> Run();

  /// How often it was initialised: it starts anew when it finds itself lost.
  [[nodiscard]] int starts() const { return starts_; }

 private:
  [[nodiscard]] double TimeOf(TimeNs stamp_ns) const;
  Status FeedFrame(size_t frame);
  Result<std::vector<VinsFeature>> FeaturesOf(size_t frame, double time_s, bool hand_over);
  void Record(size_t frame);

  const PeerSequence& sequence_;
  Solver solver_;
  std::unique_ptr<vins::Tracker> tracker_;
  PublishRate rate_;
  DatasetImages images_;
  ImuDelivery imu_;
  GivenFeatures given_;
  int handed_over_ = 0;
  int starts_ = 0;
  bool was_running_ = false;
  PeerTimes times_;
  PeerRun run_;
};

}  // namespace alidade::vins_mono
