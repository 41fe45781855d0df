#include "gnss/positioning/time_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gnss/model/synthetic_sky.h"

namespace alidade {
namespace {

using testing::HasSubstr;

constexpr TimeNs kStamp = 1'593'043'200 * kSecondNs;

/// Twenty epochs of a moving receiver, their tags shifted.
GnssLog MakeLog(TimeNs tag_shift_ns, TimeNs ephemeris_shift_ns = 0) {
  GnssLog log;
  const NavigationData sky = test::SyntheticSky(kStamp);
  for (int i = 0; i < 20; ++i) {
    test::SyntheticReceiver receiver;
    receiver.stamp_ns = kStamp + i * kSecondNs;
    receiver.position_E += Eigen::Vector3d(3 * i, -2 * i, i);
    receiver.velocity_E = {3, -2, 1};
    receiver.clock_m = -271'828.18;
    receiver.galileo_bias_m = 6.5;
    ObservationEpoch epoch = test::Observe(sky, receiver);
    epoch.stamp_ns += tag_shift_ns;
    log.epochs.push_back(epoch);
  }
  log.catalog = std::make_shared<SatelliteCatalog>(test::SyntheticSky(kStamp + ephemeris_shift_ns));
  return log;
}

TEST(GnssTimeCheckTest, GIVEN_tags_in_GPST_THEN_nothing_is_found) {
  EXPECT_TRUE(CheckTags(MakeLog(0)).ok()) << CheckTags(MakeLog(0)).message();
  const GnssCoverage coverage = CheckCoverage(MakeLog(0));
  EXPECT_EQ(coverage.epochs, 8);
  EXPECT_EQ(coverage.usable_epochs, 8);
  EXPECT_NEAR(coverage.nearest_s, 600, 30);
}

TEST(GnssTimeCheckTest, GIVEN_tags_in_UTC_THEN_the_leap_seconds_are_found_and_named) {
  const Status status = CheckTags(MakeLog(-18 * kSecondNs));
  EXPECT_EQ(status.code(), StatusCode::kInput);
  EXPECT_THAT(status.message(), HasSubstr("need +18 s"));
  EXPECT_THAT(status.message(), HasSubstr("UTC"));
}

TEST(GnssTimeCheckTest, GIVEN_other_whole_seconds_THEN_they_are_found) {
  for (const int late_s : {18, -14, 19, 1, -37}) {
    const Status status = CheckTags(MakeLog(late_s * kSecondNs));
    EXPECT_EQ(status.code(), StatusCode::kInput) << late_s;
    EXPECT_THAT(status.message(), HasSubstr("need " + std::string(late_s < 0 ? "+" : "-") +
                                            std::to_string(std::abs(late_s)) + " s"));
  }
}

TEST(GnssTimeCheckTest, GIVEN_a_week_number_that_rolled_over_THEN_it_is_found_and_named) {
  for (const int periods : {-1, 1, -2}) {
    const Status status = CheckTags(MakeLog(periods * 1024 * kWeekNs));
    EXPECT_EQ(status.code(), StatusCode::kInput) << periods;
    EXPECT_THAT(status.message(), HasSubstr(std::to_string(-1024 * periods) + " weeks"));
  }
}

TEST(GnssTimeCheckTest, GIVEN_ephemerides_a_day_old_THEN_the_tags_pass_and_the_coverage_is_empty) {
  const GnssLog log = MakeLog(0, -kDayNs);
  EXPECT_TRUE(CheckTags(log).ok()) << CheckTags(log).message();
  const GnssCoverage coverage = CheckCoverage(log);
  EXPECT_EQ(coverage.usable_epochs, 0);
  EXPECT_GT(coverage.faults.no_ephemeris, 80);
  EXPECT_NEAR(coverage.nearest_s, 86400 + 600, 30);
}

TEST(GnssTimeCheckTest, GIVEN_reflected_signals_THEN_the_tags_are_not_blamed) {
  GnssLog log = MakeLog(0);
  for (ObservationEpoch& epoch : log.epochs) {
    for (std::size_t k = 0; k < epoch.satellites.size(); k += 2) {
      *epoch.satellites[k].signals[0].pseudorange_m += 100 + 20.0 * static_cast<double>(k);
    }
  }
  EXPECT_TRUE(CheckTags(log).ok()) << CheckTags(log).message();
}

TEST(GnssTimeCheckTest, GIVEN_no_epoch_or_no_ephemeris_THEN_nothing_is_found) {
  GnssLog log = MakeLog(0);
  log.catalog = std::make_shared<SatelliteCatalog>(NavigationData());
  EXPECT_TRUE(CheckTags(log).ok());
  log.epochs.clear();
  EXPECT_TRUE(CheckTags(log).ok());
  EXPECT_EQ(CheckCoverage(log).epochs, 0);
}

}  // namespace
}  // namespace alidade
