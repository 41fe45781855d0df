#include "eval/comparison/cell_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

constexpr double kThird = 1.0 / 3;

CellReport Report() {
  CellReport report;
  report.reused = true;
  report.digest = "d";
  report.frontend = FrontendSummary{"seq", 7, 12, 34, kThird, 5, 6.5, NAN, 0.25, 0, 1.5, 2.5};
  report.remarks = {"a remark", ""};
  CellResult& cell = report.result;
  cell.estimator = "filter";
  cell.backend = "filter";
  cell.sequence = "seq";
  cell.seed = 4'000'000'000u;
  cell.status = "ok";
  cell.frames = 3;
  cell.rmse_pos_m = kThird;
  cell.completion = kThird;
  cell.realtime_factor = 2 * kThird;
  cell.smoothed = true;
  cell.ate_pos_m = std::numeric_limits<double>::infinity();
  cell.rpe = {{8, 2, kThird, 0.5, {0.1, kThird}}, {16, 0, NAN, NAN, {}}};
  cell.truth_has_covariance = true;
  cell.innovations = {0.9, std::nullopt, std::pair<double, double>{0.5, kThird}};
  cell.restarts = 2;
  cell.series.regular = {true, false, true};
  cell.series.time_s = {0, 0.1, kThird};
  cell.series.position = {{1, 2, kThird}, {4, 5, 6}, {7, 8, 9}};
  cell.series.error.assign(3, Vector6d::Constant(kThird));
  cell.series.nis_ratio = {1, NAN, 2};
  cell.series.sensor_nis_ratio["fix"] = {kThird, NAN, 2};
  cell.sensor_innovations["fix"] = {kThird, 0.5, std::nullopt};
  cell.sky = {{"G07", {1}, {2}, {3}, {kThird}, 0.5, 1.25}};
  return report;
}

// GIVEN a report with every kind of value WHEN it is written, read and written again THEN the bytes are
// equal, and values are what they were.
TEST(CellFile, KeepsEveryBit) {
  const test::TemporaryFolder folder;
  const CellReport report = Report();
  ASSERT_TRUE(WriteCellFile(report, folder.File("sub/a.cbor")).ok());
  const Result<CellReport> read = ReadCellFile(folder.File("sub/a.cbor"));
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_TRUE(WriteCellFile(*read, folder.File("b.cbor")).ok());
  EXPECT_EQ(test::ReadFile(folder.File("sub/a.cbor")), test::ReadFile(folder.File("b.cbor")));
  const CellResult& cell = read->result;
  EXPECT_EQ(cell.seed, report.result.seed);
  EXPECT_EQ(cell.rmse_pos_m, kThird);
  EXPECT_EQ(cell.completion, kThird);
  EXPECT_EQ(cell.realtime_factor, 2 * kThird);
  EXPECT_TRUE(cell.smoothed);
  EXPECT_TRUE(std::isinf(*cell.ate_pos_m));
  EXPECT_FALSE(cell.ate_ori_deg);
  EXPECT_EQ(cell.rpe[0].pos_errors_m, report.result.rpe[0].pos_errors_m);
  EXPECT_TRUE(std::isnan(cell.rpe[1].pos_rmse_m));
  EXPECT_EQ(cell.innovations.band->second, kThird);
  EXPECT_FALSE(cell.innovations.inside);
  EXPECT_EQ(cell.series.sensor_nis_ratio.at("fix")[0], kThird);
  EXPECT_EQ(cell.sensor_innovations.at("fix").inside, 0.5);
  EXPECT_EQ(cell.series.regular, report.result.series.regular);
  EXPECT_EQ(cell.series.position[0], report.result.series.position[0]);
  EXPECT_EQ(cell.series.error[2], report.result.series.error[2]);
  EXPECT_EQ(cell.sky[0].satellite, "G07");
  EXPECT_EQ(read->frontend->features_per_frame, kThird);
  EXPECT_TRUE(read->reused);
  EXPECT_EQ(read->remarks, report.remarks);
}

TEST(CellFile, TheEndAloneIsTheSame) {
  const test::TemporaryFolder folder;
  CellReport report = Report();
  report.result.status = "failed";
  report.result.message = "why";
  ASSERT_TRUE(WriteCellFile(report, folder.File("a.cbor")).ok());
  const Result<CellEnd> end = ReadCellEnd(folder.File("a.cbor"));
  ASSERT_TRUE(end.ok()) << end.message();
  EXPECT_EQ(end->status, "failed");
  EXPECT_EQ(end->message, "why");
}

TEST(CellFile, GivenATornOrForeignFileThenTheErrorNamesIt) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteCellFile(Report(), folder.File("a.cbor")).ok());
  const std::string bytes = test::ReadFile(folder.File("a.cbor"));
  for (const size_t length : {size_t{0}, size_t{1}, bytes.size() / 2, bytes.size() - 1}) {
    folder.Write("torn.cbor", bytes.substr(0, length));
    const Result<CellReport> torn = ReadCellFile(folder.File("torn.cbor"));
    ASSERT_FALSE(torn.ok()) << length;
    EXPECT_THAT(torn.message(), HasSubstr("torn.cbor: not the result of a cell")) << length;
    EXPECT_FALSE(ReadCellEnd(folder.File("torn.cbor")).ok()) << length;
  }
  folder.Write("list.cbor", "\x81\x01");
  EXPECT_FALSE(ReadCellFile(folder.File("list.cbor")).ok());
  EXPECT_FALSE(ReadCellFile(folder.File("none.cbor")).ok());
}

}  // namespace
}  // namespace alidade
