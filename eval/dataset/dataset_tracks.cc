#include "eval/dataset/dataset_tracks.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "eval/dataset/sensor_table.h"
#include "eval/files/output_file.h"

namespace alidade {
namespace {

Status CloseFrame(TrackFrame* frame, const std::string& place) {
  std::vector<TrackObservation>& observations = frame->observations;
  const auto by_id = [](const TrackObservation& a, const TrackObservation& b) {
    return a.track_id < b.track_id;
  };
  if (!std::is_sorted(observations.begin(), observations.end(), by_id)) {
    std::stable_sort(observations.begin(), observations.end(), by_id);
  }
  for (size_t i = 1; i < observations.size(); ++i) {
    if (observations[i].track_id == observations[i - 1].track_id) {
      return Status::Input(place + ": track_id " + std::to_string(observations[i].track_id) +
                           " occurs twice at stamp " + std::to_string(frame->stamp_ns) +
                           ", expected each track at most once a frame");
    }
  }
  return Status::Ok();
}

Status ReadNoiseRatio(const CsvReader& csv, double* ratio) {
  constexpr int kColumn = 4;
  ALIDADE_RETURN_IF_ERROR(csv.ReadReal(kColumn, "noise_ratio", ratio));
  return *ratio >= 1e-3 && *ratio <= 1e3 ? Status::Ok()
                                         : csv.Fault(kColumn, "noise_ratio", "a number from 0.001 to 1000");
}

bool HasNoiseRatios(const std::vector<TrackFrame>& frames) {
  return std::any_of(frames.begin(), frames.end(), [](const TrackFrame& frame) {
    return std::any_of(frame.observations.begin(), frame.observations.end(),
                       [](const TrackObservation& observation) { return observation.noise_ratio != 1; });
  });
}

/// Hands every frame of a file to `take`.
Status ReadFrames(const std::string& path, const std::function<Status(TrackFrame*)>& take) {
  std::vector<CsvColumn> header = {{"timestamp", "ns"}, {"track_id", ""}, {"u", "px"}, {"v", "px"}};
  Result<CsvReader> csv = CsvReader::Open(path);
  ALIDADE_RETURN_IF_ERROR(csv.status());
  csv->NextRow();
  const bool with_ratio = csv->columns() > header.size();
  if (with_ratio) {
    header.push_back({"noise_ratio"});
  }
  ALIDADE_RETURN_IF_ERROR(csv->ExpectHeader(header));
  std::optional<TrackFrame> frame;
  std::string place;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(header.size()));
    TimeNs stamp = 0;
    ALIDADE_RETURN_IF_ERROR(csv->ReadTime(0, "timestamp", &stamp));
    if (!frame || stamp != frame->stamp_ns) {
      if (frame) {
        ALIDADE_RETURN_IF_ERROR(csv->ReadStamp(false, frame->stamp_ns, &stamp));
        ALIDADE_RETURN_IF_ERROR(CloseFrame(&*frame, place));
        ALIDADE_RETURN_IF_ERROR(take(&*frame));
      }
      frame = TrackFrame{stamp, {}, 0};
      place = csv->Place();
    }
    TrackObservation observation;
    ALIDADE_RETURN_IF_ERROR(csv->ReadInt64(1, "track_id", &observation.track_id));
    if (observation.track_id < 0) {
      return csv->Fault(1, "track_id", "a number that is not negative");
    }
    ALIDADE_RETURN_IF_ERROR(csv->ReadReal(2, "u", &observation.pixel.x()));
    ALIDADE_RETURN_IF_ERROR(csv->ReadReal(3, "v", &observation.pixel.y()));
    if (with_ratio) {
      ALIDADE_RETURN_IF_ERROR(ReadNoiseRatio(*csv, &observation.noise_ratio));
    }
    frame->observations.push_back(observation);
  }
  if (!frame) {
    return Status::Input(path + ": holds no track, expected at least one row");
  }
  ALIDADE_RETURN_IF_ERROR(CloseFrame(&*frame, place));
  return take(&*frame);
}

}  // namespace

Result<std::vector<TrackFrame>> ReadTracks(const std::string& path) {
  std::vector<TrackFrame> frames;
  ALIDADE_RETURN_IF_ERROR(ReadFrames(path, [&frames](TrackFrame* frame) {
    frames.push_back(std::move(*frame));
    return Status::Ok();
  }));
  return frames;
}

Status ReadTracks(const std::string& path, Table<TrackFrame>* frames) {
  return ReadFrames(path, [frames](TrackFrame* frame) { return frames->Add(*frame); });
}

Status AddEmptyFrames(const std::string& tracks_path, const std::vector<TimeNs>& stamps,
                      const Table<TrackFrame>& tracks, const std::function<Status(const TrackFrame&)>& take) {
  Table<TrackFrame>::Pass pass(tracks);
  Result<const TrackFrame*> next = pass.Next();
  for (const TimeNs stamp : stamps) {
    ALIDADE_RETURN_IF_ERROR(next.status());
    if (*next != nullptr && (*next)->stamp_ns == stamp) {
      ALIDADE_RETURN_IF_ERROR(take(**next));
      next = pass.Next();
    } else {
      ALIDADE_RETURN_IF_ERROR(take({stamp, {}, 0}));
    }
  }
  ALIDADE_RETURN_IF_ERROR(next.status());
  if (*next != nullptr) {
    return Status::Input(tracks_path + ": stamp " + std::to_string((*next)->stamp_ns) +
                         " is not in timestamps.csv beside it, expected every frame there");
  }
  return Status::Ok();
}

Status WriteTracks(const std::vector<TrackFrame>& tracks, const std::string& csv_path) {
  const bool with_ratio = HasNoiseRatios(tracks);
  std::string text = "#timestamp [ns],track_id,u [px],v [px]";
  text += with_ratio ? ",noise_ratio\n" : "\n";
  for (const TrackFrame& frame : tracks) {
    const std::string stamp = std::to_string(frame.stamp_ns) + ",";
    for (const TrackObservation& observation : frame.observations) {
      text += stamp;
      text += std::to_string(observation.track_id);
      AppendField(observation.pixel.x(), &text);
      AppendField(observation.pixel.y(), &text);
      if (with_ratio) {
        AppendField(observation.noise_ratio, &text);
      }
      text.push_back('\n');
    }
  }
  return WriteFileAtomically(csv_path, text);
}

}  // namespace alidade
