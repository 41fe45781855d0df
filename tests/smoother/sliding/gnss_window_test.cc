#include "smoother/sliding/gnss_window.h"

#include <gtest/gtest.h>

#include "gnss/alignment/carried_state.h"
#include "tests/gnss/model/synthetic_sky.h"
#include "tests/smoother/solve/given_terms.h"
#include "tests/smoother/window/window_fixture.h"
#include "tests/support/jacobian_checker.h"

namespace alidade::test {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr TimeNs kSkyNs = 1'700'000'100 * kSecondNs;

GnssConfig Config() {
  GnssConfig config;
  config.corrections.ionosphere = IonosphereMode::kNone;
  return config;
}

/// A window whose frames have clocks and epochs of a sky, some milliseconds after each frame.
struct GnssFixture : WindowFixture {
  explicit GnssFixture(unsigned seed) : WindowFixture(seed, 4, 12, 1.0) {
    const NavigationData sky = SyntheticSky(kSkyNs);
    const MeasurementBuilder builder(std::make_shared<SatelliteCatalog>(sky), Config().corrections);
    SyntheticReceiver receiver;
    receiver.stamp_ns = kSkyNs;
    EpochMeasurements measurements = builder.Prepare(Observe(sky, receiver));
    builder.Locate(receiver.position_E, &measurements);
    context.config = Config();
    context.mount = {EnuFrame::At(receiver.position_E), Vector3d(0.1, -0.2, 0.3)};
    context.gravity_W = gravity_W;
    for (int i = 0; i < window.size(); ++i) {
      WindowFrame& frame = window.frame(i);
      frame.clock.emplace();
      for (double& value : *frame.clock) {
        value = random.Uniform(-3, 3);
      }
      FrameEpoch epoch;
      epoch.stamp_ns = frame.stamp_ns + 30'000'000;
      epoch.measurements = measurements;
      for (int k = 0; k <= 3; ++k) {
        epoch.imu.push_back(
            {frame.stamp_ns + k * 10'000'000LL, random.Vector(0.4), Vector3d(0, 0, 9.81) + random.Vector(1)});
      }
      epoch.gyro_radps = epoch.imu.back().gyro;
      epoch.preintegration.emplace(frame.imu_bias(), noise);
      epoch.preintegration->Add(epoch.imu);
      frame.epochs.push_back(epoch);
    }
  }
  GnssFactorContext context;
};

TEST(CarryStateTest, JacobianAgainstDifferences) {
  GnssFixture fixture(3);
  const WindowFrame& frame = fixture.window.frame(0);
  const Preintegration& interval = *frame.epochs[0].preintegration;
  const NavState nav = frame.nav_state();
  const ImuBias bias = frame.imu_bias();
  Matrix15d jacobian;
  const NavState end = CarryState(interval, nav, bias, fixture.gravity_W, &jacobian);
  const auto carried = [&](const Eigen::VectorXd& zeta) -> Eigen::VectorXd {
    const ImuBias moved{bias.gyro + zeta.segment<3>(9), bias.accel + zeta.segment<3>(12)};
    const NavState from = Retract(ErrorConvention::kSo3xRn, nav, Vector9d(zeta.head<9>()));
    return Local(ErrorConvention::kSo3xRn, end,
                 CarryState(interval, from, moved, fixture.gravity_W, nullptr));
  };
  EXPECT_EQ(CompareJacobians(jacobian.topRows<9>(), NumericJacobian(carried, 15), 1e-5), "");
}

// GIVEN an epoch with large residuals, THEN the factor's Jacobians are those of its robust residual.
TEST(GnssEpochFactorTest, JacobiansAgainstDifferences) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    GnssFixture fixture(seed);
    const WindowFrame& frame = fixture.window.frame(1);
    const FrameEpoch& epoch = frame.epochs[0];
    GnssResiduals residuals;
    const auto rows = [&](const Eigen::VectorXd& zeta) {
      const ImuBias bias{frame.imu_bias().gyro + zeta.segment<3>(9),
                         frame.imu_bias().accel + zeta.segment<3>(12)};
      return LinearizeFrameEpoch(
          fixture.context, epoch, 0.03,
          Retract(ErrorConvention::kSo3xRn, frame.nav_state(), Vector9d(zeta.head<9>())), bias,
          frame.clock_state() + zeta.tail<6>(), true, &residuals);
    };
    const auto residual = [&](const Eigen::VectorXd& zeta) -> Eigen::VectorXd { return rows(zeta).residual; };
    const FrameEpochRows at = rows(Eigen::VectorXd::Zero(21));
    ASSERT_GT(at.residual.size(), 10);
    MatrixXd analytic(at.residual.size(), 21);
    analytic << at.frame, at.clock;
    // Ranges of 2e7 m lose digits in differences.
    EXPECT_EQ(CompareJacobians(analytic, NumericJacobian(residual, 21, 1e-2), 1e-4), "");
  }
}

TEST(ClockFactorTest, ZeroOnItsProcess) {
  const ClockStep step(Config(), 0.5, false);
  Vector6d from;
  from << 100, 20, 1, 2, 3, 4;
  const Vector6d to = step.phi * from;
  const std::array<const double*, 2> blocks = {from.data(), to.data()};
  Vector6d residual;
  ASSERT_TRUE(ClockFactor(step).Evaluate(blocks.data(), residual.data(), nullptr));
  EXPECT_LT(residual.norm(), 1e-9);
  EXPECT_DOUBLE_EQ(to[0], 110);
}

class GnssMarginalizationTest : public testing::TestWithParam<ErrorConvention> {};

// GIVEN a window with clocks and epochs, WHEN its oldest frame leaves, THEN state and clock of the newest are
// known as well as before.
TEST_P(GnssMarginalizationTest, NothingIsLostAndNothingInvented) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    GnssFixture fixture(seed);
    GnssWindow gnss(Config(), {}, fixture.gravity_W);
    GnssAlignment alignment;
    alignment.enu = fixture.context.mount.enu;
    LinearPrior prior;
    Matrix15d covariance = 0.1 * Matrix15d::Identity();
    ASSERT_TRUE(MakeInitialPrior(GetParam(), fixture.window.frame(0), covariance, &prior));
    const auto clock = fixture.window.frame(0).clock;
    gnss.Align(alignment, &fixture.window.frame(0), &prior);
    fixture.window.frame(0).clock = clock;
    const PoseSystem none(4);
    const SensorContext sensors{fixture.gravity_W, &fixture.context};
    const NewestEstimate before = Newest(fixture.window, prior, none, sensors);
    const LinearPrior next = Marginalize(fixture.window, prior, none, sensors);
    EXPECT_EQ(next.columns().size(), 15 + 6 + 6 + 6);
    fixture.window.RemoveOldest();
    const NewestEstimate after = Newest(fixture.window, next, PoseSystem(3), sensors);
    EXPECT_TRUE(after.covariance.isApprox(before.covariance, 1e-6)) << seed;
    EXPECT_TRUE(after.clock_covariance.isApprox(before.clock_covariance, 1e-6)) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Conventions, GnssMarginalizationTest,
                         testing::Values(ErrorConvention::kRightInvariant, ErrorConvention::kSo3xRn),
                         [](const auto& test) { return std::string(ToString(test.param)); });

}  // namespace
}  // namespace alidade::test
