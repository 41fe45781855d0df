#include "eval/dataset/stamp_unit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/eval/dataset/healthy_dataset.h"

namespace alidade {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Severity = DatasetFinding::Severity;

constexpr TimeNs kDateNs = 1'403'715'273'262'142'976;  // June 2014

/// Unit of stamps of this rate that begin at `first_ns`, written in units of `unit_ns`; "ns" when none is
/// named.
std::string UnitOf(double rate_hz, TimeNs first_ns, TimeNs unit_ns, double stated_hz,
                   const RateLimits& limits) {
  constexpr int kStamps = 101;
  const TimeNs last_ns = first_ns + SecondsToNs((kStamps - 1) / rate_hz);
  const StampUnit* unit = OtherStampUnit(first_ns / unit_ns, last_ns / unit_ns, kStamps, stated_hz, limits);
  return unit == nullptr ? "ns" : unit->name;
}

TEST(StampUnit, RatesAtTheEdgesAreTakenAsTheyAre) {
  for (const TimeNs first_ns : {TimeNs{0}, 1000 * kSecondNs, kDateNs}) {
    EXPECT_EQ(UnitOf(20, first_ns, 1, 0, kImuRates), "ns");
    EXPECT_EQ(UnitOf(9900, first_ns, 1, 0, kImuRates), "ns");
    EXPECT_EQ(UnitOf(32'000, first_ns, 1, 0, kImuRates), "ns") << "the fastest MEMS sensors";
    EXPECT_EQ(UnitOf(0.9, first_ns, 1, 0, kCameraRates), "ns");
    EXPECT_EQ(UnitOf(490, first_ns, 1, 0, kCameraRates), "ns");
    EXPECT_EQ(UnitOf(1000, first_ns, 1, 0, kCameraRates), "ns") << "rendered events";
    EXPECT_EQ(UnitOf(5000, first_ns, 1, 0, kCameraRates), "ns") << "5 Hz in us are no usual rate";
  }
}

TEST(StampUnit, MicrosecondsAndMillisecondsAreRecognisedByTheRateWhereverTheStampsBegin) {
  for (const TimeNs first_ns : {TimeNs{0}, 1000 * kSecondNs, kDateNs}) {
    for (const double rate_hz : {40.0, 200.0, 1000.0}) {
      EXPECT_EQ(UnitOf(rate_hz, first_ns, 1000, 0, kImuRates), "us") << rate_hz;
      EXPECT_EQ(UnitOf(rate_hz, first_ns, 1'000'000, 0, kImuRates), "ms") << rate_hz;
    }
    for (const double rate_hz : {10.0, 20.0, 200.0}) {
      EXPECT_EQ(UnitOf(rate_hz, first_ns, 1000, 0, kCameraRates), "us") << rate_hz;
      EXPECT_EQ(UnitOf(rate_hz, first_ns, 1'000'000, 0, kCameraRates), "ms") << rate_hz;
    }
  }
}

// A camera of less than 1 Hz: in range of no unit, but the sheet has the rate.
TEST(StampUnit, TheRateOfTheSheetDecidesWhereTheRangeCannot) {
  EXPECT_EQ(UnitOf(0.9, kDateNs, 1000, 0, kCameraRates), "ns");
  EXPECT_EQ(UnitOf(0.9, kDateNs, 1000, 0.91, kCameraRates), "us");
}

TEST(StampUnit, ARateThatTheSheetStatesIsNoUnit) {
  EXPECT_EQ(UnitOf(50'000, kDateNs, 1, 0, kImuRates), "us");
  EXPECT_EQ(UnitOf(50'000, kDateNs, 1, 50'000, kImuRates), "ns");
}

TEST(StampUnit, AFewStampsAreNoRate) {
  EXPECT_EQ(OtherStampUnit(1000, 3000, 3, 200, kImuRates), nullptr);
}

TEST(StampUnit, ADateIsPrintedOnlyWhereItIsOne) {
  EXPECT_EQ(DateText(kDateNs / 1000, {"us", 1000}), " (the first, 1403715273262142, is then a date of 2014)");
  EXPECT_EQ(DateText(0, {"us", 1000}), "");
  EXPECT_EQ(DateText(kDateNs / 1000, {"ms", 1'000'000}), "");
}

/// IMU at 100 Hz and images at 10 Hz, with truth, each in units of its own, and sheets without rates.
Dataset InUnits(TimeNs imu_ns, TimeNs camera_ns, TimeNs truth_ns) {
  Dataset dataset = test::Healthy();
  dataset.imu_rate_hz = 0;
  dataset.camera_rate_hz = 0;
  for (ImuSample& sample : dataset.imu) {
    sample.stamp_ns /= imu_ns;
  }
  for (TrackFrame& frame : dataset.frames) {
    frame.stamp_ns /= camera_ns;
  }
  for (TrajectoryPoint& point : dataset.truth->points) {
    point.stamp_ns /= truth_ns;
  }
  return dataset;
}

/// Errors and warnings, one a line.
std::string Complaints(const Dataset& dataset) {
  return test::Complaints(dataset, Severity::kError) + test::Complaints(dataset, Severity::kWarning);
}

TEST(StampUnit, GivenNanosecondsThenNothingIsSaid) {
  EXPECT_EQ(Complaints(InUnits(1, 1, 1)), "");
}

TEST(StampUnit, GivenAllStreamsInMicrosecondsThenEachIsAnErrorWithTheUnitAndTheFactor) {
  const std::string text = test::Complaints(InUnits(1000, 1000, 1000), Severity::kError);
  EXPECT_THAT(text, HasSubstr("imu0: the stamps as nanoseconds give 1e+05 Hz, expected at most 1e+04 "
                              "Hz: they seem to be in us, which gives 100 Hz"));
  EXPECT_THAT(text, HasSubstr("is then a date of 2017); expected ns, multiply them by 1000\n"));
  EXPECT_THAT(text, HasSubstr("cam0: the stamps as nanoseconds"));
  EXPECT_THAT(text, Not(HasSubstr("shares no time")));
}

TEST(StampUnit, GivenTheImuAloneInMillisecondsThenItAloneIsNamed) {
  const std::string text = Complaints(InUnits(1'000'000, 1, 1));
  EXPECT_THAT(text, AllOf(HasSubstr("imu0: "), HasSubstr("in ms"), HasSubstr("by 1000000")));
  EXPECT_THAT(text, Not(HasSubstr("cam0")));
  EXPECT_THAT(text, Not(HasSubstr("truth")));
  EXPECT_THAT(text, Not(HasSubstr("a rate of")));
}

// Leap seconds are known of a date, which stamps in microseconds are not.
TEST(StampUnit, GivenTheImuInMicrosecondsThenNoOffsetIsComparedWithItsTime) {
  Dataset dataset = InUnits(1000, 1, 1);
  dataset.rig.fixes = {{Eigen::Vector3d::Zero(), -18, std::nullopt}};
  EXPECT_THAT(Complaints(dataset), Not(HasSubstr("time_offset_s")));
}

TEST(StampUnit, GivenTheCameraAloneInMicrosecondsThenItAloneIsNamed) {
  const std::string text = Complaints(InUnits(1, 1000, 1));
  EXPECT_THAT(text, AllOf(HasSubstr("cam0: "), HasSubstr("in us"), Not(HasSubstr("imu0: the"))));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
}

// 2 Hz are too few to find the unit by the rate.
TEST(StampUnit, GivenASlowCameraInMicrosecondsThenTheClocksRevealTheUnitAndItsRateIsNotDoubted) {
  Dataset dataset = InUnits(1, 1000, 1);
  std::vector<TrackFrame> frames;
  for (std::size_t i = 0; i < dataset.frames.size(); i += 5) {
    frames.push_back(dataset.frames[i]);
  }
  dataset.frames = frames;
  EXPECT_EQ(Complaints(dataset),
            "cam0: shares no time with imu0: its stamps seem to be in us, expected ns, multiply them by "
            "1000\n");
}

TEST(StampUnit, GivenTheTruthAloneInMillisecondsThenTheClocksRevealTheUnit) {
  const Dataset dataset = InUnits(1, 1, 1'000'000);
  EXPECT_EQ(test::Complaints(dataset, Severity::kError),
            "truth: shares no time with imu0: its stamps seem to be in ms, expected ns, multiply them by "
            "1000000\n");
  EXPECT_EQ(test::Complaints(dataset, Severity::kWarning), "");
}

}  // namespace
}  // namespace alidade
