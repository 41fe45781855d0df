#include "eval/run/gnss_feed.h"

#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {
namespace {

Dataset SimulateGnss() {
  SimulatorConfig config;
  config.duration_s = 4;
  config.path_m = 5;
  config.gnss.rate_hz = 2;
  config.start_time_s = 1'700'000'000;
  Result<Dataset> dataset = Simulate(config, 1);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  return *dataset;
}

// GIVEN epochs of which each second one comes before the one before it, and the first of a pair was prepared
// already, THEN the feed gives the epochs of the ordered log, bit by bit.
TEST(GnssFeedTest, TheOrderOfArrivalDoesNotMatter) {
  const Dataset dataset = SimulateGnss();
  const auto& epochs = dataset.gnss->epochs;
  ASSERT_GE(epochs.size(), 4u);
  const auto at = [&](size_t i) { return std::shared_ptr<const ObservationEpoch>(dataset.gnss, &epochs[i]); };
  GnssFeed ordered(GnssConfig(), SetupOf(*dataset.gnss), 0);
  GnssFeed swapped(GnssConfig(), SetupOf(*dataset.gnss), 0);
  for (size_t i = 0; i + 1 < epochs.size(); i += 2) {
    for (const size_t k : {i, i + 1}) {
      EXPECT_EQ(ordered.Add(at(k)), GnssFeed::Arrival::kTaken);
    }
    EXPECT_EQ(swapped.Add(at(i + 1)), GnssFeed::Arrival::kTaken);
    ASSERT_EQ(swapped.Next()->measurements.tag_ns, epochs[i + 1].stamp_ns);
    EXPECT_EQ(swapped.Add(at(i)), GnssFeed::Arrival::kTaken);
    for (const size_t k : {i, i + 1}) {
      const GnssEpoch* expected = ordered.Next();
      const GnssEpoch* found = swapped.Next();
      ASSERT_TRUE(expected != nullptr && found != nullptr);
      EXPECT_EQ(found->measurements.tag_ns, epochs[k].stamp_ns);
      EXPECT_EQ(found->stamp_ns, expected->stamp_ns);
      ASSERT_TRUE(ordered.solution() && swapped.solution());
      EXPECT_EQ(swapped.solution()->position_E, ordered.solution()->position_E);
      ordered.Pop();
      swapped.Pop();
    }
  }
  EXPECT_EQ(swapped.Add(at(0)), GnssFeed::Arrival::kTooLate);
}

// GIVEN a receiver whose time is behind the IMU's, THEN an epoch's stamp is its true time and the offset, and
// a correction of the offset moves the epoch at hand and those after it.
TEST(GnssFeedTest, StampsContainTheTimeOffset) {
  const Dataset dataset = SimulateGnss();
  const auto& epochs = dataset.gnss->epochs;
  ASSERT_GE(epochs.size(), 4u);
  GnssFeed feed(GnssConfig(), SetupOf(*dataset.gnss), 0.25);
  for (size_t i = 0; i < 4; ++i) {
    feed.Add(std::shared_ptr<const ObservationEpoch>(dataset.gnss, &epochs[i]));
    ASSERT_TRUE(feed.Next() != nullptr && feed.solution());
    if (i == 2) {
      feed.ShiftTime(-0.05);
    }
    EXPECT_EQ(feed.Next()->measurements.tag_ns, epochs[i].stamp_ns);
    EXPECT_EQ(feed.Next()->stamp_ns, feed.solution()->stamp_ns + SecondsToNs(i < 2 ? 0.25 : 0.2)) << i;
    feed.Pop();
  }
}

// GIVEN reflections, THEN the satellites that the single-point solution refuses are marked, as far as errors
// are measured.
TEST(GnssFeedTest, ContradictedSatellitesAreMarked) {
  const Dataset dataset = SimulateGnss();
  ObservationEpoch epoch = dataset.gnss->epochs[0];
  const std::set<SatelliteId> reflected = {epoch.satellites[1].satellite, epoch.satellites[6].satellite};
  for (SatelliteObservation& observed : epoch.satellites) {
    if (reflected.contains(observed.satellite)) {
      *observed.signals[0].pseudorange_m += 60;
    }
  }
  for (const bool lasting_errors : {true, false}) {
    GnssConfig config;
    config.lasting_errors = lasting_errors;
    GnssFeed feed(config, SetupOf(*dataset.gnss), 0);
    feed.Add(std::make_shared<ObservationEpoch>(epoch));
    ASSERT_TRUE(feed.Next() != nullptr && feed.solution());
    std::set<SatelliteId> marked;
    for (const SatelliteMeasurement& satellite : feed.Next()->measurements.satellites) {
      if (satellite.contradicted) {
        marked.insert(satellite.satellite);
      }
    }
    EXPECT_EQ(marked, lasting_errors ? reflected : std::set<SatelliteId>());
  }
}

TEST(GnssFeedTest, SecondEpochOfATagIsRefused) {
  const Dataset dataset = SimulateGnss();
  GnssFeed feed(GnssConfig(), SetupOf(*dataset.gnss), 0);
  const std::shared_ptr<const ObservationEpoch> epoch(dataset.gnss, &dataset.gnss->epochs[0]);
  EXPECT_EQ(feed.Add(epoch), GnssFeed::Arrival::kTaken);
  EXPECT_EQ(feed.Add(epoch), GnssFeed::Arrival::kTwice);
}

TEST(GnssFeedTest, ACatalogCountsFromItsFirstTag) {
  const Dataset dataset = SimulateGnss();
  const auto& epochs = dataset.gnss->epochs;
  GnssSetup setup = SetupOf(*dataset.gnss);
  setup.catalog = nullptr;
  GnssFeed feed(GnssConfig(), setup, 0);
  for (const ObservationEpoch& epoch : epochs) {
    feed.Add(std::shared_ptr<const ObservationEpoch>(dataset.gnss, &epoch));
  }
  ASSERT_NE(feed.Next(), nullptr);
  EXPECT_TRUE(feed.Next()->measurements.satellites.empty());
  feed.AddCatalog(epochs[1].stamp_ns, dataset.gnss->catalog);
  EXPECT_FALSE(feed.Next() != nullptr && feed.solution());
  feed.Pop();
  EXPECT_TRUE(feed.Next() != nullptr && feed.solution());
  EXPECT_FALSE(feed.Next()->measurements.satellites.empty());
}

}  // namespace
}  // namespace alidade
