#include "eval/run/degradation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace alidade {
namespace {

using testing::HasSubstr;

TrackFrame Frame(double stamp_s, int tracks, double shift_px) {
  TrackFrame frame{SecondsToNs(stamp_s), {}};
  for (int i = 0; i < tracks; ++i) {
    frame.observations.push_back({i, {10.0 * i + shift_px, 20}});
  }
  return frame;
}

FrameStatistics Saw(int tracks) {
  FrameStatistics statistics;
  statistics.tracks_in = tracks;
  return statistics;
}

TEST(DegradationTest, AnImageThatMovesIsNotFrozenAndOneThatRepeatsItselfIs) {
  Degradation degradation;
  EXPECT_FALSE(degradation.IsFrozen(Frame(0, 20, 0)));
  EXPECT_FALSE(degradation.IsFrozen(Frame(0.05, 20, 1e-9)));
  EXPECT_TRUE(degradation.IsFrozen(Frame(0.1, 20, 1e-9)));
  EXPECT_THAT(degradation.Check(SecondsToNs(0.1), Saw(0)).reason, HasSubstr("did not change"));
  EXPECT_TRUE(degradation.IsFrozen(Frame(0.15, 20, 1e-9)));
  EXPECT_FALSE(degradation.IsFrozen(Frame(0.2, 20, 3)));
  EXPECT_EQ(degradation.Check(SecondsToNs(0.2), Saw(20)).reason, "");
}

TEST(DegradationTest, FewEqualPixelsMayBeChance) {
  Degradation degradation;
  EXPECT_FALSE(degradation.IsFrozen(Frame(0, 7, 0)));
  EXPECT_FALSE(degradation.IsFrozen(Frame(0.05, 7, 0)));
}

TEST(DegradationTest, WithoutTracksItIsReportedWithinAFifthOfASecondAndTakenBackWithTheNextTracks) {
  Degradation degradation;
  double reported_s = 0;
  for (int k = 0; k < 20; ++k) {
    const double t = 0.05 * k;
    const bool blind = k >= 5 && k < 15;
    static_cast<void>(degradation.IsFrozen(Frame(t, blind ? 0 : 20, t)));
    const bool degraded = !degradation.Check(SecondsToNs(t), Saw(blind ? 0 : 20)).reason.empty();
    reported_s = degraded && reported_s == 0 ? t : reported_s;
    EXPECT_TRUE(blind || !degraded) << t;
  }
  EXPECT_GT(reported_s, 0.25);
  EXPECT_LE(reported_s, 0.4);
}

TEST(DegradationTest, ASilentImuIsReportedUntilTheEstimateHasSettled) {
  Degradation degradation;
  for (int k = 0; k < 200; ++k) {
    if (k < 100 || k >= 140) {  // 0.2 s
      degradation.OnImu(SecondsToNs(k / 200.0));
    }
  }
  static_cast<void>(degradation.IsFrozen(Frame(0.6, 20, 0)));
  EXPECT_THAT(degradation.Check(SecondsToNs(0.6), Saw(20)).reason, HasSubstr("silent for 0.21 s"));
  EXPECT_NE(degradation.Check(SecondsToNs(1.1), Saw(20)).reason, "");
  EXPECT_EQ(degradation.Check(SecondsToNs(1.3), Saw(20)).reason, "");
}

TEST(DegradationTest, AnAxisThatDoesNotMeasureIsReportedUntilTheEstimateHasSettled) {
  Degradation degradation;
  for (int k = 0; k < 150; ++k) {
    const TimeNs stamp_ns = k * (kSecondNs / 100);
    degradation.OnImu(stamp_ns, k >= 40 && k < 60 ? "the gyroscope's x axis repeats" : "");
    const bool reported = k >= 40 && k < 109;
    EXPECT_EQ(degradation.Check(stamp_ns, Saw(20)).reason, reported ? "the gyroscope's x axis repeats" : "")
        << k;
  }
}

TEST(DegradationTest, AChangeOfUnitIsReportedUntilTheEstimateHasSettled) {
  Degradation degradation;
  degradation.OnImu(SecondsToNs(1), "", SecondsToNs(1));
  EXPECT_THAT(degradation.Check(SecondsToNs(1.4), Saw(20)).reason, HasSubstr("changed its unit"));
  EXPECT_EQ(degradation.Check(SecondsToNs(1.6), Saw(20)).reason, "");
}

FrameStatistics Weighed(double nis, int dof) {
  FrameStatistics statistics = Saw(20);
  statistics.nis = nis;
  statistics.nis_dof = dof;
  return statistics;
}

/// Seconds of 60, at 10 Hz, in which innovations drawn with `variance`, `dof` a frame, are reported.
double SecondsReported(double variance, int dof) {
  Degradation degradation;
  RandomStream random(5, "innovations");
  int reported = 0;
  for (int k = 0; k < 600; ++k) {
    double nis = 0;
    for (int i = 0; i < dof; ++i) {
      nis += variance * std::pow(random.Normal(), 2);
    }
    reported += degradation.Check(SecondsToNs(0.1 * k), Weighed(nis, dof)).reason.empty() ? 0 : 1;
  }
  return 0.1 * reported;
}

TEST(DegradationTest, InnovationsThatAreLargerThanPredictedForLongAreReported) {
  EXPECT_EQ(SecondsReported(1.0, 200), 0);
  EXPECT_EQ(SecondsReported(1.0, 4), 0);
  EXPECT_EQ(SecondsReported(0.1, 200), 0);  // a cautious noise is no fault
  EXPECT_GT(SecondsReported(1.3, 200), 55);
  EXPECT_GT(SecondsReported(2.0, 4), 45);
}

TEST(DegradationTest, ACameraThatIsNotAsGivenIsReportedOnceItMovesThePose) {
  const auto check = [](double sigmas, double pose_sigmas) {
    const CalibrationDoubt doubt{"the focal length of the camera", "px", sigmas, -2.3, pose_sigmas};
    return Degradation().Check(SecondsToNs(1), Saw(20), &doubt).reason;
  };
  EXPECT_EQ(check(4.9, 30), "") << "chance";
  EXPECT_EQ(check(30, 1.9), "") << "harmless";
  EXPECT_THAT(check(5.1, 2.1), HasSubstr("the focal length of the camera is not as given: off by -2.3 px"));
}

TEST(DegradationTest, LargeInnovationsNameTheLikelyCause) {
  const auto check = [](const CalibrationDoubt* doubt) {
    Degradation degradation;
    std::string reason;
    for (int k = 0; k < 100; ++k) {
      reason = degradation.Check(SecondsToNs(0.1 * k), Weighed(400, 200), doubt).reason;
    }
    return reason;
  };
  const CalibrationDoubt doubt{"the time offset of the camera", "ms", 8, 5, 0.1};
  const CalibrationDoubt none;
  EXPECT_THAT(check(nullptr), HasSubstr("noise, extrinsics, lens or time offset are not as given"));
  EXPECT_THAT(check(&doubt), HasSubstr("the time offset of the camera is not as given (8.0 sigma)"));
  EXPECT_THAT(check(&none), HasSubstr("the noise of pixels or IMU is larger than given"));
}

// GIVEN innovations that are too large WHEN the tracks end THEN the kind follows: the model, then the data.
TEST(DegradationTest, MissingDataAndADoubtedModelAreDistinguished) {
  Degradation degradation;
  for (int k = 0; k < 100; ++k) {
    static_cast<void>(degradation.Check(SecondsToNs(0.1 * k), Weighed(400, 200)));
  }
  const Degradation::Verdict large = degradation.Check(SecondsToNs(10), Weighed(400, 200));
  EXPECT_THAT(large.reason, HasSubstr("as large as predicted"));
  EXPECT_EQ(large.kind, DegradationKind::kModel);
  const Degradation::Verdict blind = degradation.Check(SecondsToNs(10.2), Saw(0));
  EXPECT_THAT(blind.reason, HasSubstr("no tracks"));
  EXPECT_EQ(blind.kind, DegradationKind::kData);
  const CalibrationDoubt doubt{"the focal length of the camera", "px", 9, -2.3, 9};
  EXPECT_EQ(Degradation().Check(SecondsToNs(1), Saw(20), &doubt).kind, DegradationKind::kModel);
}

TEST(DegradationTest, OneFrameOfLargeInnovationsIsForgotten) {
  Degradation degradation;
  int reported = 0;
  for (int k = 0; k < 600; ++k) {
    reported +=
        degradation.Check(SecondsToNs(0.1 * k), Weighed(k == 100 ? 2000 : 190, 200)).reason.empty() ? 0 : 1;
  }
  EXPECT_LT(reported, 20);
}

/// A measured position that is `off_m` away, known to 0.1 m, beside an estimate that it does not move.
AbsoluteComparison Beside(double second, double off_m) {
  AbsoluteComparison comparison;
  comparison.stamp_ns = SecondsToNs(second);
  comparison.change_covariance = 1e-4 * Eigen::Matrix3d::Identity();
  comparison.left = Eigen::Vector3d(off_m, 0, 0);
  comparison.left_covariance = 0.01 * Eigen::Matrix3d::Identity();
  return comparison;
}

// GIVEN a sensor that is pulled away and a faster one that is not, THEN the first is reported, by its name.
TEST(DegradationTest, AGoodSensorDoesNotHideABadOne) {
  Degradation degradation;
  for (int i = 0; i < 100; ++i) {
    if (i % 5 == 0) {
      degradation.OnAbsolute(Sensor::kGnss, Beside(0.2 * i, 0.5 * i));
    } else {
      degradation.OnAbsolute(SensorOf<PositionFixEntry>(), Beside(0.2 * i, 0));
    }
  }
  EXPECT_THAT(degradation.AgainstSensors("vision and IMU"), HasSubstr("GNSS contradicts"));
}

// GIVEN two sensors of one kind, of which the second is pulled away, THEN its kind and its number are named.
TEST(DegradationTest, OfSeveralSensorsOfAKindTheNumberIsNamed) {
  Degradation degradation;
  constexpr Sensor kFix = SensorOf<PositionFixEntry>();
  for (int i = 0; i < 100; ++i) {
    AbsoluteComparison comparison = Beside(0.2 * i, i % 2 == 1 ? 0.5 * i : 0);
    comparison.index = i % 2;
    degradation.OnAbsolute(kFix, comparison);
  }
  EXPECT_THAT(degradation.AgainstSensors("vision and IMU"),
              HasSubstr(std::string(PluralNameOf(kFix)) + " (fix1) contradict vision and IMU"));
}

}  // namespace
}  // namespace alidade
