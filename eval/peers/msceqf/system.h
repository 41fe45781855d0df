#pragma once

#include <msceqf/msceqf.hpp>
#include <string>

#include "core/status.h"
#include "eval/bag/dataset_images.h"
#include "eval/peers/peer_feed.h"
#include "eval/peers/peer_run.h"

namespace alidade::msceqf_driver {

/// MSCEqF fed with the images of a sequence. Its clock is that of the sequence less the first IMU stamp: its
/// doubles of seconds would resolve Unix time to 0.24 us.
class System {
 public:
  /// `file`: its settings. Throws what its reader throws.
  System(const std::string& file, const PeerSequence& sequence);

  /// Feeds everything. The front end's time is that of its tracker, the back end's the rest. Errors: those of
  /// the images.
  Result<PeerRun> Run();

 private:
  [[nodiscard]] double TimeOf(TimeNs stamp_ns) const;
  Status FeedFrame(size_t frame);
  void Record(size_t frame, double total_s);

  const PeerSequence& sequence_;
  DatasetImages images_;
  msceqf::MSCEqF filter_;
  double imu_s_ = 0;  ///< CPU time of IMU delivery since the last frame
  PeerRun run_;
};

}  // namespace alidade::msceqf_driver
