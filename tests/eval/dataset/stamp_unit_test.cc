#include "eval/dataset/stamp_unit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/dataset/dataset_check.h"

namespace alidade {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr TimeNs kDateNs = 1'403'715'273'262'142'976;  // June 2014

/// Unit of stamps of this rate that begin at `first_ns`, written in units of `unit_ns`; "ns" when none is
/// named.
std::string UnitOf(double rate_hz, TimeNs first_ns, TimeNs unit_ns, double stated_hz,
                   const RateRange& range) {
  constexpr int kStamps = 101;
  const TimeNs last_ns = first_ns + SecondsToNs((kStamps - 1) / rate_hz);
  const StampUnit* unit = OtherStampUnit(first_ns / unit_ns, last_ns / unit_ns, kStamps, stated_hz, range);
  return unit == nullptr ? "ns" : unit->name;
}

TEST(StampUnit, RatesAtTheEdgesAreTakenAsTheyAre) {
  for (const TimeNs first_ns : {TimeNs{0}, 1000 * kSecondNs, kDateNs}) {
    EXPECT_EQ(UnitOf(20, first_ns, 1, 0, kImuRates), "ns");
    EXPECT_EQ(UnitOf(9900, first_ns, 1, 0, kImuRates), "ns");
    EXPECT_EQ(UnitOf(0.9, first_ns, 1, 0, kCameraRates), "ns");
    EXPECT_EQ(UnitOf(490, first_ns, 1, 0, kCameraRates), "ns");
  }
}

TEST(StampUnit, MicrosecondsAndMillisecondsAreToldByTheRateWhereverTheStampsBegin) {
  for (const TimeNs first_ns : {TimeNs{0}, 1000 * kSecondNs, kDateNs}) {
    for (const double rate_hz : {25.0, 200.0, 1000.0}) {
      EXPECT_EQ(UnitOf(rate_hz, first_ns, 1000, 0, kImuRates), "us") << rate_hz;
      EXPECT_EQ(UnitOf(rate_hz, first_ns, 1'000'000, 0, kImuRates), "ms") << rate_hz;
    }
    EXPECT_EQ(UnitOf(20, first_ns, 1000, 0, kCameraRates), "us");
    EXPECT_EQ(UnitOf(20, first_ns, 1'000'000, 0, kCameraRates), "ms");
  }
}

// A camera of less than 1 Hz: in range of no unit, but the sheet knows.
TEST(StampUnit, TheRateOfTheSheetDecidesWhereTheRangeCannot) {
  EXPECT_EQ(UnitOf(0.9, kDateNs, 1000, 0, kCameraRates), "ns");
  EXPECT_EQ(UnitOf(0.9, kDateNs, 1000, 0.91, kCameraRates), "us");
}

TEST(StampUnit, AFewStampsAreNoRate) {
  EXPECT_EQ(OtherStampUnit(1000, 3000, 3, 200, kImuRates), nullptr);
}

TEST(StampUnit, ADateIsToldOnlyWhereItIsOne) {
  EXPECT_EQ(DateText(kDateNs / 1000, {"us", 1000}), " (the first, 1403715273262142, is then a date of 2014)");
  EXPECT_EQ(DateText(0, {"us", 1000}), "");
  EXPECT_EQ(DateText(kDateNs / 1000, {"ms", 1'000'000}), "");
}

/// Twenty seconds of IMU at 100 Hz and images at 10 Hz, with truth, each in units of its own.
Dataset InUnits(TimeNs imu_ns, TimeNs camera_ns, TimeNs truth_ns) {
  Dataset dataset;
  dataset.rig.camera =
      CameraModel::Create(DistortionModel::kNone, Eigen::Vector4d(400, 400, 320, 240), {}, 640, 480).value();
  Trajectory truth;
  for (int i = 0; i <= 2000; ++i) {
    const TimeNs stamp = kDateNs + i * (kSecondNs / 100);
    const double noise = 1e-4 * (i % 7);
    dataset.imu.push_back({stamp / imu_ns, Eigen::Vector3d(1e-4 * i, noise, noise),
                           Eigen::Vector3d(noise, noise, 9.8 + noise)});
    TrajectoryPoint point;
    point.stamp_ns = stamp / truth_ns;
    truth.points.push_back(point);
    if (i % 10 == 0) {
      dataset.frames.push_back({stamp / camera_ns, {{1, Eigen::Vector2d(50, 5)}}, 0});
    }
  }
  dataset.truth = truth;
  return dataset;
}

/// Errors and warnings, one a line.
std::string Complaints(const Dataset& dataset) {
  std::string text;
  for (const DatasetFinding& finding : CheckDataset(dataset)) {
    if (finding.severity != DatasetFinding::Severity::kFact) {
      text += (finding.severity == DatasetFinding::Severity::kError ? "error " : "warning ") + finding.text +
              "\n";
    }
  }
  return text;
}

TEST(StampUnit, GivenNanosecondsThenNothingIsSaid) {
  EXPECT_EQ(Complaints(InUnits(1, 1, 1)), "");
}

TEST(StampUnit, GivenAllStreamsInMicrosecondsThenEachIsAnErrorWithTheUnitAndTheFactor) {
  const std::string text = Complaints(InUnits(1000, 1000, 1000));
  EXPECT_THAT(text, HasSubstr("error imu0: the stamps as nanoseconds give 1e+05 Hz, expected at most 1e+04 "
                              "Hz: they seem to be in us, which gives 100 Hz"));
  EXPECT_THAT(text, HasSubstr("is then a date of 2014); expected ns, multiply them by 1000\n"));
  EXPECT_THAT(text, HasSubstr("error cam0: the stamps as nanoseconds"));
  EXPECT_THAT(text, Not(HasSubstr("shares no time")));
}

TEST(StampUnit, GivenTheImuAloneInMillisecondsThenItAloneIsNamed) {
  const std::string text = Complaints(InUnits(1'000'000, 1, 1));
  EXPECT_THAT(text, AllOf(HasSubstr("error imu0: "), HasSubstr("in ms"), HasSubstr("by 1000000")));
  EXPECT_THAT(text, Not(HasSubstr("cam0")));
  EXPECT_THAT(text, Not(HasSubstr("truth")));
}

TEST(StampUnit, GivenTheCameraAloneInMicrosecondsThenItAloneIsNamed) {
  const std::string text = Complaints(InUnits(1, 1000, 1));
  EXPECT_THAT(text, AllOf(HasSubstr("error cam0: "), HasSubstr("in us"), Not(HasSubstr("imu0: the"))));
}

TEST(StampUnit, GivenTheTruthAloneInMillisecondsThenTheClocksTellTheUnit) {
  EXPECT_EQ(
      Complaints(InUnits(1, 1, 1'000'000)),
      "error truth: shares no time with imu0: its stamps seem to be in ms, expected ns, multiply them by "
      "1000000\n");
}

}  // namespace
}  // namespace alidade
