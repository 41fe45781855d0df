#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/robust.h"
#include "filter/filter_estimator.h"
#include "gnss/model/gnss_epoch.h"
#include "tests/gnss/model/synthetic_sky.h"
#include "tests/support/fix_scenario.h"

namespace alidade::test {
namespace {

class FixFilterTest : public testing::TestWithParam<ErrorConvention> {};

// GIVEN fixes between frames, a tenth of them wrong, WHEN the filter takes them, THEN the wrong ones are
// refused, the innovations fit and so do the poses.
TEST_P(FixFilterTest, RefusesWrongFixesAndIsConsistent) {
  SimulatorConfig scene = FixScene();
  scene.fix.wrong_rate = 0.1;
  EstimatorConfig config;
  config.filter.error = GetParam();
  config.filter.update = UpdateTiming::kDelayedAll;
  config.filter.clone_policy = ClonePolicy::kOldest;
  config.filter.window = 10;
  int used = 0;
  int gated = 0;
  int wrong = 0;
  double nis = 0;
  double nees = 0;
  constexpr unsigned kRuns = 4;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Dataset dataset = SimulateOrDie(scene, seed);
    FilterEstimator filter(config, dataset.rig);
    RunWithFixes(dataset, DrawInitialState(dataset, 3), &filter, [&](const PositionFix& fix) {
      const SensorStatistics& counts = filter.last_statistics().sensors[SensorOf<PositionFixEntry>()];
      used += counts.used;
      gated += counts.gated;
      nis += counts.nis;
      const NavState& nav = filter.state().nav();
      wrong += (nav.p_WB + nav.R_WB * dataset.rig.fixes[0].p_BA - fix.p_A).norm() > 5 ? 1 : 0;
      EXPECT_EQ(filter.Latest().stamp_ns, fix.stamp_ns);
    });
    const NavEstimate last = filter.Latest();
    const Vector6d error =
        Local(ErrorConvention::kSo3xRn, last.nav, TruthAt(dataset, last.stamp_ns).nav).head<6>();
    nees += error.dot(last.covariance.topLeftCorner<6, 6>().ldlt().solve(error));
    EXPECT_LT((last.covariance.block<3, 3>(3, 3).trace()), 3 * 0.1 * 0.1);
  }
  EXPECT_GE(wrong, 8);
  EXPECT_GE(gated, wrong);
  EXPECT_LE(gated, wrong + 2) << "a thousandth of the right ones";
  EXPECT_NEAR(nis / (3 * used), 1, 4 * std::sqrt(2.0 / (3 * used)));
  EXPECT_LT(nees, ChiSquareQuantile(6 * kRuns, 0.999));
}

INSTANTIATE_TEST_SUITE_P(Conventions, FixFilterTest,
                         testing::Values(ErrorConvention::kRightInvariant, ErrorConvention::kLeftInvariant,
                                         ErrorConvention::kSo3xRn),
                         [](const auto& convention) { return std::string(ToString(convention.param)); });

Dataset ShortWalkWithFixes() {
  SimulatorConfig scene;
  scene.duration_s = 2;
  scene.path_m = 4;
  scene.max_features = 10;
  scene.fix.rate_hz = 10;
  return SimulateOrDie(scene, 1);
}

void StartWithAllSamples(const Dataset& dataset, const NavEstimate& start, FilterEstimator* filter) {
  ASSERT_TRUE(filter->Initialize(start).ok());
  for (const ImuSample& sample : dataset.imu) {
    ASSERT_TRUE(filter->AddImu(sample).ok());
  }
}

TEST(FixFilter, GIVEN_what_is_no_fix_for_it_THEN_the_filter_says_why_and_is_as_before) {
  const Dataset dataset = ShortWalkWithFixes();
  FilterEstimator filter(EstimatorConfig(), dataset.rig);
  const NavEstimate start = DrawInitialState(dataset, 1);
  PositionFix fix = dataset.fixes.front();
  StartWithAllSamples(dataset, start, &filter);
  EXPECT_EQ(filter.AddMeasurement(fix).code(), StatusCode::kDiverged) << "not aligned";
  ASSERT_TRUE(filter.Align(IdentityAlignment(start.stamp_ns)).ok());
  EXPECT_FALSE(filter.LatestClock());
  PositionFix bad = fix;
  bad.sensor = 1;
  EXPECT_EQ(filter.AddMeasurement(bad).code(), StatusCode::kInput);
  bad = fix;
  bad.covariance.setZero();
  EXPECT_EQ(filter.AddMeasurement(bad).code(), StatusCode::kInput);
  bad = fix;
  bad.stamp_ns = start.stamp_ns - 1;
  EXPECT_EQ(filter.AddMeasurement(bad).code(), StatusCode::kInput);
  EXPECT_EQ(filter.Latest().nav.p_WB, start.nav.p_WB);
  EXPECT_TRUE(filter.AddMeasurement(fix).ok());
  EXPECT_NE(filter.Latest().nav.p_WB, start.nav.p_WB);
  ASSERT_TRUE(filter.Initialize(start).ok());
  EXPECT_EQ(filter.AddMeasurement(fix).code(), StatusCode::kDiverged)
      << "a new start stands in a local world";
}

// GIVEN fixes so far away that the square of their distance is no number any more, WHEN more of them come
// than are refused in a row before the state is suspect, THEN each is refused and the state is as before.
TEST(FixFilter, AnAbsurdFixIsRefusedHoweverOftenItComes) {
  const Dataset dataset = ShortWalkWithFixes();
  const EstimatorConfig config;
  FilterEstimator filter(config, dataset.rig);
  const NavEstimate start = DrawInitialState(dataset, 1);
  StartWithAllSamples(dataset, start, &filter);
  ASSERT_TRUE(filter.Align(IdentityAlignment(start.stamp_ns)).ok());
  ASSERT_TRUE(filter.AddMeasurement(dataset.fixes.front()).ok());
  const NavEstimate before = filter.Latest();
  for (const double far_m : {1e200, -1e200, 1e300}) {
    PositionFix absurd = dataset.fixes.front();
    absurd.p_A = Eigen::Vector3d(far_m, -0.5 * far_m, 0.1 * far_m);
    for (int i = 0; i <= config.fix.max_refused_run; ++i) {
      ASSERT_TRUE(filter.AddMeasurement(absurd).ok()) << far_m;
      const SensorStatistics& counts = filter.last_statistics().sensors[SensorOf<PositionFixEntry>()];
      EXPECT_EQ(counts.gated, 1) << far_m;
      EXPECT_EQ(counts.used, 0) << far_m;
      const NavEstimate after = filter.Latest();
      ASSERT_TRUE(after.covariance.allFinite()) << far_m;
      EXPECT_EQ(after.stamp_ns, before.stamp_ns);
      EXPECT_LT((after.nav.p_WB - before.nav.p_WB).norm(), 1e-12);
      EXPECT_LT((after.nav.v_WB - before.nav.v_WB).norm(), 1e-12);
      EXPECT_LT((after.nav.R_WB - before.nav.R_WB).norm(), 1e-12);
      EXPECT_EQ(after.bias.gyro, before.bias.gyro);
      EXPECT_EQ(after.bias.accel, before.bias.accel);
      EXPECT_LT((after.covariance - before.covariance).norm(), 1e-12 * before.covariance.norm());
    }
  }
}

/// Keeps the update of position fixes by dense algebra.
class DenseUpdate : public FilterObserver {
 public:
  void OnUpdate(const FilterState& state, const FilterRows& rows) override {
    if (rows.source != RowSource::kMeasurement) {
      return;
    }
    const Eigen::MatrixXd covariance = state.covariance().Covariance();
    const Eigen::MatrixXd crossed = covariance * rows.jacobian.transpose();
    Eigen::MatrixXd innovation = rows.jacobian * crossed;
    innovation.diagonal().array() += 1;
    const Eigen::VectorXd correction = crossed * innovation.ldlt().solve(rows.innovation);
    clock = correction.segment<6>(state.ClockOffset());
  }
  Vector6d clock = Vector6d::Zero();
};

// GIVEN a clock that an epoch has correlated with the position, WHEN a fix moves the position, THEN the clock
// moves with it.
TEST(FixFilter, AFixCorrectsTheReceiversClock) {
  constexpr TimeNs sky_ns = 1'700'000'100 * kSecondNs;
  const NavigationData sky = SyntheticSky(sky_ns);
  EstimatorConfig config;
  config.gnss.enabled = true;
  config.gnss.corrections.ionosphere = IonosphereMode::kNone;
  const auto builder = std::make_shared<const MeasurementBuilder>(std::make_shared<SatelliteCatalog>(sky),
                                                                  config.gnss.corrections);
  SyntheticReceiver receiver;
  receiver.stamp_ns = sky_ns;
  GnssEpoch epoch;
  epoch.measurements = builder->Prepare(Observe(sky, receiver));
  epoch.stamp_ns = sky_ns;
  epoch.builder = builder;
  SimulatorConfig scene;
  scene.duration_s = 1;
  scene.path_m = 1;
  scene.fix.rate_hz = 1;
  RigCalibration rig = SimulateOrDie(scene, 1).rig;
  rig.gnss = GnssReceiver();
  FilterEstimator filter(config, rig);
  DenseUpdate dense;
  filter.SetObserver(&dense);
  NavEstimate start;
  start.stamp_ns = sky_ns;
  start.covariance = Matrix15d::Identity();
  ASSERT_TRUE(filter.Initialize(start).ok());
  for (int i = 0; i <= 20; ++i) {
    ASSERT_TRUE(filter.AddImu({sky_ns + i * 10'000'000LL, Eigen::Vector3d::Zero(), {0, 0, 9.81}}).ok());
  }
  GnssAlignment alignment = IdentityAlignment(sky_ns);
  alignment.enu = EnuFrame::At(receiver.position_E);
  alignment.clock = Vector6d::Zero();
  (*alignment.clock)[ClockState::kClock] = receiver.clock_m;
  ASSERT_TRUE(filter.Align(alignment).ok());
  ASSERT_TRUE(filter.AddGnss(epoch).ok());
  ASSERT_GT(filter.last_statistics().satellites_used, 4);
  const Vector6d before = filter.LatestClock()->mean;
  const Eigen::Vector3d p_BA = rig.fixes[0].p_BA;
  PositionFix fix{sky_ns, 0, filter.Latest().nav.p_WB + p_BA + Eigen::Vector3d(0, 0, 1.5),
                  1e-4 * Eigen::Matrix3d::Identity()};
  ASSERT_TRUE(filter.AddMeasurement(fix).ok());
  const Vector6d moved = filter.LatestClock()->mean - before;
  EXPECT_GT(dense.clock.norm(), 0.1);
  EXPECT_LT((moved - dense.clock).norm(), 1e-6 * dense.clock.norm());
}

}  // namespace
}  // namespace alidade::test
