#include "eval/dataset/gnss_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/lie.h"
#include "tests/eval/dataset/healthy_dataset.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using test::Complaints;
using testing::HasSubstr;
using testing::Not;

constexpr TimeNs kStart = 1'500'000'000'000'000'000;  // 2017: 18 leap seconds
constexpr double kDurationS = 150;

/// Course [rad] of a drive whose bends do not repeat.
double Course(double t) {
  return 1.3 * std::sin(0.31 * t) + 0.9 * std::sin(0.47 * t + 1) + 0.6 * std::sin(0.83 * t + 2);
}

double CourseRate(double t) {
  return 0.403 * std::cos(0.31 * t) + 0.423 * std::cos(0.47 * t + 1) + 0.498 * std::cos(0.83 * t + 2);
}

/// IMU at 100 Hz on a car at 5 m/s, tilted in its mount, with a bias; `turns`: whether the body turns with
/// the course.
std::vector<ImuSample> Imu(bool turns) {
  const Eigen::Matrix3d R_BV = so3::Exp(Vector3d(0.7, -0.4, 0.2));  // vehicle, z up, to body
  std::vector<ImuSample> imu;
  for (int i = 0; i <= 100 * static_cast<int>(kDurationS); ++i) {
    const double rate = CourseRate(0.01 * i);
    const double turn = turns ? rate : 0.01 * std::sin(0.2 * i);
    imu.push_back({kStart + i * TimeNs{10'000'000},
                   R_BV * Vector3d(0, 0, turn) + Vector3d(0.01, -0.02, 0.005),
                   R_BV * Vector3d(0, turns ? 5 * rate : 0, 9.81)});
  }
  return imu;
}

/// Once a second, with tags that are late.
std::vector<CourseChange> Courses(double late_s) {
  std::vector<CourseChange> courses;
  for (int i = 0; i + 1 < static_cast<int>(kDurationS); ++i) {
    const TimeNs first_ns = kStart + i * kSecondNs + SecondsToNs(late_s);
    courses.push_back({first_ns, first_ns + kSecondNs, Course(i + 1) - Course(i)});
  }
  return courses;
}

VerticalTurns TurnsOf(const std::vector<ImuSample>& imu) {
  return VerticalTurns::Of(Table<ImuSample>(imu)).value();
}

TEST(GnssMotion, TheTurnAboutTheVerticalNeedsNoAttitude) {
  const std::vector<ImuSample> imu = Imu(true);
  const VerticalTurns turns = TurnsOf(imu);
  // The specific force in bends draws the vertical a little, and the gyroscope has a bias of 0.005 about it.
  EXPECT_NEAR(turns.Between(kStart + 20 * kSecondNs, kStart + 21 * kSecondNs).value(),
              Course(21) - Course(20), 0.05);
  EXPECT_FALSE(turns.Between(kStart - kSecondNs, kStart)) << "before the IMU began";
  const CourseAgreement agreement = turns.Compare(Courses(0), 0);
  EXPECT_EQ(agreement.pairs, static_cast<int>(kDurationS) - 1);
  EXPECT_GT(agreement.correlation, 0.95);
  EXPECT_NEAR(agreement.slope, 1, 0.05);
}

// GIVEN a receiver whose tags are late or early by a known difference WHEN its courses are compared THEN it
// is found; GIVEN tags that are right, or a body that does not turn with its course, THEN nothing is.
TEST(GnssMotion, AKnownDifferenceOfClocksIsFoundByTheBends) {
  const std::vector<ImuSample> imu = Imu(true);
  const VerticalTurns turns = TurnsOf(imu);
  for (const double late_s : {18.0, -18.0, 19.0}) {
    const std::optional<CourseShift> found = ShiftByCourse(Courses(late_s), turns, 0);
    ASSERT_TRUE(found) << late_s;
    EXPECT_EQ(found->shift.shift_ns, SecondsToNs(-late_s));
    EXPECT_FALSE(ShiftByCourse(Courses(late_s), turns, SecondsToNs(-late_s)))
        << "the sheet's offset mends it";
  }
  EXPECT_FALSE(ShiftByCourse(Courses(0), turns, 0));
  EXPECT_FALSE(ShiftByCourse(Courses(0.3), turns, 0)) << "small offsets are the estimator's";
  const std::vector<ImuSample> steady = Imu(false);
  EXPECT_FALSE(ShiftByCourse(Courses(18), TurnsOf(steady), 0));
  std::vector<CourseChange> few = Courses(18);
  few.resize(20);
  EXPECT_FALSE(ShiftByCourse(few, turns, 0)) << "too few";
}

/// Epochs once a second along the drive, with tags that are late.
std::shared_ptr<GnssLog> Log(double late_s) {
  auto log = std::make_shared<GnssLog>();
  const NavigationData sky = test::SyntheticSky(kStart);
  test::SyntheticReceiver receiver;
  const EnuFrame enu = EnuFrame::At(receiver.position_E);
  for (int i = 0; i < static_cast<int>(kDurationS); ++i) {
    receiver.stamp_ns = kStart + i * kSecondNs;
    receiver.velocity_E = enu.R_EN * (5 * Vector3d(std::cos(Course(i)), std::sin(Course(i)), 0));
    log->epochs.push_back(test::Observe(sky, receiver));
    receiver.position_E += receiver.velocity_E;
  }
  log->catalog = std::make_shared<SatelliteCatalog>(sky);
  for (ObservationEpoch& epoch : log->epochs) {
    epoch.stamp_ns += SecondsToNs(late_s);
  }
  return log;
}

TEST(GnssMotion, CoursesAreThoseOfTheDopplerVelocities) {
  const std::vector<CourseChange> changes = CourseChanges(*Log(0));
  ASSERT_EQ(changes.size(), static_cast<std::size_t>(kDurationS) - 1);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const auto t = static_cast<double>(i);
    EXPECT_NEAR(changes[i].turn_rad, Course(t + 1) - Course(t), 5e-3);
  }
}

TEST(GnssMotion, CheckNamesLeapSecondsWithinALongRun) {
  Dataset dataset;
  dataset.imu = Imu(true);
  dataset.gnss = Log(0);
  EXPECT_THAT(Complaints(dataset, DatasetFinding::Severity::kWarning), Not(HasSubstr("another clock?")));
  // The IMU in UTC, the receiver in GPST, and the receiver switched on later, so that the spans are no hint.
  for (ImuSample& sample : dataset.imu) {
    sample.stamp_ns -= 18 * kSecondNs;
  }
  auto late = std::make_shared<GnssLog>(*dataset.gnss);
  late->epochs.erase(late->epochs.begin(), late->epochs.begin() + 30);
  dataset.gnss = late;
  EXPECT_THAT(Complaints(dataset, DatasetFinding::Severity::kWarning),
              testing::AllOf(HasSubstr("gnss0: time_offset_s: courses of the Doppler velocities follow the "
                                       "gyroscope with -18 s (the leap seconds between UTC and GPST) added"),
                             Not(HasSubstr("expected about 0"))));
}

}  // namespace
}  // namespace alidade
