#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "eval/config/config_yaml.h"
#include "eval/record/runner.h"
#include "eval/run/gnss_feed.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"

// Orbits and clocks of the satellites are computed once an epoch.

namespace alidade {
namespace {

/// Counts the evaluations of a satellite for a receiver's tag.
class CountingCatalog : public SatelliteCatalog {
 public:
  using SatelliteCatalog::SatelliteCatalog;

  [[nodiscard]] SatelliteFix AtTransmission(SatelliteId satellite, SignalCode signal, TimeNs tag_ns,
                                            double pseudorange_m, bool ionosphere_free) const override {
    ++counts_[{tag_ns, satellite}];
    return SatelliteCatalog::AtTransmission(satellite, signal, tag_ns, pseudorange_m, ionosphere_free);
  }

  [[nodiscard]] const std::map<std::pair<TimeNs, SatelliteId>, int>& counts() const { return counts_; }

 private:
  mutable std::map<std::pair<TimeNs, SatelliteId>, int> counts_;
};

/// A log with GNSS whose catalog counts.
struct CountedLog {
  Dataset dataset;
  std::shared_ptr<const CountingCatalog> catalog;
};

CountedLog Simulated() {
  const Result<SimulatorConfig> config =
      LoadSimulatorConfig(std::string(ALIDADE_SOURCE_DIR) + "/configs/datasets/gnss_figure8_short.yaml",
                          {"duration_s=12", "path_m=48"});
  EXPECT_TRUE(config.ok()) << config.message();
  Result<Dataset> dataset = Simulate(*config, 1);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  CountedLog log{*std::move(dataset), nullptr};
  auto gnss = std::make_shared<GnssLog>(*log.dataset.gnss);
  log.catalog = std::make_shared<const CountingCatalog>(gnss->catalog->navigation());
  gnss->catalog = log.catalog;
  log.dataset.gnss = gnss;
  return log;
}

void ExpectOneEvaluationEach(const CountedLog& log, std::size_t least_epochs) {
  std::map<TimeNs, int> satellites;
  for (const auto& [of, count] : log.catalog->counts()) {
    EXPECT_EQ(count, 1) << ToString(of.second) << " at " << of.first;
    ++satellites[of.first];
  }
  EXPECT_GE(satellites.size(), least_epochs);
  for (const auto& [tag_ns, count] : satellites) {
    EXPECT_GE(count, 5) << tag_ns;
  }
}

TEST(GnssOrbitsTest, GIVEN_epochs_that_are_looked_at_several_times_THEN_the_feed_evaluates_orbits_once) {
  const CountedLog log = Simulated();
  GnssFeed feed(GnssConfig(), SetupOf(*log.dataset.gnss), 0);
  for (const ObservationEpoch& epoch : log.dataset.gnss->epochs) {
    feed.Add(std::shared_ptr<const ObservationEpoch>(log.dataset.gnss, &epoch));
  }
  while (feed.Next() != nullptr) {
    ASSERT_TRUE(feed.Next() != nullptr && feed.solution());
    feed.Pop();
  }
  ExpectOneEvaluationEach(log, log.dataset.gnss->epochs.size());
}

class GnssOrbitsRunTest : public testing::TestWithParam<const char*> {};

// GIVEN a run that aligns with GNSS and goes on with it, THEN aligner, single points, back end and its
// iterations share one evaluation a satellite and epoch.
TEST_P(GnssOrbitsRunTest, OrbitsAreEvaluatedOnceAnEpoch) {
  const Result<EstimatorConfig> config = LoadEstimatorConfig(
      std::string(ALIDADE_SOURCE_DIR) + "/configs/estimators/" + GetParam() + ".yaml", {"init.method=truth"});
  ASSERT_TRUE(config.ok()) << config.message();
  const CountedLog log = Simulated();
  const Dataset& dataset = log.dataset;
  const RunResult run =
      RunEstimator(*config, {dataset.rig, dataset.imu, dataset.frames, {}, dataset.gnss}, &*dataset.truth, 1);
  ASSERT_TRUE(run.status.ok()) << run.status.message();
  ASSERT_TRUE(run.global.has_value()) << run.align_report;
  int used = 0;
  for (const RunRecord& record : run.records) {
    used += record.statistics.satellites_used;
  }
  EXPECT_GT(used, 100);
  ExpectOneEvaluationEach(log, dataset.gnss->epochs.size() - 5);  // all but those at the ends of the log
}

INSTANTIATE_TEST_SUITE_P(BothBackEnds, GnssOrbitsRunTest, testing::Values("gvio", "gvins_class"),
                         [](const auto& preset) { return std::string(preset.param); });

}  // namespace
}  // namespace alidade
