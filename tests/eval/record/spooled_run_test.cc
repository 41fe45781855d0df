// Runs that keep neither their input nor their records in memory.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <map>

#include "eval/config/config_yaml.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/record/record_spool.h"
#include "eval/record/recorder.h"
#include "eval/record/run_health.h"
#include "eval/record/run_options.h"
#include "eval/record/runner.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

Dataset SimulateOf(const std::string& name, const std::vector<std::string>& settings) {
  const Result<SimulatorConfig> config =
      LoadSimulatorConfig(std::string(ALIDADE_SOURCE_DIR) + "/configs/datasets/" + name, settings);
  EXPECT_TRUE(config.ok()) << config.message();
  return Simulate(*config, 1).value();
}

EstimatorConfig Preset(const std::string& name, const std::vector<std::string>& settings) {
  const Result<EstimatorConfig> config = LoadEstimatorConfig(
      std::string(ALIDADE_SOURCE_DIR) + "/configs/estimators/" + name + ".yaml", settings);
  EXPECT_TRUE(config.ok()) << config.message();
  return *config;
}

/// All files of a run but those that hold times.
std::map<std::string, std::string> FilesOf(const EstimatorConfig& config, const Dataset& dataset,
                                           const std::string& spool_folder) {
  RunOptions options;
  options.truth = &*dataset.truth;
  options.spool_folder = spool_folder;
  const MeasurementLog log = MeasurementsOf(dataset);
  const RunResult result = RunEstimator(config, log, TablesOf(dataset), options);
  EXPECT_TRUE(result.status.ok()) << result.status.message();
  EXPECT_EQ(result.spool != nullptr, !spool_folder.empty());
  EXPECT_TRUE(spool_folder.empty() || RecordCount(result) > 2 * result.records.size());
  const test::TemporaryFolder folder;
  EXPECT_TRUE(WriteRun({config, "name", "dd", "ii", 1, 2, 3, false}, result, folder.path()).ok());
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    std::string text = test::ReadFile(entry.path().string());
    files[entry.path().filename().string()] = text.substr(0, text.find("\"times\""));
  }
  EXPECT_EQ(files.erase("timing.csv"), 1u);
  return files;
}

void ExpectTheSameFiles(const EstimatorConfig& config, const Dataset& dataset,
                        const std::vector<std::string>& expected) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteDataset(dataset, folder.File("seq")).ok());
  const Dataset held = ReadDataset(folder.File("seq")).value();
  const Dataset spooled = ReadDataset(folder.File("seq"), {folder.path(), config.init.max_wait_s}).value();
  const auto files = FilesOf(config, held, "");
  for (const std::string& name : expected) {
    EXPECT_EQ(files.count(name), 1u) << name;
  }
  const auto others = FilesOf(config, spooled, folder.path());
  ASSERT_EQ(files.size(), others.size());
  for (const auto& [name, text] : files) {
    EXPECT_TRUE(text == others.at(name)) << name << " differs";
  }
}

class SpooledRun : public testing::TestWithParam<const char*> {};

// GIVEN a run that calibrates, THEN its files are those of a run that is held in memory.
TEST_P(SpooledRun, WritesWhatARunInMemoryWrites) {
  const Dataset dataset = SimulateOf("figure8_short.yaml", {"duration_s=20", "path_m=26"});
  const EstimatorConfig config = Preset(
      "alidade_filter", {std::string("backend=") + GetParam(), "init.method=truth", "smoother.window=6",
                         "calibration.watch=false", "calibration.time_offset=true"});
  ExpectTheSameFiles(config, dataset, {"states.csv", "calibration.csv", "covariance.csv", "status.csv"});
}

// The same with an alignment, which turns what was reported before it, after more records than memory holds.
TEST_P(SpooledRun, TurnsWhatItHasPutAway) {
  const Dataset dataset =
      SimulateOf("gnss_figure8_short.yaml", {"duration_s=20", "path_m=83", "gnss.rate_hz=2"});
  const EstimatorConfig config =
      Preset("gvio", {std::string("backend=") + GetParam(), "init.method=truth", "gnss.model_std_scale=0",
                      "gnss.pseudorange_std_m=0.5", "smoother.window=6", "gnss.align_min_epochs=20"});
  ExpectTheSameFiles(config, dataset, {"states.csv", "trajectory.pos", "gnss.csv", "status.csv"});
}

// GIVEN a run that calibrates WHEN an alignment turns the records that were put away, and with them goes the
// calibration that the first one had, THEN its calibration is written all the same.
TEST(SpooledRun, KeepsTheCalibrationOfRecordsThatAreTurned) {
  const test::TemporaryFolder folder;
  const EstimatorConfig config =
      Preset("alidade_filter", {"calibration.watch=false", "calibration.time_offset=true"});
  RunResult result;
  result.spool = std::make_shared<RecordSpool>(folder.path());
  for (int i = 0; i < 3; ++i) {
    RunRecord record;
    record.estimate.stamp_ns = i + 1;
    record.status = "local";
    record.calibration = InitialCalibration(config.calibration, CameraCalibration());
    ASSERT_TRUE(result.spool->Add(record).ok());
  }
  const std::string columns = CalibrationColumns(*result.spool->records().front().calibration);
  ASSERT_TRUE(result.spool->Turn(GnssAlignment()).ok());
  ASSERT_TRUE(WriteRun({config, "name", "dd", "ii", 1, 2, 3, false}, result, folder.File("run")).ok());
  const std::string text = test::ReadFile(folder.File("run/calibration.csv"));
  EXPECT_THAT(text, testing::StartsWith("timestamp_ns" + columns + "\n1,"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4);
}

// GIVEN states that are degraded by the model WHEN their records are put away THEN they count as such.
TEST(SpooledRun, KeepsWhyAStateIsDegraded) {
  const test::TemporaryFolder folder;
  RunResult result;
  result.spool = std::make_shared<RecordSpool>(folder.path());
  for (const DegradationKind kind :
       {DegradationKind::kData, DegradationKind::kModel, DegradationKind::kModel}) {
    RunRecord record;
    record.status = "degraded";
    record.degradation = kind;
    ASSERT_TRUE(result.spool->Add(record).ok());
  }
  const RunHealth health = HealthOf(EstimatorConfig(), result);
  EXPECT_EQ(health.states.at("degraded"), 3u);
  EXPECT_EQ(health.doubted, 2u);
}

/// Bytes in use, by whatever kind of allocation.
size_t HeapInUse() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

// GIVEN a recording of a minute in files, THEN the memory in use after two thirds of the run and at its end
// differs by less than ten frames of tracks take.
TEST_P(SpooledRun, HoldsItsMemory) {
  const test::TemporaryFolder folder;
  {
    const Dataset dataset = SimulateOf("figure8_short.yaml", {"duration_s=60", "path_m=79"});
    ASSERT_TRUE(WriteDataset(dataset, folder.File("seq")).ok());
  }
  const EstimatorConfig config = Preset(
      "po_invio_two", {std::string("backend=") + GetParam(), "init.method=truth", "smoother.window=5"});
  const Dataset dataset = ReadDataset(folder.File("seq"), {folder.path(), 10}).value();
  const MeasurementLog log = MeasurementsOf(dataset);
  // Peaks over a tenth of the run: a frame's own memory comes and goes.
  std::vector<size_t> tenths(11);
  RunOptions options;
  options.truth = &*dataset.truth;
  options.spool_folder = folder.path();
  options.progress = [&tenths](size_t done, size_t total) {
    size_t& peak = tenths[10 * done / total];
    peak = std::max(peak, HeapInUse());
  };
  const RunResult result = RunEstimator(config, log, TablesOf(dataset), options);
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  const size_t middle = *std::max_element(tenths.begin() + 2, tenths.begin() + 6);
  const size_t end = *std::max_element(tenths.begin() + 6, tenths.begin() + 10);
  EXPECT_LT(end, middle + 100'000);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, SpooledRun, testing::Values("filter", "smoother"));

TEST(SpooledRun, GivenNoRoomThenTheRunEndsWithAnError) {
  const Dataset dataset = SimulateOf("figure8_short.yaml", {"duration_s=60", "path_m=79"});
  RunOptions options;
  options.truth = &*dataset.truth;
  options.spool_folder = "/proc/self/none";
  const RunResult result =
      RunEstimator(Preset("po_invio_two", {"init.method=truth"}), MeasurementsOf(dataset), options);
  EXPECT_EQ(result.status.code(), StatusCode::kOutput);
  EXPECT_THAT(result.status.message(), testing::HasSubstr("/proc/self/none: no temporary file can be made"));
}

}  // namespace
}  // namespace alidade
