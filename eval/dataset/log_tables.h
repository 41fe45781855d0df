#pragma once

#include <memory>
#include <vector>

#include "eval/dataset/dataset.h"
#include "eval/files/table.h"

namespace alidade {

void Encode(const ImuSample& sample, ByteWriter* bytes);
void Decode(ByteReader* bytes, ImuSample* sample);
void Encode(const TrackFrame& frame, ByteWriter* bytes);
void Decode(ByteReader* bytes, TrackFrame* frame);

/// The tables of a measurement log that grow with the length of a recording, in memory or in files: all that
/// a run has to read in order. The rest of the log is a MeasurementLog without them.
struct LogTables {
  Table<ImuSample> imu;
  Table<TrackFrame> frames;
  std::vector<Table<TrackFrame>> extra_frames;  ///< of MeasurementLog::extra_cameras
};

/// Those of a sequence or a log: the files that the sequence was read into, or views of its own vectors,
/// which must outlive the tables.
[[nodiscard]] LogTables TablesOf(const Dataset& dataset);
[[nodiscard]] LogTables TablesOf(const MeasurementLog& log);

/// Moves what a sequence holds in memory into files in `folder`. Errors: SpoolFile's.
Status MoveTablesToFiles(const std::string& folder, Dataset* dataset);

}  // namespace alidade
