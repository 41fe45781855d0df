#include "eval/dataset/clock_shift.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/eval/dataset/healthy_dataset.h"

namespace alidade {
namespace {

using test::Complaints;
using test::Healthy;
using testing::HasSubstr;
using testing::Not;
using Severity = DatasetFinding::Severity;

constexpr TimeNs kStart = 1'500'000'000'000'000'000;  // 2017: 18 leap seconds

TimeSpan Span(double first_s, double last_s) {
  return {kStart + SecondsToNs(first_s), kStart + SecondsToNs(last_s)};
}

TEST(ClockShift, OfClocksThatDoNotCountFrom1980NoLeapSecondsAreKnown) {
  EXPECT_EQ(KnownClockShifts(kStart).front().shift_ns, 18 * kSecondNs);
  EXPECT_EQ(KnownClockShifts(1000 * kSecondNs).front().shift_ns, 3600 * kSecondNs);
  EXPECT_EQ(KnownClockShifts(kStart).back().shift_ns, -86400 * kSecondNs);
}

// GIVEN a sensor that is late by a known difference WHEN its span is compared THEN that difference is found
// with the sign that mends it.
TEST(ClockShift, SpansWithoutCommonTimeMeetByTheKnownDifference) {
  for (const double late_s : {18.0, -18.0, 3600.0, -7200.0, 14 * 3600.0, 86400.0}) {
    const std::optional<Meeting> meeting = ShiftOntoSpan(Span(late_s + 0.5, late_s + 14.5), Span(0, 15));
    ASSERT_TRUE(meeting) << late_s;
    EXPECT_EQ(meeting->shift.shift_ns, SecondsToNs(-late_s));
    EXPECT_DOUBLE_EQ(meeting->share, 1);
  }
  EXPECT_FALSE(ShiftOntoSpan(Span(500, 515), Span(0, 15))) << "no known difference";
  EXPECT_FALSE(ShiftOntoSpan(Span(1e7, 1e7 + 15), Span(0, 15))) << "another day";
}

TEST(ClockShift, OfSpansWithCommonTimeBothEndsHaveToBeOff) {
  const std::optional<ClockShift> shift = ShiftOfBothEnds(Span(18.5, 77.2), Span(0, 60));
  ASSERT_TRUE(shift);
  EXPECT_EQ(shift->shift_ns, -18 * kSecondNs);
  EXPECT_FALSE(ShiftOfBothEnds(Span(18, 60), Span(0, 60))) << "switched on late";
  EXPECT_FALSE(ShiftOfBothEnds(Span(0, 78), Span(0, 60))) << "stopped late";
  EXPECT_FALSE(ShiftOfBothEnds(Span(10, 70), Span(0, 60))) << "no known difference";
}

/// Sixty seconds of an IMU alone, and truth that is shifted.
Dataset WithTruthShifted(double shift_s, double imu_s) {
  Dataset dataset = Healthy();
  const TimeNs begin = dataset.imu.front().stamp_ns;
  const auto count = static_cast<int>(imu_s * 100);
  dataset.imu.clear();
  dataset.truth->points.clear();
  for (int i = 0; i <= count; ++i) {
    const TimeNs stamp_ns = begin + i * TimeNs{10'000'000};
    const double noise = 1e-4 * (i % 7);
    dataset.imu.push_back(
        {stamp_ns, Eigen::Vector3d(0.1 + noise, 0.1, noise), Eigen::Vector3d(noise, noise, 9.8)});
    TrajectoryPoint point;
    point.stamp_ns = stamp_ns + SecondsToNs(shift_s);
    dataset.truth->points.push_back(point);
  }
  return dataset;
}

TEST(ClockShift, CheckNamesItOfSensorsWithoutCommonTime) {
  EXPECT_THAT(
      Complaints(WithTruthShifted(18, 10), Severity::kError),
      HasSubstr("truth: shares no time with imu0: another clock? -18 s (the leap seconds between UTC and "
                "GPST) added to its stamps would make the two overlap by 100 %"));
  EXPECT_THAT(Complaints(WithTruthShifted(-7200, 10), Severity::kError),
              HasSubstr("+7200 s (2 h: a time zone)"));
  EXPECT_THAT(Complaints(WithTruthShifted(86400, 10), Severity::kError), HasSubstr("-86400 s (a day)"));
  EXPECT_THAT(Complaints(WithTruthShifted(1e6, 10), Severity::kError),
              testing::AllOf(HasSubstr("another clock?"), Not(HasSubstr("added to its stamps"))));
}

TEST(ClockShift, WithoutCommonTimeNoSecondsWithoutTheOtherAreReported) {
  Dataset dataset = Healthy();
  for (TrackFrame& frame : dataset.frames) {
    frame.stamp_ns += 18 * kSecondNs;
  }
  EXPECT_THAT(Complaints(dataset, Severity::kError), HasSubstr("cam0: shares no time with imu0"));
  EXPECT_EQ(Complaints(dataset, Severity::kWarning), "");
  EXPECT_THAT(Complaints(WithTruthShifted(-1.5e9 + 3600, 10), Severity::kError),
              HasSubstr("truth: shares no time with imu0: another clock, or another unit of time?"));
}

TEST(ClockShift, CheckNamesItOfSensorsThatAreOffAtBothEnds) {
  EXPECT_THAT(
      Complaints(WithTruthShifted(18, 60), Severity::kWarning),
      HasSubstr("truth: starts +18.000 s and ends +18.000 s against imu0, expected about 0: is it -18 s"));
  EXPECT_THAT(Complaints(WithTruthShifted(12, 60), Severity::kWarning), Not(HasSubstr("is it")));
}

}  // namespace
}  // namespace alidade
