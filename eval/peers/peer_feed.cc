#include "eval/peers/peer_feed.h"

#include "eval/bag/dataset_source.h"

namespace alidade {

Result<PeerSequence> ReadPeerSequence(const std::string& path, const std::string& medium) {
  if (medium != "auto" && medium != "tracks" && medium != "images") {
    return Status::Usage("--input: found '" + medium + "', expected auto, tracks or images");
  }
  DatasetSource source;
  source.path = path;
  Result<Dataset> dataset = ReadDataset(source);
  ALIDADE_RETURN_IF_ERROR(dataset.status());
  PeerSequence sequence;
  sequence.dataset = std::move(*dataset);
  sequence.from_tracks = medium == "tracks" || (medium == "auto" && !sequence.dataset.frames.empty());
  if (sequence.from_tracks) {
    for (const TrackFrame& frame : sequence.dataset.frames) {
      sequence.frames_ns.push_back(frame.stamp_ns);
    }
  } else {
    for (const ImageEntry& image : sequence.dataset.images) {
      sequence.frames_ns.push_back(image.stamp_ns);
    }
  }
  if (sequence.frames_ns.empty()) {
    return Status::Input(path + ": has no " + (sequence.from_tracks ? "tracks" : "images"));
  }
  return sequence;
}

Status FeedPeer(const PeerSequence& sequence, const PeerSink& sink, const std::vector<TimeNs>& epochs_ns) {
  const std::vector<TimeNs>& frames = sequence.frames_ns;
  size_t frame = 0, epoch = 0;
  const auto frame_time = [&] { return frames[frame] + SecondsToNs(sink.time_offset_s()); };
  const TimeNs first_ns = sequence.dataset.imu.empty() ? 0 : sequence.dataset.imu.front().stamp_ns;
  while (frame < frames.size() && frame_time() <= first_ns) {
    ++frame;
  }
  while (epoch < epochs_ns.size() && epochs_ns[epoch] <= first_ns) {
    ++epoch;
  }
  for (const ImuSample& sample : sequence.dataset.imu) {
    sink.imu(sample);
    for (;;) {
      const bool has_frame = frame < frames.size() && frame_time() < sample.stamp_ns;
      const bool has_epoch = epoch < epochs_ns.size() && epochs_ns[epoch] < sample.stamp_ns;
      if (has_epoch && (!has_frame || epochs_ns[epoch] <= frame_time())) {
        sink.epoch(epoch++);
      } else if (has_frame) {
        ALIDADE_RETURN_IF_ERROR(sink.frame(frame++));
      } else {
        break;
      }
    }
  }
  return Status::Ok();
}

}  // namespace alidade
