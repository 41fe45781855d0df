#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/status.h"
#include "eval/dataset/dataset.h"

namespace alidade {

/// A sequence as a driver gives it to another system.
struct PeerSequence {
  Dataset dataset;
  bool from_tracks = false;       ///< frames are dataset.frames, else dataset.images
  std::vector<TimeNs> frames_ns;  ///< camera stamps, strictly increasing
};

/// Reads a folder or a bag. `medium`: "tracks", "images", or "auto": tracks where there are some. kUsage:
/// another word; kInput: the sequence does not have it, and as ReadDataset.
Result<PeerSequence> ReadPeerSequence(const std::string& path, const std::string& medium);

/// What receives a sequence.
struct PeerSink {
  std::function<void(const ImuSample& sample)> imu;
  /// Camera's clock to IMU time, t_imu = t_camera + offset [s], as the other system estimates it at present.
  std::function<double()> time_offset_s;
  std::function<Status(size_t frame)> frame;
  std::function<void(size_t epoch)> epoch = {};  ///< index into the stamps given beside it
};

/// Delivers all IMU samples and, right after the first sample that is later than it, each frame and each GNSS
/// epoch (`epochs_ns`: IMU time, rising), an epoch before a frame that is not earlier: one thread and one
/// order, whatever the machine's speed. Frames and epochs at or before the first sample and after the last
/// one are left out. Errors: those of `frame`, which end it.
Status FeedPeer(const PeerSequence& sequence, const PeerSink& sink,
                const std::vector<TimeNs>& epochs_ns = {});

}  // namespace alidade
