#include "gnss/alignment/alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/gnss/alignment/kernel_choice.h"
#include "tests/gnss/model/synthetic_sky.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr TimeNs kStart = 1'700'000'100 * kSecondNs;

/// A receiver that walks a circle in the ENU frame; the local world is turned and shifted against it.
struct Walk {
  double radius_m = 5;
  double speed_mps = 1;
  double wobble_rad = 0;             ///< of an uneven pace; an even circle cannot separate time from yaw
  double yaw_rad = 0.7;              ///< R_NW
  Vector3d dv_W = Vector3d::Zero();  ///< by which the estimate's velocity is off
  double sway_mps = 0;               ///< and by how much that turns, once in 3 s
  double velocity_std_mps = 0;       ///< in its own covariance
  Vector3d p_NW = Vector3d(3, -2, 1);
  double time_offset_s = 0;  ///< t_imu = t_GPST + offset
  EnuFrame enu = EnuFrame::At(Vector3d(3582105, 532590, 5232755));
  NavigationData sky = test::SyntheticSky(kStart);
  GnssConfig config = MakeConfig();
  std::shared_ptr<const MeasurementBuilder> builder =
      std::make_shared<MeasurementBuilder>(std::make_shared<SatelliteCatalog>(sky), config.corrections);

  static GnssConfig MakeConfig() {
    GnssConfig config;
    config.corrections.ionosphere = IonosphereMode::kNone;
    config.corrections.model_std_scale = 0;
    config.corrections.pseudorange_std_m = 0.5;
    return config;
  }

  [[nodiscard]] TimeNs ImuTime(double t) const {
    return kStart + SecondsToNs(t) + SecondsToNs(time_offset_s);
  }
  [[nodiscard]] NavState Global(double t) const {
    const double phase = speed_mps / radius_m * t + wobble_rad * std::sin(2 * t);
    const double rate = speed_mps / radius_m + 2 * wobble_rad * std::cos(2 * t);
    NavState nav;
    nav.R_WB = Eigen::AngleAxisd(phase, Vector3d::UnitZ()).toRotationMatrix();
    nav.p_WB = radius_m * Vector3d(std::cos(phase), std::sin(phase), 0);
    nav.v_WB = radius_m * rate * Vector3d(-std::sin(phase), std::cos(phase), 0);
    return nav;
  }
  [[nodiscard]] NavState Local(double t) const {
    const Eigen::Matrix3d R_WN = Eigen::AngleAxisd(-yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
    const NavState global = Global(t);
    const double w = 2 * M_PI / 3;
    const Vector3d sway_W = sway_mps * Vector3d(std::cos(w * t), std::sin(w * t), 0);
    const Vector3d swayed_W = sway_mps / w * Vector3d(std::sin(w * t), -std::cos(w * t), 0);
    return {R_WN * global.R_WB, R_WN * (global.p_WB - p_NW) + t * dv_W + swayed_W,
            R_WN * global.v_WB + dv_W + sway_W};
  }
  [[nodiscard]] Eigen::Matrix3d VelocityCovariance() const {
    return velocity_std_mps * velocity_std_mps * Eigen::Matrix3d::Identity();
  }
  /// Noise of a fixed pattern; `satellites` of the epoch are kept, others each time.
  [[nodiscard]] GnssEpoch Epoch(double t, std::size_t satellites) const {
    test::SyntheticReceiver receiver;
    receiver.stamp_ns = kStart + SecondsToNs(t);
    receiver.position_E = enu.ToEcef(Global(t).p_WB);
    receiver.velocity_E = enu.R_EN * Global(t).v_WB;
    receiver.clock_m = 900 + 20 * t;
    receiver.drift_mps = 20;
    receiver.galileo_bias_m = 4;
    ObservationEpoch observed = test::Observe(sky, receiver);
    std::rotate(observed.satellites.begin(),
                observed.satellites.begin() + static_cast<std::ptrdiff_t>(3 * std::llround(t)) %
                                                  static_cast<std::ptrdiff_t>(observed.satellites.size()),
                observed.satellites.end());
    observed.satellites.resize(std::min(observed.satellites.size(), satellites));
    for (std::size_t i = 0; i < observed.satellites.size(); ++i) {
      SignalObservation& signal = observed.satellites[i].signals[0];
      *signal.pseudorange_m += 0.3 * std::sin(7.0 * static_cast<double>(i) + 13 * t);
      *signal.doppler_hz += 0.1 * std::cos(5.0 * static_cast<double>(i) + 11 * t);
    }
    return {ImuTime(t), builder->Prepare(observed), builder};
  }
};

/// Feeds states at 10 Hz and epochs at 1 Hz, between the states, from the second `first` on until `last`, and
/// stops at the alignment.
std::optional<GnssAlignment> FollowFrom(const Walk& walk, int first, double last, std::size_t satellites,
                                        GnssAligner* aligner) {
  const Vector3d approximate = walk.enu.ToEcef(Vector3d(200, -300, 50));
  int epochs = first;
  for (int i = 10 * first; i * 0.1 < last; ++i) {
    const double t = 0.1 * i;
    const Vector3d gyro(0, 0, walk.speed_mps / walk.radius_m);
    for (; epochs + 0.537 < t; ++epochs) {
      aligner->AddEpoch(walk.Epoch(epochs + 0.537, satellites), approximate);
    }
    aligner->AddState(walk.ImuTime(t), walk.Local(t), ImuBias(), gyro, walk.VelocityCovariance());
    if (auto alignment = aligner->TryAlign()) {
      return alignment;
    }
  }
  return std::nullopt;
}

std::optional<GnssAlignment> Follow(const Walk& walk, double seconds, std::size_t satellites,
                                    GnssAligner* aligner) {
  return FollowFrom(walk, 0, seconds, satellites, aligner);
}

GnssReceiver AtAnchor(const Walk& walk) {
  GnssReceiver receiver;
  receiver.time_offset_s = walk.time_offset_s;
  receiver.anchor_E = walk.enu.origin_E;
  return receiver;
}

TEST(GnssAlignerTest, GIVEN_1_Hz_and_slow_motion_THEN_yaw_and_shift_are_within_their_deviations) {
  Walk walk;
  for (const double yaw : {0.7, -2.9, 3.1}) {
    walk.yaw_rad = yaw;
    GnssAligner aligner(walk.config, AtAnchor(walk));
    const auto alignment = Follow(walk, 30, 40, &aligner);
    ASSERT_TRUE(alignment) << aligner.report();
    const double yaw_error = std::remainder(alignment->yaw_rad - yaw, 2 * M_PI);
    EXPECT_LT(std::abs(yaw_error), 3 * std::sqrt(alignment->covariance(0, 0)));
    EXPECT_LT(std::abs(yaw_error), 0.05);
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT(std::abs(alignment->p_NW[i] - walk.p_NW[i]),
                3 * std::sqrt(alignment->covariance(i + 1, i + 1)) + 0.05)
          << i;
    }
  }
}

TEST(GnssAlignerTest, GIVEN_three_satellites_an_epoch_THEN_they_accumulate) {
  const Walk walk;
  GnssAligner aligner(walk.config, AtAnchor(walk));
  const auto alignment = Follow(walk, 40, 3, &aligner);
  ASSERT_TRUE(alignment) << aligner.report();
  EXPECT_LT(std::abs(alignment->yaw_rad - walk.yaw_rad), 0.1);
}

TEST(GnssAlignerTest, GIVEN_rest_THEN_it_waits_for_motion) {
  Walk walk;
  walk.speed_mps = 0;
  GnssAligner aligner(walk.config, AtAnchor(walk));
  EXPECT_FALSE(Follow(walk, 20, 40, &aligner));
  EXPECT_NE(aligner.report().find("too little motion"), std::string::npos) << aligner.report();
}

TEST(GnssAlignerTest, GIVEN_ephemerides_a_day_old_THEN_the_report_says_why_there_are_no_epochs) {
  Walk walk;
  walk.builder = std::make_shared<MeasurementBuilder>(
      std::make_shared<SatelliteCatalog>(test::SyntheticSky(kStart - kDayNs)), walk.config.corrections);
  GnssAligner aligner(walk.config, AtAnchor(walk));
  EXPECT_FALSE(Follow(walk, 10, 40, &aligner));
  EXPECT_NE(aligner.report().find("0 epochs of at least 1 satellites"), std::string::npos)
      << aligner.report();
  EXPECT_NE(aligner.report().find("without ephemeris"), std::string::npos) << aligner.report();
  EXPECT_EQ(aligner.report().find("left out: 0 without"), std::string::npos) << aligner.report();
}

// GIVEN a receiver at rest and an estimate whose velocity sways within its deviation, as a shaken start's,
// THEN the swaying is not taken for motion.
TEST(GnssAlignerTest, GIVEN_an_estimate_that_sways_at_rest_THEN_it_waits_for_motion) {
  Walk walk;
  walk.speed_mps = 0;
  walk.sway_mps = 0.4;
  walk.velocity_std_mps = 0.28;
  walk.config.align_max_yaw_std_rad = 0.2;
  GnssAligner aligner(walk.config, AtAnchor(walk));
  EXPECT_FALSE(Follow(walk, 30, 40, &aligner)) << aligner.report();
}

// GIVEN an estimate that is off by more than the speed it moves at, WHEN its covariance states it, THEN yaw
// waits until the path has turned enough to separate the two, and is within its deviation.
TEST(GnssAlignerTest, GIVEN_a_velocity_that_is_off_THEN_yaw_is_within_its_deviation) {
  Walk walk;
  walk.speed_mps = 0.5;
  walk.config.align_min_epochs = 4;
  walk.config.align_max_yaw_std_rad = 0.2;
  walk.config.align_window_s = 60;
  for (const Vector3d& dv_W : {Vector3d(0, 0.6, 0), Vector3d(-0.6, 0, 0), Vector3d(0.4, -0.4, 0.1)}) {
    walk.dv_W = dv_W;
    walk.velocity_std_mps = 0.25;
    GnssAligner aligner(walk.config, AtAnchor(walk));
    const auto alignment = Follow(walk, 70, 40, &aligner);
    ASSERT_TRUE(alignment) << aligner.report();
    const double yaw_error = std::remainder(alignment->yaw_rad - walk.yaw_rad, 2 * M_PI);
    EXPECT_LT(std::abs(yaw_error), 3 * std::sqrt(alignment->covariance(0, 0))) << dv_W.transpose();
    EXPECT_LT(std::abs(yaw_error), 0.2) << dv_W.transpose();
  }
}

TEST(GnssAlignerTest, GIVEN_stamps_50_ms_late_WHEN_asked_THEN_the_offset_is_found) {
  Walk walk;
  walk.radius_m = 2;
  walk.speed_mps = 3;
  walk.wobble_rad = 0.5;
  walk.config.estimate_time_offset = true;
  walk.config.align_min_epochs = 20;
  GnssAligner aligner(walk.config, AtAnchor(walk));
  const Vector3d approximate = walk.enu.ToEcef(Vector3d(20, -30, 5));
  std::optional<GnssAlignment> alignment;
  for (int i = 0; i < 300 && !alignment; ++i) {
    const double t = 0.1 * i;
    GnssEpoch epoch = walk.Epoch(t, 40);
    epoch.stamp_ns -= 50'000'000;  // truth: t_imu = stamp + 50 ms
    aligner.AddEpoch(epoch, approximate);
    aligner.AddState(kStart + SecondsToNs(t), walk.Local(t), ImuBias(), Vector3d(0, 0, 1.5),
                     walk.VelocityCovariance());
    alignment = aligner.TryAlign();
  }
  ASSERT_TRUE(alignment) << aligner.report();
  EXPECT_NEAR(alignment->time_offset_s, 0.05, 0.02);
}

// GIVEN a receiver whose time is not the IMU's, as in its sheet, THEN an epoch meets the state at its
// stamp, which contains the offset, and neither that at its tag nor one that the offset is added to once
// more.
TEST(GnssAlignerTest, GIVEN_a_time_offset_THEN_the_state_is_that_at_the_epochs_IMU_time) {
  Walk walk;
  walk.radius_m = 2;
  walk.speed_mps = 3;  // 0.25 s turn the path by 0.375 rad
  GnssAligner together(walk.config, AtAnchor(walk));
  const auto expected = Follow(walk, 30, 40, &together);
  ASSERT_TRUE(expected) << together.report();
  EXPECT_LT(std::abs(expected->yaw_rad - walk.yaw_rad), 0.1);
  for (const double offset_s : {0.25, -18.0}) {
    walk.time_offset_s = offset_s;
    GnssAligner aligner(walk.config, AtAnchor(walk));
    const auto alignment = Follow(walk, 30, 40, &aligner);
    ASSERT_TRUE(alignment) << offset_s << ": " << aligner.report();
    EXPECT_EQ(alignment->stamp_ns - expected->stamp_ns, SecondsToNs(offset_s));
    EXPECT_NEAR(alignment->yaw_rad, expected->yaw_rad, 1e-9);
    EXPECT_LT((alignment->p_NW - expected->p_NW).norm(), 1e-6);
  }
}

// GIVEN an estimate that is lost 1 s before the next one, which stands elsewhere, and an epoch in between,
// THEN the alignment is that of an aligner that has seen the next one alone.
TEST(GnssAlignerTest, GIVEN_a_lost_estimate_THEN_nothing_of_it_is_in_the_alignment) {
  constexpr int kNext = 9;
  Walk walk;
  walk.config.align_min_epochs = 12;
  Walk lost = walk;
  lost.yaw_rad = -1.8;
  lost.p_NW = Vector3d(-40, 25, 3);
  GnssAligner aligner(walk.config, AtAnchor(walk));
  EXPECT_FALSE(Follow(lost, kNext - 1, 40, &aligner));
  EXPECT_NE(aligner.report().find("8 epochs"), std::string::npos) << aligner.report();
  aligner.AddEpoch(walk.Epoch(kNext - 0.463, 40), walk.enu.ToEcef(Vector3d(200, -300, 50)));
  aligner.ForgetEstimate();
  GnssAligner fresh(walk.config, AtAnchor(walk));
  const auto alignment = FollowFrom(walk, kNext, 45, 40, &aligner);
  const auto expected = FollowFrom(walk, kNext, 45, 40, &fresh);
  ASSERT_TRUE(expected) << fresh.report();
  ASSERT_TRUE(alignment) << aligner.report();
  EXPECT_EQ(alignment->report, expected->report);
  EXPECT_EQ(alignment->stamp_ns, expected->stamp_ns);
  EXPECT_NEAR(alignment->yaw_rad, expected->yaw_rad, 1e-9);
  EXPECT_LT((alignment->p_NW - expected->p_NW).norm(), 1e-6);
  EXPECT_LT(std::abs(alignment->yaw_rad - walk.yaw_rad), 0.1);
}

TEST(TurnIntoEnuTest, TurnsAndWidens) {
  GnssAlignment alignment;
  alignment.yaw_rad = M_PI / 2;
  alignment.p_NW = Vector3d(10, 0, 0);
  alignment.covariance.diagonal() << 0.01, 4, 4, 4;
  NavEstimate estimate;
  estimate.nav.p_WB = Vector3d(100, 0, 0);
  const NavEstimate turned = TurnIntoEnu(alignment, estimate);
  EXPECT_TRUE(turned.nav.p_WB.isApprox(Vector3d(10, 100, 0), 1e-12));
  // 0.1 rad at 100 m: 10 m across, along x in N.
  EXPECT_NEAR(turned.covariance(3, 3), 100 + 4, 1e-9);
  EXPECT_NEAR(turned.covariance(4, 4), 4, 1e-9);
  EXPECT_NEAR(turned.covariance(2, 2), 0.01, 1e-12);
}

TEST(GnssAlignerTest, GIVEN_noise_THEN_the_kernel_is_the_configured_one) {
  Walk walk;
  test::ExpectKernelIsTaken([&](RobustKernel kernel, double scale_sigma) {
    walk.config.robust_kernel = kernel;
    walk.config.robust_scale_sigma = scale_sigma;
    GnssAligner aligner(walk.config, AtAnchor(walk));
    const auto alignment = Follow(walk, 30, 40, &aligner);
    return alignment ? alignment->yaw_rad : 0;
  });
}

}  // namespace
}  // namespace alidade
