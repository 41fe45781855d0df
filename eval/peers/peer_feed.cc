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
  sequence.from_tracks = medium == "tracks" || (medium == "auto" && !sequence.dataset.tracks.empty());
  if (sequence.from_tracks) {
    for (const TrackFrame& frame : sequence.dataset.tracks) {
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

Status FeedPeer(const PeerSequence& sequence, const PeerSink& sink) {
  const std::vector<TimeNs>& frames = sequence.frames_ns;
  size_t next = 0;
  const auto imu_time = [&](size_t frame) { return frames[frame] + SecondsToNs(sink.time_offset_s()); };
  for (const ImuSample& sample : sequence.dataset.imu) {
    const bool first = &sample == &sequence.dataset.imu.front();
    while (first && next < frames.size() && imu_time(next) <= sample.stamp_ns) {
      ++next;
    }
    sink.imu(sample);
    while (next < frames.size() && imu_time(next) < sample.stamp_ns) {
      ALIDADE_RETURN_IF_ERROR(sink.frame(next++));
    }
  }
  return Status::Ok();
}

}  // namespace alidade
