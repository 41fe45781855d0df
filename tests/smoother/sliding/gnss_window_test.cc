#include "smoother/sliding/gnss_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/robust.h"
#include "tests/smoother/sliding/gnss_fixture.h"
#include "tests/smoother/solve/given_terms.h"
#include "tests/support/jacobian_checker.h"

namespace alidade::test {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

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

// The rows over the lever arm of a watched antenna.
TEST(GnssEpochFactorTest, LeverArmAgainstDifferences) {
  GnssFixture fixture(3);
  const WindowFrame& frame = fixture.window.frame(1);
  FrameEpoch epoch = frame.epochs[0];
  epoch.gyro_radps = Vector3d(0.3, -0.5, 0.8);
  GnssResiduals residuals;
  const auto rows = [&](const Eigen::VectorXd& error) {
    GnssFactorContext context = fixture.context;
    context.mount.p_BA += error;
    return LinearizeFrameEpoch(context, epoch, 0.03, frame.nav_state(), frame.imu_bias(), frame.clock_state(),
                               true, &residuals);
  };
  const auto residual = [&](const Eigen::VectorXd& error) -> Eigen::VectorXd { return rows(error).residual; };
  const FrameEpochRows at = rows(Vector3d::Zero());
  EXPECT_EQ(CompareJacobians(MatrixXd(at.lever_arm), NumericJacobian(residual, 3, 1e-2), 1e-4), "");
}

TEST(ClockFactorTest, ZeroOnItsProcess) {
  const ClockStep step(GnssTestConfig(), 0.5, false);
  Vector6d from;
  from << 100, 20, 1, 2, 3, 4;
  const Vector6d to = step.phi * from;
  const std::array<const double*, 2> blocks = {from.data(), to.data()};
  Vector6d residual;
  ASSERT_TRUE(ClockFactor(step).Evaluate(blocks.data(), residual.data(), nullptr));
  EXPECT_LT(residual.norm(), 1e-9);
  EXPECT_DOUBLE_EQ(to[0], 110);
}

/// An aligned window, and an epoch taken out of its first frame, to be attached anew.
struct DetachedEpoch {
  DetachedEpoch() { frame.epochs.clear(); }
  [[nodiscard]] bool Attach() { return gnss.Attach(epoch, given.imu, fixture.noise, &frame); }

  GnssFixture fixture{2};
  GnssWindow gnss = fixture.AlignedWindow();
  WindowFrame& frame = fixture.window.frame(0);
  FrameEpoch given = frame.epochs[0];
  GnssEpoch epoch{given.stamp_ns, given.measurements, fixture.builder};
};

// GIVEN two pseudoranges that are 60 m late, of which most satellites contradict one, WHEN their epoch is
// attached, THEN that one takes no part until the gate, however uncertain the state is.
TEST(GnssWindowTest, AContradictedPseudorangeTakesNoPartBeforeTheGate) {
  DetachedEpoch at;
  std::vector<SatelliteMeasurement>& satellites = at.epoch.measurements.satellites;
  std::size_t high = 0;  // index of a row: those above the mask
  std::vector<std::size_t> late;
  for (SatelliteMeasurement& satellite : satellites) {
    if (satellite.direction.elevation_rad * 180 / M_PI < GnssTestConfig().corrections.elevation_mask_deg) {
      continue;
    }
    if (high == 2 || high == 5) {
      satellite.pseudorange_m += 60;
      satellite.contradicted = high == 5;
      late.push_back(high);
    }
    ++high;
  }
  ASSERT_EQ(late.size(), 2U);
  ASSERT_TRUE(at.Attach());
  const std::vector<bool>& used = at.frame.epochs[0].used;
  ASSERT_GT(used.size(), high);  // rates follow
  EXPECT_TRUE(used[2]);
  EXPECT_FALSE(used[5]);
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 1);
}

// GIVEN an epoch whose satellites are all marked as contradicted, THEN a jump of the clock by a millisecond,
// which is taken out, changes nothing in which of them take part.
TEST(GnssWindowTest, AClockJumpDoesNotDecideWhichContradictedTakePart) {
  std::vector<std::vector<bool>> used;
  for (const double jump_m : {0.0, 299792.458}) {
    DetachedEpoch at;
    for (SatelliteMeasurement& satellite : at.epoch.measurements.satellites) {
      satellite.pseudorange_m += jump_m;
      satellite.contradicted = true;
    }
    ASSERT_TRUE(at.Attach());
    EXPECT_EQ(at.gnss.jumped(), jump_m > 0);
    used.push_back(at.frame.epochs[0].used);
  }
  const auto pseudoranges = used[0].begin() + static_cast<std::ptrdiff_t>(used[0].size() / 2);
  EXPECT_GT(std::count(used[0].begin(), pseudoranges, true), 0);
  EXPECT_EQ(used[1], used[0]);
}

// GIVEN most rows of an epoch beyond the gate, so that the state is suspect and not the satellites, THEN none
// pulls harder than at the gate, as in the filter.
TEST(GnssWindowTest, RowsOfASuspectEpochAreScaledToTheGate) {
  GnssFixture fixture(2);
  GnssWindow gnss = fixture.AlignedWindow();
  for (int i = 0; i < fixture.window.size(); ++i) {
    WindowFrame& frame = fixture.window.frame(i);
    NavState away = frame.nav_state();
    away.p_WB += Vector3d(300, -200, 100);
    PackNavState(away, frame.nav.data());
  }
  FrameStatistics statistics;
  for (int i = 0; i < fixture.window.size(); ++i) {
    gnss.Gate(&fixture.window.frame(i), &statistics);
  }
  const double gate = ChiSquareQuantile(1, GnssTestConfig().gate_probability);
  int at_the_gate = 0;
  for (int i = 0; i < fixture.window.size(); ++i) {
    const WindowFrame& frame = fixture.window.frame(i);
    GnssResiduals residuals;
    const FrameEpochRows rows = LinearizeFrameEpoch(*gnss.context(), frame.epochs[0], 0.03, frame.nav_state(),
                                                    frame.imu_bias(), frame.clock_state(), false, &residuals);
    for (const double residual : rows.residual) {
      EXPECT_LE(residual * residual, gate * (1 + 1e-9));
      at_the_gate += residual * residual > gate * (1 - 1e-9) ? 1 : 0;
    }
  }
  EXPECT_GT(at_the_gate, 8);
  EXPECT_EQ(statistics.satellites_gated, 0);
}

class GnssMarginalizationTest : public testing::TestWithParam<ErrorConvention> {};

// GIVEN a window with clocks and epochs, WHEN its oldest frame leaves, THEN state and clock of the newest are
// known as well as before.
TEST_P(GnssMarginalizationTest, NothingIsLostAndNothingInvented) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    GnssFixture fixture(seed);
    GnssWindow gnss(GnssTestConfig(), {}, fixture.gravity_W);
    GnssAlignment alignment;
    alignment.enu = fixture.context.mount.enu;
    alignment.clock = Vector6d::Zero();
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
