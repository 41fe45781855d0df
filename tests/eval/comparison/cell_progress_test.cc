#include "eval/comparison/cell_progress.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

constexpr TimeNs kPeriodNs = kSecondNs / 10;

/// 101 frames at 10 Hz: 10 s.
std::vector<TrackFrame> Frames() {
  std::vector<TrackFrame> frames(101);
  for (size_t i = 0; i < frames.size(); ++i) {
    frames[i].stamp_ns = static_cast<TimeNs>(i) * kPeriodNs;
  }
  return frames;
}

RunRecord Record(int frame, double frontend_ms, double backend_ms) {
  RunRecord record;
  record.estimate.stamp_ns = frame * kPeriodNs;
  record.frontend_ms = frontend_ms;
  record.backend_ms = backend_ms;
  return record;
}

// GIVEN an estimate from 2 to 4 s and from 7 to 8 s WHEN scored THEN three of ten seconds are completed, and
// they took 32 frames of 5 ms.
TEST(CellProgress, GivenALostRunThenCompletionAndSpeedAreOfWhatItCovered) {
  std::vector<RunRecord> records;
  for (int frame = 20; frame <= 80; ++frame) {
    if (frame <= 40 || frame >= 70) {
      records.push_back(Record(frame, 2, 3));
    }
  }
  CellResult cell;
  cell.status = "diverged";
  ScoreProgress(records, Frames(), 0, &cell);
  EXPECT_DOUBLE_EQ(*cell.completion, 0.3);
  EXPECT_DOUBLE_EQ(*cell.realtime_factor, 3 / (32 * 5e-3));
}

// GIVEN a camera whose clock is a second behind the IMU's WHEN all of its frames have an estimate, in IMU
// time, THEN everything is completed.
TEST(CellProgress, GivenACameraClockOfItsOwnThenItsFramesAreMeantInImuTime) {
  std::vector<TimeNs> rows_ns;
  for (const TrackFrame& frame : Frames()) {
    rows_ns.push_back(frame.stamp_ns + kSecondNs);
  }
  CellResult cell;
  ScoreCompletion(rows_ns, Frames(), 1, &cell);
  EXPECT_DOUBLE_EQ(*cell.completion, 1);
  ScoreCompletion(rows_ns, Frames(), 0, &cell);
  EXPECT_DOUBLE_EQ(*cell.completion, 0.9);
}

TEST(CellProgress, GivenNoRecordThenNothingIsCompletedAndTheSpeedIsUnknown) {
  CellResult cell;
  ScoreProgress({}, Frames(), 0, &cell);
  EXPECT_EQ(cell.completion, 0.0);
  EXPECT_FALSE(cell.realtime_factor.has_value());
}

TEST(CellProgress, GivenNoCameraThenBothAreUnknown) {
  CellResult cell;
  ScoreProgress({Record(0, 0, 1), Record(100, 0, 1)}, {}, 0, &cell);
  EXPECT_FALSE(cell.completion.has_value());
  EXPECT_FALSE(cell.realtime_factor.has_value());
}

}  // namespace
}  // namespace alidade
