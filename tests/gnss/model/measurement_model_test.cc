#include "gnss/model/measurement_model.h"

#include <gtest/gtest.h>

#include "gnss/model/epoch_rows.h"
#include "tests/gnss/model/synthetic_sky.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

constexpr TimeNs kStamp = 1'593'043'200 * kSecondNs;

/// Corrected measurements of a made-up sky for a receiver, in the order of the satellites.
EpochMeasurements Measure(const test::SyntheticReceiver& receiver) {
  const NavigationData sky = test::SyntheticSky(receiver.stamp_ns);
  GnssCorrectionOptions options;
  options.ionosphere = IonosphereMode::kNone;
  const MeasurementBuilder builder(std::make_shared<SatelliteCatalog>(sky), options);
  EpochMeasurements epoch = builder.Prepare(test::Observe(sky, receiver));
  builder.Locate(receiver.position_E, &epoch);
  return epoch;
}

test::SyntheticReceiver Moving() {
  test::SyntheticReceiver receiver;
  receiver.stamp_ns = kStamp;
  receiver.velocity_E = {12, -30, 7};
  receiver.clock_m = 300'017.25;
  receiver.drift_mps = 82.5;
  return receiver;
}

/// The observation is worked out in axes that stand still and by differencing ranges: neither the Sagnac
/// series nor its rate is put in.
TEST(MeasurementModelTest, ResidualsVanishOnNoiseFreeTruth) {
  const test::SyntheticReceiver receiver = Moving();
  const EpochMeasurements epoch = Measure(receiver);
  ASSERT_GE(epoch.satellites.size(), 12u);
  const double tag_error_m =
      receiver.clock_m - SecondsBetween(receiver.stamp_ns, epoch.tag_ns) * kSpeedOfLight;
  for (const SatelliteMeasurement& m : epoch.satellites) {
    double residual = 0;
    PseudorangeModel::Of(m).Evaluate(receiver.position_E, receiver.clock_m - tag_error_m, &residual, nullptr);
    EXPECT_NEAR(residual, 0, 3e-3) << ToString(m.satellite);
    RangeRateModel::Of(m).Evaluate(receiver.position_E, receiver.velocity_E, receiver.drift_mps, &residual,
                                   nullptr, nullptr);
    EXPECT_NEAR(residual, 0, 1e-4) << ToString(m.satellite);
  }
}

/// A static receiver shows the sign of the Sagnac rate best: up to 1 cm/s a satellite.
TEST(MeasurementModelTest, SagnacRateHasItsSign) {
  test::SyntheticReceiver receiver;
  receiver.stamp_ns = kStamp;
  double largest = 0;
  for (const SatelliteMeasurement& m : Measure(receiver).satellites) {
    double residual = 0;
    RangeRateModel::Of(m).Evaluate(receiver.position_E, Eigen::Vector3d::Zero(), 0, &residual, nullptr,
                                   nullptr);
    EXPECT_NEAR(residual, 0, 1e-4) << ToString(m.satellite);
    const Eigen::Vector3d& vs = m.state.velocity_E;
    largest =
        std::max(largest, std::abs(kEarthRotationRate / kSpeedOfLight *
                                   (vs.x() * receiver.position_E.y() - vs.y() * receiver.position_E.x())));
  }
  EXPECT_GT(largest, 1e-3) << "the term is well above the tolerance";
}

struct NavCase {
  AntennaMount mount;
  NavState state;
  ImuBias bias;
  Eigen::Vector3d gyro;
  double clock_m;
  double drift_mps;
};

NavCase RandomCase(test::RandomStates* random) {
  NavCase c;
  c.mount.enu = EnuFrame::At(Eigen::Vector3d(3582105, 532590, 5232755) + random->Vector(1e5));
  c.mount.p_BA = random->Vector(2);
  c.state = random->Nav(500);
  c.state.v_WB = random->Vector(30);
  c.bias = random->Bias();
  c.gyro = random->Vector(1);
  c.clock_m = random->Uniform(-1e5, 1e5);
  c.drift_mps = random->Uniform(-100, 100);
  return c;
}

/// Pseudorange and range rate of one satellite as the estimators linearise them.
std::vector<GnssRow> Linearize(const NavCase& c, const SatelliteMeasurement& m, const NavState& state,
                               const ImuBias& bias) {
  GnssConfig config;
  config.corrections.elevation_mask_deg = 0;
  GnssPoint point{state, bias, c.gyro};
  point.clock[ClockState::kClock] = c.clock_m;
  point.clock[ClockState::kDrift] = c.drift_mps;
  GnssResiduals residuals;
  std::vector<GnssRow> rows = LinearizeEpoch(config, c.mount, point, {kStamp, {m}, {}}, &residuals);
  EXPECT_EQ(rows.size(), 2u);
  EXPECT_FALSE(rows.front().is_rate);
  EXPECT_TRUE(rows.back().is_rate);
  return rows;
}

// GIVEN an epoch with satellites below the mask and without a rate THEN the rows are counted as they are
// linearised, whatever the configuration uses.
TEST(MeasurementModelTest, RowsAreCountedWithoutLinearising) {
  EpochMeasurements epoch = Measure(Moving());
  ASSERT_GE(epoch.satellites.size(), 12u);
  epoch.satellites[0].range_rate_mps.reset();
  epoch.satellites[3].direction.elevation_rad = 0.01;
  test::RandomStates random(1);
  const NavCase c = RandomCase(&random);
  for (const bool pseudorange : {false, true}) {
    for (const bool doppler : {false, true}) {
      GnssConfig config;
      config.pseudorange = pseudorange;
      config.doppler = doppler;
      GnssResiduals residuals;
      const std::size_t rows =
          LinearizeEpoch(config, c.mount, {c.state, c.bias, c.gyro}, epoch, &residuals).size();
      EXPECT_EQ(CountEpochRows(config, epoch), rows) << pseudorange << doppler;
      EXPECT_EQ(rows == 0, !pseudorange && !doppler);
    }
  }
}

TEST(MeasurementModelTest, JacobiansAgreeWithCentralDifferencesInAllConventions) {
  const EpochMeasurements epoch = Measure(Moving());
  for (unsigned seed = 1; seed <= 24; ++seed) {
    test::RandomStates random(seed);
    const NavCase c = RandomCase(&random);
    const SatelliteMeasurement& m = epoch.satellites[seed % epoch.satellites.size()];
    const std::vector<GnssRow> rows = Linearize(c, m, c.state, c.bias);
    Eigen::Matrix<double, 2, 15> analytic;
    analytic << rows[0].jacobian, rows[1].jacobian;
    for (const ErrorConvention convention : test::kAllConventions) {
      const auto displaced = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        const NavState state = Retract(convention, c.state, xi.head<9>());
        const ImuBias bias{c.bias.gyro + xi.segment<3>(9), c.bias.accel + xi.segment<3>(12)};
        const std::vector<GnssRow> moved = Linearize(c, m, state, bias);
        return Eigen::Vector2d(moved[0].residual, moved[1].residual);
      };
      // Ranges of 2e7 m leave 4e-9 m of rounding: a step of 0.1 rad, m or m/s keeps 1e-7 of a derivative.
      const Eigen::MatrixXd numeric = test::NumericJacobian(displaced, 15, 2e-2);
      const Eigen::MatrixXd chained = analytic * ImuChartJacobian(convention, c.state);
      EXPECT_EQ(test::CompareJacobians(chained.row(0), numeric.row(0), 2e-6), "")
          << ToString(convention) << " " << seed;
      EXPECT_EQ(test::CompareJacobians(chained.row(1), numeric.row(1), 2e-6), "")
          << ToString(convention) << " " << seed;
    }
  }
}

TEST(MeasurementModelTest, ANullJacobianChangesNoResidual) {
  test::RandomStates random(3);
  const NavCase c = RandomCase(&random);
  const SatelliteMeasurement m = Measure(Moving()).satellites[1];
  Eigen::Matrix<double, 3, 15> mount_jacobian;
  const Eigen::Vector3d position = c.mount.Position(c.state, nullptr);
  EXPECT_EQ(c.mount.Position(c.state, &mount_jacobian), position);
  const Eigen::Vector3d velocity = c.mount.Velocity(c.state, c.bias, c.gyro, nullptr);
  EXPECT_EQ(c.mount.Velocity(c.state, c.bias, c.gyro, &mount_jacobian), velocity);
  const std::vector<GnssRow> rows = Linearize(c, m, c.state, c.bias);
  double alone = 0;
  PseudorangeModel::Of(m).Evaluate(position, c.clock_m, &alone, nullptr);
  EXPECT_EQ(alone, rows[0].residual);
  RangeRateModel::Of(m).Evaluate(position, velocity, c.drift_mps, &alone, nullptr, nullptr);
  EXPECT_EQ(alone, rows[1].residual);
}

TEST(MeasurementModelTest, ClockAndDriftHaveJacobianOne) {
  const EpochMeasurements epoch = Measure(Moving());
  const SatelliteMeasurement& m = epoch.satellites[3];
  double a = 0;
  double b = 0;
  const Eigen::Vector3d p(3582105, 532590, 5232755);
  PseudorangeModel::Of(m).Evaluate(p, 10, &a, nullptr);
  PseudorangeModel::Of(m).Evaluate(p, 11, &b, nullptr);
  EXPECT_NEAR(b - a, 1, 1e-7);
  RangeRateModel::Of(m).Evaluate(p, p * 1e-6, 10, &a, nullptr, nullptr);
  RangeRateModel::Of(m).Evaluate(p, p * 1e-6, 11, &b, nullptr, nullptr);
  EXPECT_NEAR(b - a, 1, 1e-9);
}

/// The closed forms of the right-invariant error, where the terms in omega / c and in the line of sight's
/// turning are left out: p: -e^T C, theta: e^T C [p_A]x, v: -e^T C, theta: e^T C [v_A]x, b_g: -e^T C R [l]x.
TEST(MeasurementModelTest, RightInvariantJacobiansHaveTheirClosedForms) {
  const EpochMeasurements epoch = Measure(Moving());
  test::RandomStates random(4);
  const NavCase c = RandomCase(&random);
  const SatelliteMeasurement& m = epoch.satellites[2];
  const Eigen::Matrix3d C = c.mount.enu.R_EN;
  const Eigen::Vector3d antenna = c.mount.Position(c.state, nullptr);
  const Eigen::RowVector3d e = (m.state.position_E - antenna).normalized().transpose();
  const Eigen::Vector3d p_A = c.state.p_WB + c.state.R_WB * c.mount.p_BA;
  const Eigen::Vector3d v_A = c.state.v_WB + c.state.R_WB * (c.gyro - c.bias.gyro).cross(c.mount.p_BA);
  const Matrix15d chart = ImuChartJacobian(ErrorConvention::kRightInvariant, c.state);
  const std::vector<GnssRow> rows = Linearize(c, m, c.state, c.bias);
  const GnssJacobian range = rows[0].jacobian * chart;
  EXPECT_LT((range.segment<3>(3) + e * C).norm(), 1e-5);
  EXPECT_LT((range.head<3>() - e * C * Skew(p_A)).norm(), 1e-5 * p_A.norm());
  const GnssJacobian rate = rows[1].jacobian * chart;
  EXPECT_LT((rate.segment<3>(6) + e * C).norm(), 3e-5);
  EXPECT_LT((rate.head<3>() - e * C * Skew(v_A)).norm(), 3e-5 * v_A.norm() + 3e-4 * p_A.norm());
  EXPECT_LT((rate.segment<3>(9) + e * C * c.state.R_WB * Skew(c.mount.p_BA)).norm(), 1e-4);
}

TEST(ObservationVarianceTest, GrowsWithLowElevationAndWeakSignal) {
  const double zenith = ObservationVariance(0.7, M_PI / 2, 45, {});
  EXPECT_NEAR(zenith, 0.49, 1e-12);
  EXPECT_NEAR(ObservationVariance(0.7, M_PI / 6, 45, {}) / zenith, 2.5, 1e-9);
  EXPECT_NEAR(ObservationVariance(0.7, M_PI / 2, 35, {}) / zenith, 10, 1e-9);
  EXPECT_NEAR(ObservationVariance(0.7, M_PI / 2, 0, {}) / zenith, 1, 1e-9) << "not reported";
  EXPECT_NEAR(ObservationVariance(0.7, M_PI / 2, 25, 3.0), 9, 1e-9) << "the receiver's own deviation";
  EXPECT_LT(ObservationVariance(0.7, -1, 1, {}), 1e6);
}

}  // namespace
}  // namespace alidade
