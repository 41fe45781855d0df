#include "eval/frontend_run/log_cache.h"

#include <iterator>
#include <map>

#include "eval/dataset/dataset_tracks.h"
#include "eval/files/csv.h"
#include "eval/files/csv_text.h"
#include "eval/files/hash.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
#include "eval/frontend_run/frontend_summary.h"

namespace alidade {
namespace {

/// The statistics and, without observations, the frames of frontend.csv.
Result<FrontendRun> ReadStatistics(const std::string& path) {
  Result<CsvReader> csv = CsvReader::Open(path);
  ALIDADE_RETURN_IF_ERROR(csv.status());
  csv->NextRow();
  FrontendRun run;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(8));
    TrackFrame frame;
    TrackerStatistics statistics;
    ALIDADE_RETURN_IF_ERROR(csv->ReadInt64(0, "timestamp_ns", &frame.stamp_ns));
    int* const counts[] = {&statistics.tracked, &statistics.lost, &statistics.rejected, &statistics.thinned,
                           &statistics.detected};
    for (std::size_t i = 0; i < std::size(counts); ++i) {
      std::int64_t count = 0;
      ALIDADE_RETURN_IF_ERROR(csv->ReadInt64(i + 2, "count", &count));
      *counts[i] = static_cast<int>(count);
    }
    ALIDADE_RETURN_IF_ERROR(csv->ReadReal(7, "mean_track_length", &statistics.mean_track_length));
    run.frames.push_back(std::move(frame));
    run.statistics.push_back(statistics);
  }
  return run;
}

std::string TimingCsv(const std::vector<TrackFrame>& frames) {
  std::string text = "timestamp_ns,frontend_ms\n";
  for (const TrackFrame& frame : frames) {
    text += JoinCsv({std::to_string(frame.stamp_ns), CsvNumber(frame.frontend_ms)});
  }
  return text;
}

/// Times of the frames, in order, as far as the file has them.
void ReadTiming(const std::string& path, std::vector<TrackFrame>* frames) {
  Result<CsvReader> csv = CsvReader::Open(path);
  if (!csv.ok()) {
    return;
  }
  csv->NextRow();
  for (TrackFrame& frame : *frames) {
    if (!csv->NextRow() || csv->columns() != 2 || !csv->ReadReal(1, "frontend_ms", &frame.frontend_ms).ok()) {
      return;
    }
  }
}

/// "source <digest>, tracks <digest>, statistics <digest>", a line each; empty when a file is missing.
std::string Seal(const std::string& source, const std::string& folder) {
  std::string text = "source " + Sha256Hex(source) + "\n";
  for (const char* name : {"tracks.csv", "frontend.csv"}) {
    const Result<std::string> content = ReadWholeFile(folder + "/" + name);
    if (!content.ok()) {
      return {};
    }
    text += std::string(name) + " " + Sha256Hex(*content) + "\n";
  }
  return text;
}

}  // namespace

Status WriteFrontendRun(const FrontendRun& run, const std::string& source, const std::string& folder) {
  ALIDADE_RETURN_IF_ERROR(WriteTracks(run.frames, folder + "/tracks.csv"));
  ALIDADE_RETURN_IF_ERROR(
      WriteFileAtomically(folder + "/frontend.csv", FrontendCsv(run.frames, run.statistics)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/timing.csv", TimingCsv(run.frames)));
  return WriteFileAtomically(folder + "/log.txt", Seal(source, folder));
}

std::optional<FrontendRun> ReadFrontendRun(const std::string& source, const std::string& folder) {
  const Result<std::string> seal = ReadWholeFile(folder + "/log.txt");
  if (!seal.ok() || seal->empty() || *seal != Seal(source, folder)) {
    return std::nullopt;
  }
  Result<FrontendRun> run = ReadStatistics(folder + "/frontend.csv");
  Result<std::vector<TrackFrame>> tracks = ReadTracks(folder + "/tracks.csv");
  if (!run.ok() || !tracks.ok()) {
    return std::nullopt;
  }
  ReadTiming(folder + "/timing.csv", &run->frames);
  std::map<TimeNs, std::vector<TrackObservation>> observations;
  for (TrackFrame& frame : *tracks) {
    observations[frame.stamp_ns] = std::move(frame.observations);
  }
  for (TrackFrame& frame : run->frames) {
    frame.observations = std::move(observations[frame.stamp_ns]);
  }
  return std::move(*run);
}

}  // namespace alidade
