#include "eval/dataset/dataset_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/dataset_writer.h"
#include "tests/eval/dataset/healthy_dataset.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::Complaints;
using test::Healthy;
using test::WithGnss;
using testing::HasSubstr;
using Severity = DatasetFinding::Severity;

TEST(DatasetCheck, GivenAHealthySequenceThenItStatesFactsAndComplainsOfNothing) {
  EXPECT_EQ(Complaints(Healthy(), Severity::kError), "");
  EXPECT_EQ(Complaints(Healthy(), Severity::kWarning), "");
  const std::string facts = Complaints(Healthy(), Severity::kFact);
  EXPECT_THAT(facts, HasSubstr("imu0: 1001 stamps over 10.000 s"));
  EXPECT_THAT(facts, HasSubstr("mean rate 100.00 Hz"));
  EXPECT_THAT(facts, HasSubstr("202 observations of 2 tracks, 2.0 a frame, mean length 101.00"));
  EXPECT_THAT(facts, HasSubstr("truth: covers 100.0 %"));
}

TEST(DatasetCheck, GivenARollingShutterThenTheReadoutTimeIsStated) {
  Dataset rolling = Healthy();
  rolling.rig.line_delay_s = -3e-5;
  EXPECT_THAT(Complaints(rolling, Severity::kFact), HasSubstr("exposed over 14.4 ms"));
}

TEST(DatasetCheck, GivenWrongUnitsThenTheyAreErrors) {
  Dataset in_g = Healthy();
  Dataset in_mg = Healthy();
  Dataset in_degrees = Healthy();
  for (size_t i = 0; i < in_g.imu.size(); ++i) {
    in_g.imu[i].accel /= 9.80665;
    in_mg.imu[i].accel *= 1000 / 9.80665;
    in_degrees.imu[i].gyro *= 180 / 3.14159 * 3;
  }
  EXPECT_THAT(Complaints(in_g, Severity::kError), HasSubstr("in g, expected m/s^2"));
  EXPECT_THAT(Complaints(in_mg, Severity::kError), HasSubstr("in mg, expected m/s^2"));
  EXPECT_THAT(Complaints(in_degrees, Severity::kError), HasSubstr("in deg/s, expected rad/s"));
}

/// At rest for half of the time, then turning at `rate` [rad/s]; the rates are written times `factor`.
std::string GyroErrors(double rate, double factor) {
  Dataset dataset = Healthy();
  for (size_t i = 0; i < dataset.imu.size(); ++i) {
    const double turn = i < 500 ? 0 : rate;
    dataset.imu[i].gyro = factor * (Eigen::Vector3d(0.01, 0, turn) + 1e-3 * Eigen::Vector3d::Random());
  }
  return Complaints(dataset, Severity::kError);
}

TEST(DatasetCheck, GivenAGyroscopeInAnyOfItsUnitsThenThatUnitIsNamed) {
  constexpr double kDegrees = 180 / 3.14159265;
  EXPECT_EQ(GyroErrors(1.2, 1), "");
  EXPECT_THAT(GyroErrors(1.2, kDegrees), HasSubstr("seems to be in deg/s, expected rad/s"));
  EXPECT_THAT(GyroErrors(3, 1e3), HasSubstr("seems to be in mrad/s, expected rad/s"));
  EXPECT_THAT(GyroErrors(3, 1e3 * kDegrees), HasSubstr("seems to be in mdeg/s, expected rad/s"));
  // 0.4 rad/s as mrad/s are also 7 rad/s in deg/s.
  EXPECT_THAT(GyroErrors(0.4, 1e3), HasSubstr("seems to be in deg/s or mrad/s, expected rad/s"));
  EXPECT_THAT(GyroErrors(3, 1e7), HasSubstr("none of deg/s, mrad/s and mdeg/s explains it"));
}

TEST(DatasetCheck, GivenExchangedGroupsOfColumnsThenTheyAreNamedAndNoUnit) {
  Dataset dataset = Healthy();
  for (ImuSample& sample : dataset.imu) {
    std::swap(sample.gyro, sample.accel);
  }
  const std::string errors = Complaints(dataset, Severity::kError);
  EXPECT_THAT(errors, HasSubstr("the two groups of columns seem to be exchanged"));
  EXPECT_THAT(errors, testing::Not(HasSubstr("seems to be in")));
}

TEST(DatasetCheck, GivenADeadAxisOfTheAccelerometerThenItIsNamedInsteadOfTheUnit) {
  Dataset dataset = Healthy();
  for (ImuSample& sample : dataset.imu) {
    sample.accel.x() += 1;  // as of an accelerometer in g
    sample.accel.z() = 0;
  }
  const std::string errors = Complaints(dataset, Severity::kError);
  EXPECT_THAT(errors, HasSubstr("accelerometer z is 0 in all samples, a dead axis?"));
  EXPECT_THAT(errors, testing::Not(HasSubstr("unit")));
  EXPECT_THAT(errors, testing::Not(HasSubstr("in g")));
}

TEST(DatasetCheck, GivenAnAxisThatNeverChangesThenItIsNamed) {
  Dataset dataset = Healthy();
  for (ImuSample& sample : dataset.imu) {
    sample.gyro.z() = 0;
  }
  EXPECT_EQ(Complaints(dataset, Severity::kWarning), "imu0: gyroscope z is 0 in all samples: a dead axis?\n");
}

TEST(DatasetCheck, GivenAGapThenItsLengthAndPlaceAreNamed) {
  Dataset dataset = Healthy();
  dataset.imu.erase(dataset.imu.begin() + 500, dataset.imu.begin() + 550);
  const std::string warnings = Complaints(dataset, Severity::kWarning);
  EXPECT_THAT(warnings, HasSubstr("imu0: 1 gaps"));
  EXPECT_THAT(warnings, HasSubstr("0.510 s after 1500000004990000000 ns"));
}

TEST(DatasetCheck, GivenRepeatedRowsThenTheirShareIsNamed) {
  Dataset dataset = Healthy();
  for (size_t i = 1; i < dataset.imu.size(); i += 2) {
    dataset.imu[i].gyro = dataset.imu[i - 1].gyro;
    dataset.imu[i].accel = dataset.imu[i - 1].accel;
  }
  EXPECT_THAT(Complaints(dataset, Severity::kWarning), HasSubstr("500 rows (50.0 %) repeat"));
}

TEST(DatasetCheck, GivenAnotherClockThenTheSensorsShareNoTime) {
  Dataset dataset = Healthy();
  for (TrackFrame& frame : dataset.frames) {
    frame.stamp_ns -= 1'400'000'000'000'000'000;
  }
  EXPECT_THAT(Complaints(dataset, Severity::kError),
              HasSubstr("cam0: shares no time with imu0: another clock?"));
}

TEST(DatasetCheck, GivenNormalisedTracksThenTheyAreNamed) {
  Dataset dataset = Healthy();
  for (TrackFrame& frame : dataset.frames) {
    for (TrackObservation& observation : frame.observations) {
      observation.pixel = (observation.pixel - Eigen::Vector2d(320, 240)) / 400;
    }
  }
  const std::string errors = Complaints(dataset, Severity::kError);
  EXPECT_THAT(errors, HasSubstr("within +-0.79, the image has 640 x 480 px: they seem to be normalised"));
  EXPECT_THAT(errors, testing::Not(HasSubstr("resolution")));
}

TEST(DatasetCheck, GivenPixelsOutsideTheImageThenTheResolutionIsDoubted) {
  Dataset dataset = Healthy();
  for (TrackFrame& frame : dataset.frames) {
    frame.observations[1].pixel.x() += 200;
  }
  EXPECT_THAT(Complaints(dataset, Severity::kError), HasSubstr("101 observations are outside 640 x 480 px"));
}

TEST(DatasetCheck, GivenATrackThatComesBackThenItIsNamed) {
  Dataset dataset = Healthy();
  dataset.frames[50].observations.pop_back();
  EXPECT_THAT(Complaints(dataset, Severity::kWarning),
              HasSubstr("1 times a track is missing in some frames"));
}

TEST(DatasetCheck, GivenTruthOfHalfTheFlightThenItsCoverageIsWarnedOf) {
  Dataset dataset = Healthy();
  dataset.truth->points.resize(400);
  EXPECT_THAT(Complaints(dataset, Severity::kWarning), HasSubstr("covers only 39.9 %"));
}

TEST(DatasetCheck, GivenTheRealTumViRoomThenItsTruthGapsAreFound) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const Result<Dataset> dataset = ReadDataset(test::SharedDir() + "/data/tumvi/room3");
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  EXPECT_THAT(Complaints(*dataset, Severity::kWarning), HasSubstr("the longest is 1.99"));
}

TEST(DatasetCheck, GivenAnImuThatEndsHalfwayThenBothSpansAndTheSecondsWithoutAreReported) {
  Dataset dataset = Healthy();
  dataset.imu.resize(501);
  EXPECT_THAT(Complaints(dataset, Severity::kWarning),
              HasSubstr("cam0: from 1500000000.000000000 to 1500000010.000000000 s, imu0 from "
                        "1500000000.000000000 to 1500000005.000000000 s: 5.000 s of cam0 are without IMU"));
  // Recorders that stop a second apart, and an IMU that goes on, are usual.
  dataset = Healthy();
  dataset.imu.resize(901);
  EXPECT_EQ(Complaints(dataset, Severity::kWarning), "");
  dataset = Healthy();
  dataset.frames.resize(50);
  EXPECT_EQ(Complaints(dataset, Severity::kWarning), "");
}

TEST(DatasetCheck, GivenFixesOfHalfTheFlightThenTheSecondsWithoutThemAreReported) {
  Dataset dataset = Healthy();
  dataset.rig.fixes.emplace_back();
  for (int i = 0; i <= 5; ++i) {
    PositionFix fix;
    fix.stamp_ns = dataset.imu.front().stamp_ns + i * kSecondNs;
    fix.covariance = Eigen::Matrix3d::Identity();
    dataset.fixes.push_back(fix);
  }
  EXPECT_THAT(Complaints(dataset, Severity::kWarning),
              HasSubstr("5.000 s of the IMU's time are without fix0"));
}

TEST(DatasetCheck, GivenGnssThenItsSpanAndEphemeridesAreNoComplaint) {
  EXPECT_EQ(Complaints(WithGnss(0, 0), Severity::kError), "");
  EXPECT_EQ(Complaints(WithGnss(0, 0), Severity::kWarning), "");
  EXPECT_THAT(Complaints(WithGnss(0, 0), Severity::kFact), HasSubstr("gnss0: starts +0.000 s"));
}

TEST(DatasetCheck, GivenGnssOfPartOfTheFlightThenTheSecondsWithoutItAreReported) {
  Dataset half = WithGnss(0, 0);
  auto log = std::make_shared<GnssLog>(*half.gnss);
  log->epochs.resize(5);
  half.gnss = log;
  EXPECT_THAT(Complaints(half, Severity::kWarning), HasSubstr("6.000 s of the IMU's time are without gnss0"));
  Dataset longer = WithGnss(0, 0);
  longer.imu.resize(501);
  EXPECT_THAT(Complaints(longer, Severity::kWarning), HasSubstr("4.000 s of gnss0 are without IMU"));
}

TEST(DatasetCheck, GivenEphemeridesADayOldThenItWarnsThatNoEpochCanBeUsed) {
  const std::string warnings = Complaints(WithGnss(0, -86400), Severity::kWarning);
  EXPECT_THAT(warnings, HasSubstr("gnss0: 8 of 8 sampled epochs have no satellite that can be used"));
  EXPECT_THAT(warnings, HasSubstr("the nearest ephemeris is 24.2 h away"));
}

TEST(DatasetRead, GivenTagsThatAreNotGpstThenItIsRefusedWithTheOffset) {
  const test::TemporaryFolder folder;
  const double rollover_s = 1024 * 604800.0;
  for (const auto& [tags_s, expected] :
       {std::pair(-18.0, "need +18 s"), std::pair(-rollover_s, "need +1024 weeks")}) {
    const std::string path = folder.File(expected);
    ASSERT_TRUE(WriteDataset(WithGnss(tags_s, 0), path).ok());
    const Result<Dataset> read = ReadDataset(path);
    EXPECT_EQ(read.code(), StatusCode::kInput);
    EXPECT_THAT(read.message(), testing::AllOf(HasSubstr("obs.rnx"), HasSubstr(expected)));
  }
  ASSERT_TRUE(WriteDataset(WithGnss(0, 0), folder.File("sound")).ok());
  EXPECT_TRUE(ReadDataset(folder.File("sound")).ok());
}

}  // namespace
}  // namespace alidade
