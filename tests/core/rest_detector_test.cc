#include "core/rest_detector.h"

#include <gtest/gtest.h>

#include "core/lie.h"
#include "core/random.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// A camera that looks at 80 landmarks four metres away, with 1 px noise, at 20 Hz; the IMU runs at 200 Hz.
class RestDetectorTest : public ::testing::Test {
 protected:
  void SetUp() override {
    camera_ = *CameraModel::Create(DistortionModel::kNone, {460, 460, 376, 240}, {}, 752, 480);
    for (int i = 0; i < 80; ++i) {
      landmarks_.push_back(
          Vector3d(random_.Uniform(-3, 3), random_.Uniform(-1.8, 1.8), random_.Uniform(3, 5)));
    }
    SetBias(0, 1e-4);
  }

  RestVerdict AfterOneSecond(const Vector3d& velocity, double turn_rate, double accel_spread,
                             const Vector3d& acceleration = Vector3d::Zero()) {
    return After(1, velocity, turn_rate, accel_spread, acceleration);
  }

  /// Verdict after so many seconds of motion at the given velocity and camera turn rate (about y);
  /// accel_spread shakes the IMU.
  RestVerdict After(double seconds, const Vector3d& velocity, double turn_rate, double accel_spread,
                    const Vector3d& acceleration = Vector3d::Zero()) {
    RestDetector detector(VisionConfig(), InitConfig(), camera_);
    RestVerdict verdict;
    for (int k = 0; k <= static_cast<int>(20 * seconds); ++k) {
      const double t = 0.05 * k;
      std::vector<ImuSample> imu;
      for (int i = 0; i <= 10 && k > 0; ++i) {
        const Vector3d shake = accel_spread * random_.Normal3();
        imu.push_back({SecondsToNs(t - 0.05 + 0.005 * i),
                       Vector3d(0, turn_rate + 0.01, 0) + 0.003 * random_.Normal3(),
                       Vector3d(0, 0, 9.81) + acceleration + shake});
      }
      detector.AddImu(imu);
      const Matrix3d R_WC = so3::Exp(Vector3d(0, turn_rate * t, 0));
      // A turning point in the middle of the last half second.
      const Vector3d position = velocity * t + 0.5 * (t - 0.75) * (t - 0.75) * acceleration;
      TrackFrame frame;
      frame.stamp_ns = SecondsToNs(t + camera_ahead_s_);
      for (size_t i = 0; i < landmarks_.size(); ++i) {
        Vector2d pixel;
        if (camera_.Project(R_WC.transpose() * (landmarks_[i] - position), &pixel)) {
          frame.observations.push_back(
              {static_cast<std::int64_t>(i), pixel + Vector2d(random_.Normal(), random_.Normal())});
        }
      }
      NavEstimate given = estimate_;
      if (t < doubt_from_s_) {
        given.nav.v_WB.setZero();
      }
      verdict = detector.AddFrame(frame, given_noise_px_, given, Pose());
      mean_gyro_ = detector.Rates().mean_radps;
    }
    return verdict;
  }

  /// The bias of 0.01 rad/s about y is given as this much larger, with this deviation.
  void SetBias(double error_radps, double std_radps) {
    estimate_.bias.gyro.y() = 0.01 + error_radps;
    estimate_.covariance.diagonal().segment<3>(9).setConstant(std_radps * std_radps);
  }

  void SetVelocity(const Vector3d& v_WB, double std_mps) {
    estimate_.nav.v_WB = v_WB;
    estimate_.covariance.diagonal().segment<3>(6).setConstant(std_mps * std_mps);
  }

  RandomStream random_{1, "rest detector"};
  CameraModel camera_;
  std::vector<Vector3d> landmarks_;
  NavEstimate estimate_;
  double doubt_from_s_ = 0;    ///< before, the estimate's velocity is zero
  double camera_ahead_s_ = 0;  ///< the frames' stamps less the IMU's
  double given_noise_px_ = 1;
  Vector3d mean_gyro_;
};

TEST_F(RestDetectorTest, StandingStillIsRest) {
  const RestVerdict verdict = AfterOneSecond(Vector3d::Zero(), 0, 0.1);
  EXPECT_TRUE(verdict.no_translation);
  EXPECT_TRUE(verdict.no_rotation);
  EXPECT_NEAR(mean_gyro_.y(), 0.01, 0.001) << "the gyroscope's bias";
}

// GIVEN a motion that moves tracks by less than the limit THEN the verdict is that their flow is more than
// noise.
TEST_F(RestDetectorTest, SlowMotionIsDetected) {
  const RestVerdict still = AfterOneSecond(Vector3d::Zero(), 0, 0.1);
  EXPECT_LT(still.flow_deviations, 3.5);
  const RestVerdict verdict = AfterOneSecond(Vector3d(0.013, 0, 0), 0, 0.1);
  EXPECT_TRUE(verdict.no_translation);
  EXPECT_GT(verdict.flow_deviations, 3.5);
  constexpr double kDepth = 4;  // [m]
  EXPECT_GT(verdict.speed_per_depth * kDepth, 0.013);
  EXPECT_LT(verdict.speed_per_depth * kDepth, 0.1);
  EXPECT_LT(still.speed_per_depth, verdict.speed_per_depth);
}

// GIVEN rest or slow motion that lasts THEN the flow is compared with that of its beginning, as far as it is
// none: the speed that it leaves is less and less, but never less than that of the motion.
TEST_F(RestDetectorTest, ALongRestLeavesLessSpeed) {
  double short_rest = 0;
  double long_rest = 0;
  double long_turn = 0;
  for (int run = 0; run < 8; ++run) {
    short_rest += After(1, Vector3d::Zero(), 0, 0.1).speed_per_depth;
    long_rest += After(16, Vector3d::Zero(), 0, 0.1).speed_per_depth;
    long_turn += After(16, Vector3d::Zero(), 1e-3, 0.1).speed_per_depth;
  }
  EXPECT_LT(long_rest, 0.4 * short_rest);
  EXPECT_LT(long_turn, short_rest) << "the gyroscope's noise adds to the flow";
  constexpr double kDepth = 4;  // [m]
  for (const double speed_mps : {0.001, 0.003, 0.01}) {
    for (double seconds = 1; seconds < 20; seconds *= 1.3) {
      const RestVerdict verdict = After(seconds, Vector3d(speed_mps, 0, 0), 0, 0.1);
      EXPECT_TRUE(verdict.no_translation);
      EXPECT_GT(verdict.speed_per_depth * kDepth, speed_mps) << seconds << " s";
    }
  }
}

TEST_F(RestDetectorTest, MotionIsToldWhereVelocityExceedsItsDeviation) {
  RestDetector detector(VisionConfig(), InitConfig(), camera_);
  SetVelocity(Vector3d(0.2, 0, 0), 0.1);
  EXPECT_FALSE(detector.TellsMotion(estimate_, Vector3d::Zero())) << "before the first inertial sample";
  const std::vector<ImuSample> imu = {{0, Vector3d(0.01, 0.01, 1), Vector3d(0, 0, 9.81)}};
  detector.AddImu(imu);
  EXPECT_TRUE(detector.TellsMotion(estimate_, Vector3d::Zero()));
  SetVelocity(Vector3d(0.15, 0, 0), 0.1);
  EXPECT_FALSE(detector.TellsMotion(estimate_, Vector3d::Zero()));
  EXPECT_TRUE(detector.TellsMotion(estimate_, Vector3d(0, -0.1, 0))) << "the camera moves on its lever arm";
}

TEST_F(RestDetectorTest, FlowIsTestedAgainstTheGivenNoise) {
  const RandomStream start = random_;
  const double usual = AfterOneSecond(Vector3d::Zero(), 0, 0.1).flow_deviations;
  random_ = start;
  given_noise_px_ = 2;
  EXPECT_NEAR(AfterOneSecond(Vector3d::Zero(), 0, 0.1).flow_deviations, 0.5 * usual, 1e-12);
}

TEST_F(RestDetectorTest, ATurnOnTheSpotIsNoTranslation) {
  const RestVerdict verdict = AfterOneSecond(Vector3d::Zero(), 0.05, 0.1);
  EXPECT_TRUE(verdict.no_translation);
  EXPECT_FALSE(verdict.no_rotation);
}

TEST_F(RestDetectorTest, ConstantVelocityIsNotRest) {
  for (const Vector3d& velocity : {Vector3d(0.1, 0, 0), Vector3d(0, -0.1, 0), Vector3d(0, 0, 0.2)}) {
    EXPECT_FALSE(AfterOneSecond(velocity, 0, 0.01).no_translation) << velocity.transpose();
  }
}

TEST_F(RestDetectorTest, ShakingIsNotRest) {
  EXPECT_FALSE(AfterOneSecond(Vector3d::Zero(), 0, 2.0).no_translation);
}

// GIVEN a camera that is thrown up and caught at the same place, pushed evenly all the while, WHEN the ends
// of the window show the same image, THEN it is not at rest.
TEST_F(RestDetectorTest, ATurningPointIsNotRest) {
  EXPECT_FALSE(AfterOneSecond(Vector3d::Zero(), 0, 0.1, Vector3d(0, 4, 0)).no_translation);
}

// GIVEN a bias that is off by two of its deviations, which turns the image by 2 px in the window, WHEN the
// rig stands still, THEN that is rest.
TEST_F(RestDetectorTest, ABiasThatIsNotKnownYetHidesNoRest) {
  SetBias(0.01, 0.005);
  const RestVerdict verdict = AfterOneSecond(Vector3d::Zero(), 0, 0.1);
  EXPECT_TRUE(verdict.no_translation);
  EXPECT_TRUE(verdict.no_rotation);
}

// GIVEN the same with a bias that is known, WHEN the image stands still, THEN the rig moves with the turn.
TEST_F(RestDetectorTest, AStillImageWhileTheRigIsKnownToTurnIsNoRest) {
  SetBias(0.01, 1e-4);
  EXPECT_FALSE(AfterOneSecond(Vector3d::Zero(), 0, 0.1).no_translation);
}

TEST_F(RestDetectorTest, AMotionWhileTheBiasIsNotKnownIsNoRest) {
  SetBias(0.01, 0.005);
  for (const Vector3d& velocity : {Vector3d(0.1, 0, 0), Vector3d(0, -0.1, 0), Vector3d(0, 0, 0.2),
                                   // Of one sign, the wrong turn hides it in the image.
                                   Vector3d(0.04, 0, 0), Vector3d(-0.04, 0, 0)}) {
    EXPECT_FALSE(AfterOneSecond(velocity, 0, 0.01).no_translation) << velocity.transpose();
  }
}

// GIVEN a turn that the gyroscope measures but that moves the image by less than the limit, WHEN it is taken
// for rest, THEN the verdict is that the flow is more than noise.
TEST_F(RestDetectorTest, ASlowTurnIsDetected) {
  const RestVerdict verdict = AfterOneSecond(Vector3d::Zero(), 0.003, 0.1);
  EXPECT_TRUE(verdict.no_rotation);
  EXPECT_GT(verdict.flow_deviations, 3.5);
}

// GIVEN scenery so far that a slow motion stays below the limit of the flow, WHEN the estimate contains the
// motion, THEN that is no rest; the images alone do not show it.
TEST_F(RestDetectorTest, FarSceneryHidesNoMotionOfTheEstimate) {
  for (Vector3d& landmark : landmarks_) {
    landmark *= 20;
  }
  const Vector3d velocity(0.1, 0, 0);
  EXPECT_TRUE(After(4, velocity, 0, 0.01).no_translation);
  SetVelocity(velocity, 0.01);
  EXPECT_FALSE(AfterOneSecond(velocity, 0, 0.01).no_translation);
  EXPECT_FALSE(After(4, velocity, 0, 0.01).no_translation);
  SetVelocity(velocity, 0.1);
  EXPECT_TRUE(AfterOneSecond(velocity, 0, 0.01).no_translation) << "nor does the estimate tell";
}

// GIVEN a rig that stands still, and an estimate whose velocity is 3.5 of its deviations off, as an error of
// the accelerometer's bias makes it in one start of a hundred, THEN rest is found.
TEST_F(RestDetectorTest, AnErrorOfTheVelocityHidesNoRest) {
  SetVelocity(Vector3d(0.05, 0, 0), 0.01);  // and 0.01 that no estimate can contradict
  EXPECT_TRUE(AfterOneSecond(Vector3d::Zero(), 0, 0.1).no_translation);
}

// GIVEN an estimate that moves on while the rig stands still THEN that is rest, later than usual.
TEST_F(RestDetectorTest, LastingRestOverrulesTheEstimate) {
  SetVelocity(Vector3d(0.1, 0, 0), 0.01);
  EXPECT_FALSE(After(2.4, Vector3d::Zero(), 0, 0.1).no_translation);
  EXPECT_TRUE(After(2.6, Vector3d::Zero(), 0, 0.1).no_translation);
}

// GIVEN a rig that has stood still, WHEN the estimate begins to move, THEN the rest before does not make that
// one last.
TEST_F(RestDetectorTest, RestBeforeTheDoubtDoesNotCount) {
  doubt_from_s_ = 2.5;
  SetVelocity(Vector3d(0.1, 0, 0), 0.01);
  EXPECT_TRUE(After(2.4, Vector3d::Zero(), 0, 0.1).no_translation);
  EXPECT_FALSE(After(3, Vector3d::Zero(), 0, 0.1).no_translation);
  EXPECT_TRUE(After(4.6, Vector3d::Zero(), 0, 0.1).no_translation);
}

// GIVEN an IMU whose rate is proportional to time, WHEN no frame comes for ten minutes, THEN the mean over
// the samples that are kept shows that they reach back no farther than twice the four windows of a verdict in
// doubt.
TEST_F(RestDetectorTest, ASilenceOfTheCameraKeepsABoundedNumberOfSamples) {
  const double bound_s = 2 * 4 * VisionConfig().rest_window_s;
  RestDetector detector(VisionConfig(), InitConfig(), camera_);
  for (int k = 0; k < 6000; ++k) {
    std::vector<ImuSample> imu;
    for (int i = 0; i <= 10; ++i) {
      const double t = 0.1 * k + 0.01 * i;
      imu.push_back({SecondsToNs(t), Vector3d(0, t, 0), Vector3d(0, 0, 9.81)});
    }
    detector.AddImu(imu);
    const RestRates rates = detector.Rates();
    EXPECT_NEAR(rates.at_end_radps.y(), 0.1 * k + 0.1, 1e-9) << "the newest sample is always kept";
    ASSERT_LE(2 * (rates.at_end_radps.y() - rates.mean_radps.y()), bound_s + 1e-6) << k;
  }
}

// GIVEN a camera whose clock is far off that of the IMU, WHEN the rig stands still for longer than samples
// may reach back, THEN that is rest: how far they do is measured from the newest of them, not from the
// frame's stamp.
TEST_F(RestDetectorTest, TheCamerasClockDoesNotDecideWhichSamplesAreKept) {
  for (const double ahead_s : {-1000.0, 1000.0}) {
    camera_ahead_s_ = ahead_s;
    EXPECT_TRUE(After(4.2, Vector3d::Zero(), 0, 0.1).no_translation) << ahead_s;
  }
}

TEST_F(RestDetectorTest, NothingIsSaidBeforeTheWindowIsFull) {
  RestDetector detector(VisionConfig(), InitConfig(), camera_);
  EXPECT_FALSE(detector.AddFrame({}, 1, NavEstimate(), Pose()).no_translation);
}

}  // namespace
}  // namespace alidade
