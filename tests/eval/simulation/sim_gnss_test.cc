#include "eval/simulation/sim_gnss.h"

#include <gtest/gtest.h>

#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/dataset/digest.h"
#include "eval/simulation/simulator.h"
#include "gnss/model/gnss_epoch.h"
#include "gnss/positioning/single_point.h"
#include "gnss/positioning/single_point_solution.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

SimulatorConfig Config() {
  SimulatorConfig config;
  config.start_time_s = 1'700'000'000;
  config.duration_s = 6;
  config.path_m = 12;
  config.landmark_count = 10;
  config.gnss.rate_hz = 2;
  return config;
}

Dataset Simulated(const SimulatorConfig& config, unsigned seed = 1) {
  Result<Dataset> dataset = Simulate(config, seed);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  return *std::move(dataset);
}

MeasurementLog LogOf(const Dataset& dataset) {
  return {dataset.rig, dataset.imu, dataset.frames, {}, dataset.gnss};
}

TEST(SimGnssTest, WHEN_written_and_read_THEN_the_log_is_the_same) {
  test::TemporaryFolder folder;
  SimulatorConfig config = Config();
  config.gnss.second_band = true;
  config.gnss.time_offset_s = 0.25;
  const Dataset dataset = Simulated(config);
  ASSERT_TRUE(WriteDataset(dataset, folder.File("seq")).ok());
  const Result<Dataset> read = ReadDataset(folder.File("seq"));
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_NE(read->gnss, nullptr);
  EXPECT_EQ(read->gnss->epochs.size(), dataset.gnss->epochs.size());
  EXPECT_EQ(DigestOf(LogOf(*read)), DigestOf(LogOf(dataset)));
  MeasurementLog without = LogOf(dataset);
  without.gnss = nullptr;
  EXPECT_NE(DigestOf(without), DigestOf(LogOf(dataset)));
}

// gnss_comm's readers weigh by URA - 1 (GPS, BeiDou) and SISA - 2 (Galileo): they need more than that.
TEST(SimGnssTest, WHEN_ephemerides_are_written_THEN_their_accuracy_can_be_weighed) {
  const Dataset dataset = Simulated(Config());
  int seen = 0;
  for (const auto& [satellite, list] : dataset.gnss->catalog->navigation().kepler) {
    for (const KeplerEphemeris& ephemeris : list) {
      EXPECT_GT(ephemeris.accuracy_m, satellite.system == GnssSystem::kGalileo ? 2 : 1)
          << ToString(satellite);
      EXPECT_LT(ephemeris.accuracy_m, 5) << ToString(satellite);
      ++seen;
    }
  }
  EXPECT_GE(seen, 3 * 24);
}

// GIVEN no noise, THEN the single-point solution stands where the antenna is, and moves as it does.
TEST(SimGnssTest, GIVEN_no_noise_THEN_single_points_are_the_truth) {
  SimulatorConfig config = Config();
  config.gnss.pseudorange_noise_m = 0;
  config.gnss.range_rate_noise_mps = 0;
  const Dataset dataset = Simulated(config);
  const GnssLog& log = *dataset.gnss;
  SinglePointSolver solver(MeasurementBuilder(log.catalog, {}, log.glonass_channels), {});
  const EnuFrame enu = EnuFrame::At(*dataset.rig.gnss.anchor_E);
  ASSERT_GE(log.epochs.size(), 8u);
  for (const ObservationEpoch& epoch : log.epochs) {
    const Result<SinglePointSolution> solution = solver.Solve(epoch);
    ASSERT_TRUE(solution.ok()) << solution.message();
    EXPECT_GE(solution->used, 15);
    const TrajectoryPoint* nearest = &dataset.truth->points.front();
    for (const TrajectoryPoint& point : dataset.truth->points) {
      if (std::abs(point.stamp_ns - solution->stamp_ns) < std::abs(nearest->stamp_ns - solution->stamp_ns)) {
        nearest = &point;
      }
    }
    const NavState& nav = nearest->nav;
    const double late_s = SecondsBetween(nearest->stamp_ns, solution->stamp_ns);
    const Eigen::Vector3d antenna_N = nav.p_WB + late_s * nav.v_WB + nav.R_WB * config.gnss.lever_arm_m;
    EXPECT_LT((enu.FromEcef(solution->position_E) - antenna_N).norm(), 0.02);
  }
}

TEST(SimGnssTest, WHEN_an_effect_is_switched_on_THEN_the_numbers_of_others_stay) {
  SimulatorConfig config = Config();
  const Dataset clean = Simulated(config);
  config.gnss.nlos_rate = 0.2;
  const Dataset reflected = Simulated(config);
  int same = 0;
  int longer = 0;
  for (std::size_t k = 0; k < clean.gnss->epochs.size(); ++k) {
    const auto& a = clean.gnss->epochs[k].satellites;
    const auto& b = reflected.gnss->epochs[k].satellites;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double extra = *b[i].signals[0].pseudorange_m - *a[i].signals[0].pseudorange_m;
      (extra == 0 ? same : longer) += 1;
      EXPECT_TRUE(extra == 0 || (extra > 9.99 && extra < 80.01)) << extra;
    }
  }
  EXPECT_GT(longer, 0);
  EXPECT_GT(same, 2 * longer);
}

TEST(SimGnssTest, GIVEN_an_outage_THEN_the_highest_are_left) {
  SimulatorConfig config = Config();
  config.gnss.outage_start_s = 3;
  config.gnss.outage_satellites = 2;
  const Dataset dataset = Simulated(config);
  EXPECT_GT(dataset.gnss->epochs.front().satellites.size(), 15u);
  EXPECT_EQ(dataset.gnss->epochs.back().satellites.size(), 2u);
}

TEST(SimGnssTest, GIVEN_a_start_before_GPST_THEN_the_key_is_named) {
  SimulatorConfig config = Config();
  config.start_time_s = 1000;
  const Result<Dataset> dataset = Simulate(config, 1);
  ASSERT_FALSE(dataset.ok());
  EXPECT_NE(dataset.message().find("start_time_s"), std::string::npos) << dataset.message();
}

TEST(SimGnssTest,
     GIVEN_stale_ephemerides_THEN_they_are_of_the_day_before_and_the_epochs_as_without_the_fault) {
  SimulatorConfig config = Config();
  const Dataset clean = Simulated(config);
  config.fault = SimFaultKind::kStaleEphemerides;
  const Dataset stale = Simulated(config);
  const auto& before = clean.gnss->catalog->navigation();
  const auto& after = stale.gnss->catalog->navigation();
  ASSERT_EQ(after.kepler.size(), before.kepler.size());
  ASSERT_EQ(after.glonass.size(), before.glonass.size());
  for (const auto& [satellite, list] : before.kepler) {
    EXPECT_EQ(after.kepler.at(satellite).front().toe_ns, list.front().toe_ns - kDayNs);
  }
  for (const auto& [number, list] : before.glonass) {
    EXPECT_EQ(after.glonass.at(number).front().toe_ns, list.front().toe_ns - kDayNs);
  }
  MeasurementLog log = LogOf(stale);
  auto same = std::make_shared<GnssLog>(*stale.gnss);
  same->catalog = clean.gnss->catalog;
  log.gnss = same;
  EXPECT_EQ(DigestOf(log), DigestOf(LogOf(clean)));
}

TEST(SimGnssTest, GIVEN_no_simulated_ephemerides_THEN_stale_ones_are_refused) {
  SimulatorConfig config = Config();
  config.fault = SimFaultKind::kStaleEphemerides;
  EXPECT_TRUE(config.Validate().ok());
  config.gnss.rate_hz = 0;
  EXPECT_EQ(config.Validate().code(), StatusCode::kConfig);
}

}  // namespace
}  // namespace alidade
