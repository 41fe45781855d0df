#pragma once

#include <map>
#include <memory>
#include <string>

#include "core/status.h"
#include "eval/bag/dataset_images.h"
#include "eval/peers/given_features.h"
#include "eval/peers/ingvio_files.h"
#include "eval/peers/peer_feed.h"
#include "eval/peers/peer_gnss.h"
#include "eval/peers/peer_run.h"
#include "eval/peers/peer_world.h"

namespace alidade::ingvio {

class Filter;
class Tracker;

/// InGVIO, tracker and filter, fed with a sequence by the messages that its nodes take. Its clock is that of
/// the sequence less the first IMU stamp: its doubles of seconds would resolve Unix time to 0.24 us. One
/// object a process.
class System {
 public:
  /// Writes its files ingvio.yaml and camera.yaml into `folder` and starts it with them. kInput: a lens model
  /// that it has not, or a lens that it undistorts differently, if that is checked: one step of an expansion
  /// is right for weak distortion alone; kOutput.
  static Result<std::unique_ptr<System>> Create(const PeerSequence& sequence, const PeerGnss& gnss,
                                                IngvioSettings settings, const std::string& folder,
                                                bool checks_lens);
  ~System();

  /// Feeds everything. A row is written for each image that the filter gets once it is initialised, in ENU at
  /// the sequence's anchor once aligned. Errors: those of the images.
  Result<PeerRun> Run();

  [[nodiscard]] std::optional<TimeNs> aligned_ns() const { return world_.aligned_ns(); }

 private:
  System(const PeerSequence& sequence, const PeerGnss& gnss, bool uses_gnss);
  [[nodiscard]] double TimeOf(TimeNs stamp_ns) const;
  void FeedImu(const ImuSample& sample);
  void FeedEpoch(std::size_t epoch);
  void FeedNavigation();
  Status FeedFrame(size_t frame);
  Status PublishFeatures(size_t frame, double time_s);
  /// Calls back for all that waits; adds its CPU time to the back end's.
  void Work();
  void Record(size_t frame, double time_s);

  const PeerSequence& sequence_;
  const PeerGnss& gnss_;
  bool uses_gnss_;
  std::unique_ptr<Filter> filter_;
  std::unique_ptr<Tracker> tracker_;
  PeerWorld world_;
  DatasetImages images_;
  GivenFeatures given_;
  PeerTimes times_;
  PeerRun run_;
};

}  // namespace alidade::ingvio
