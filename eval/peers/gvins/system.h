#pragma once

#include <map>
#include <memory>
#include <vector>

#include "core/status.h"
#include "eval/bag/dataset_images.h"
#include "eval/peers/given_features.h"
#include "eval/peers/gvins/solver.h"
#include "eval/peers/gvins_pairing.h"
#include "eval/peers/imu_delivery.h"
#include "eval/peers/peer_feed.h"
#include "eval/peers/peer_run.h"
#include "eval/peers/peer_world.h"
#include "eval/peers/publish_rate.h"
#include "eval/peers/vins/tracker.h"

namespace alidade::gvins {

struct SystemSettings {
  VinsSettings solver;
  GnssSettings gnss;
  double rate_hz = 100;  ///< images a second that its tracker hands over, at most
};

/// GVINS fed with a sequence. Its clock is that of the sequence less the first IMU stamp: its doubles of
/// seconds would resolve Unix time to 0.24 us.
class System {
 public:
  /// `tracker` null: the sequence's tracks are given to the solver.
  System(const PeerSequence& sequence, const PeerGnss& gnss, const SystemSettings& settings,
         std::unique_ptr<vins::Tracker> tracker);

  /// Feeds everything. A row is written for each image that the solver gets once it is initialised, in ENU at
  /// the sequence's anchor once aligned. Times: of all images since the row before. Errors: those of the
  /// images.
  Result<PeerRun> Run();

  /// How often it was initialised: it starts anew when it finds itself lost.
  [[nodiscard]] int starts() const { return starts_; }
  [[nodiscard]] std::optional<TimeNs> aligned_ns() const { return world_.aligned_ns(); }

 private:
  [[nodiscard]] double TimeOf(TimeNs stamp_ns) const;
  Status FeedFrame(size_t frame);
  Result<std::vector<VinsFeature>> FeaturesOf(size_t frame, double time_s, bool hand_over);
  void SolveWhatCan();
  void Solve(const GvinsPairing::Pair& pair);
  void Record(size_t frame);

  const PeerSequence& sequence_;
  const PeerGnss& gnss_;
  Solver solver_;
  std::unique_ptr<vins::Tracker> tracker_;
  PublishRate rate_;
  GvinsPairing pairing_;
  PeerWorld world_;
  DatasetImages images_;
  ImuDelivery imu_;
  GivenFeatures given_;
  std::map<size_t, std::vector<VinsFeature>> features_;  ///< of frames that wait
  int handed_over_ = 0;
  int starts_ = 0;
  bool was_running_ = false;
  PeerTimes times_;
  PeerRun run_;
};

}  // namespace alidade::gvins
