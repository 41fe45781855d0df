#pragma once

#include <vector>

#include "core/time.h"
#include "core/track_frame.h"
#include "eval/comparison/comparison.h"
#include "eval/record/run_record.h"

namespace alidade {

/// Fills the completion of `cell` from the stamps of its rows, in IMU time, and the sequence's camera frames,
/// `camera_time_offset_s` before it; without two frames it stays unknown.
void ScoreCompletion(const std::vector<TimeNs>& rows_ns, const std::vector<TrackFrame>& frames,
                     double camera_time_offset_s, CellResult* cell);

/// Fills the real-time factor of `cell` from the seconds of camera data that were processed and the seconds
/// that it took; unknown when either is zero.
void ScoreSpeed(double data_s, double run_s, CellResult* cell);

/// Both of a run of ours. Its time is that of its records, so frames without an estimate enter neither side
/// of the real-time factor.
void ScoreProgress(const std::vector<RunRecord>& records, const std::vector<TrackFrame>& frames,
                   double camera_time_offset_s, CellResult* cell);

}  // namespace alidade
