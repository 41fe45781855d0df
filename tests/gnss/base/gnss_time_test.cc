#include "gnss/base/gnss_time.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace alidade {
namespace {

TimeNs At(TimeScale scale, CalendarTime label) {
  const Result<TimeNs> stamp = GpsTimeFromCalendar(scale, label);
  EXPECT_TRUE(stamp.ok()) << stamp.message();
  return stamp.ok() ? *stamp : 0;
}

TEST(GnssTimeTest, WeeksBeginAtTheEpochsOfTheSystems) {
  EXPECT_EQ(At(TimeScale::kGps, {1980, 1, 6}), GpsTimeFromWeek(TimeScale::kGps, 0, 0));
  EXPECT_EQ(At(TimeScale::kBeidou, {2006, 1, 1}), GpsTimeFromWeek(TimeScale::kBeidou, 0, 0));
  // Header of an SP3 file of the IGS: 2020-06-24 is week 2111, 259200 s, MJD 59024.
  EXPECT_EQ(At(TimeScale::kGps, {2020, 6, 24}), GpsTimeFromWeek(TimeScale::kGps, 2111, 259'200 * kSecondNs));
  EXPECT_EQ(WeekFromGpsTime(At(TimeScale::kGps, {2020, 6, 24})).week, 2111);
  // GST week 0 is GPS week 1024, which RINEX keeps counting; BDT week 0 begins 14 s after GPS week 1356.
  EXPECT_EQ(GpsTimeFromWeek(TimeScale::kBeidou, 0, 0),
            GpsTimeFromWeek(TimeScale::kGps, 1356, 14 * kSecondNs));
}

TEST(GnssTimeTest, StampIsTheUnixTimeOfTheLabel) {
  EXPECT_EQ(At(TimeScale::kGps, {2025, 8, 28, 17, 30, 39, 748'000'000}), 1'756'402'239'748'000'000);
}

TEST(GnssTimeTest, LeapSecondsAreThoseOfBulletinC) {
  // RINEX 3.05, 5.2.5 and Bulletin C 52: GPST - UTC was 16 s from 2012-07-01, 17 s from 2015-07-01, 18 s from
  // 2017-01-01.
  EXPECT_EQ(LeapSeconds(At(TimeScale::kGps, {1980, 1, 6})), 0);
  EXPECT_EQ(LeapSeconds(At(TimeScale::kUtc, {1999, 1, 1})), 13);
  EXPECT_EQ(LeapSeconds(At(TimeScale::kUtc, {2015, 6, 30, 23, 59, 59})), 16);
  EXPECT_EQ(LeapSeconds(At(TimeScale::kUtc, {2015, 7, 1})), 17);
  EXPECT_EQ(LeapSeconds(At(TimeScale::kUtc, {2017, 1, 1})), 18);
  EXPECT_EQ(LeapSeconds(At(TimeScale::kUtc, {2026, 11, 21})), 18);
}

TEST(GnssTimeTest, UtcGoesThroughALeapSecondWithoutAStep) {
  const TimeNs before = At(TimeScale::kUtc, {2016, 12, 31, 23, 59, 59});
  const TimeNs inside = At(TimeScale::kUtc, {2016, 12, 31, 23, 59, 60});
  const TimeNs after = At(TimeScale::kUtc, {2017, 1, 1, 0, 0, 0});
  EXPECT_EQ(inside - before, kSecondNs);
  EXPECT_EQ(after - inside, kSecondNs);
  EXPECT_EQ(after, At(TimeScale::kGps, {2017, 1, 1, 0, 0, 18}));
  EXPECT_EQ(CalendarFromGpsTime(TimeScale::kUtc, inside).second, 60);
  EXPECT_EQ(CalendarFromGpsTime(TimeScale::kUtc, inside).day, 31);
  EXPECT_EQ(CalendarFromGpsTime(TimeScale::kUtc, after).second, 0);
}

TEST(GnssTimeTest, ScalesDifferByTheirConstants) {
  const CalendarTime label{2022, 6, 8, 10, 0, 0};
  const TimeNs gps = At(TimeScale::kGps, label);
  EXPECT_EQ(At(TimeScale::kGalileo, label), gps);
  EXPECT_EQ(At(TimeScale::kQzss, label), gps);
  EXPECT_EQ(At(TimeScale::kBeidou, label), gps + 14 * kSecondNs);
  EXPECT_EQ(At(TimeScale::kTai, label), gps - 19 * kSecondNs);
  EXPECT_EQ(At(TimeScale::kUtc, label), gps + 18 * kSecondNs);
  EXPECT_EQ(At(TimeScale::kGlonass, label), gps + 18 * kSecondNs - 3 * 3600 * kSecondNs);
}

TEST(GnssTimeTest, LabelsComeBackInEveryScale) {
  RandomStream random(3, "labels");
  for (int i = 0; i < 2000; ++i) {
    const auto stamp = static_cast<TimeNs>(random.Uniform(4e17, 4e18));
    for (const TimeScale scale : {TimeScale::kGps, TimeScale::kGalileo, TimeScale::kQzss, TimeScale::kBeidou,
                                  TimeScale::kUtc, TimeScale::kGlonass, TimeScale::kTai}) {
      EXPECT_EQ(At(scale, CalendarFromGpsTime(scale, stamp)), stamp);
    }
    const WeekTime week = WeekFromGpsTime(stamp);
    EXPECT_EQ(GpsTimeFromWeek(TimeScale::kGps, week.week, week.of_week_ns), stamp);
    EXPECT_EQ(NearestTimeOfWeek(TimeScale::kGps, week.of_week_ns, stamp + 3 * kDayNs), stamp);
    EXPECT_EQ(NearestTimeOfWeek(TimeScale::kGps, week.of_week_ns, stamp - 3 * kDayNs), stamp);
  }
}

TEST(GnssTimeTest, LabelsOutOfRangeAreRefusedByName) {
  for (const CalendarTime& label :
       {CalendarTime{2020, 2, 30}, CalendarTime{2020, 13, 1}, CalendarTime{2020, 0, 1},
        CalendarTime{1979, 1, 1}, CalendarTime{2100, 1, 1}, CalendarTime{2020, 1, 1, 24, 0, 0},
        CalendarTime{2020, 1, 1, 0, 60, 0}, CalendarTime{2020, 1, 1, 0, 0, 61},
        CalendarTime{2020, 1, 1, 0, 0, -1}, CalendarTime{2020, 1, -5}}) {
    const Result<TimeNs> stamp = GpsTimeFromCalendar(TimeScale::kGps, label);
    ASSERT_FALSE(stamp.ok());
    EXPECT_NE(stamp.message().find("expected a date"), std::string::npos) << stamp.message();
  }
}

TEST(GnssTimeTest, FormatRoundsAndCarries) {
  const TimeNs stamp = At(TimeScale::kGps, {2020, 6, 24, 23, 59, 59, 999'600'000});
  EXPECT_EQ(FormatGpsTime(stamp, 3), "2020/06/25 00:00:00.000");
  EXPECT_EQ(FormatGpsTime(stamp, 4), "2020/06/24 23:59:59.9996");
  EXPECT_EQ(FormatGpsTime(stamp, 0), "2020/06/25 00:00:00");
}

}  // namespace
}  // namespace alidade
