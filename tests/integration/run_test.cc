#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

std::vector<std::string> Presets() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(Source("configs/estimators"))) {
    names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// One short sequence for all tests of this file.
class Sequence {
 public:
  Sequence() {
    made_ = Alidade("simulate --config=" + Source("configs/datasets/figure8_short.yaml") +
                    " --set=duration_s=6,path_m=7.8 --output=" + folder_.File("seq") + " --quiet");
  }
  static const Sequence& Get() {
    static const Sequence sequence;
    return sequence;
  }
  [[nodiscard]] CommandResult Run(const std::string& preset, const std::string& output,
                                  const std::string& more = "") const {
    return Alidade("run --quiet --set=init.method=truth --dataset=" + folder_.File("seq") + " --config=" +
                   Source("configs/estimators/" + preset + ".yaml") + " --output=" + output + " " + more);
  }
  [[nodiscard]] const CommandResult& made() const { return made_; }
  [[nodiscard]] std::string path() const { return folder_.File("seq"); }

 private:
  TemporaryFolder folder_;
  CommandResult made_;
};

class EveryPreset : public testing::TestWithParam<std::string> {};

TEST_P(EveryPreset, SameInputsGiveSameBytes) {
  TemporaryFolder folder;
  const Sequence& sequence = Sequence::Get();
  ASSERT_EQ(sequence.made().code, 0) << sequence.made().output;
  const CommandResult first = sequence.Run(GetParam(), folder.File("a"));
  ASSERT_EQ(first.code, 0) << first.output;
  ASSERT_EQ(sequence.Run(GetParam(), folder.File("b")).code, 0);
  const auto a = ComparableFiles(folder.File("a"));
  EXPECT_EQ(a.size(), GetParam() == "batch" ? 6u : 5u);  // and bound.csv
  EXPECT_GT(a.at("states.csv").size(), 10000u);
  EXPECT_EQ(a, ComparableFiles(folder.File("b")));
}

INSTANTIATE_TEST_SUITE_P(Shipped, EveryPreset, testing::ValuesIn(Presets()),
                         [](const auto& preset) { return preset.param; });

TEST(Run, BackendSwitchLeavesTheInputDigestUnchanged) {
  TemporaryFolder folder;
  const Sequence& sequence = Sequence::Get();
  ASSERT_EQ(sequence.Run("alidade_filter", folder.File("filter"), "--backend filter").code, 0);
  ASSERT_EQ(sequence.Run("alidade_filter", folder.File("smoother"), "--backend=smoother").code, 0);
  const auto filter = nlohmann::json::parse(ReadFile(folder.File("filter/run.json")));
  const auto smoother = nlohmann::json::parse(ReadFile(folder.File("smoother/run.json")));
  EXPECT_EQ(filter["backend"], "filter");
  EXPECT_EQ(smoother["backend"], "smoother");
  EXPECT_EQ(filter["input_digest"], smoother["input_digest"]);
  EXPECT_EQ(filter["dataset_digest"], smoother["dataset_digest"]);
  EXPECT_NE(filter["config_digest"], smoother["config_digest"]);
  EXPECT_NE(ReadFile(folder.File("filter/states.csv")), ReadFile(folder.File("smoother/states.csv")));
}

TEST(Run, AuditTellsTheInvariantErrorFromTheOrdinaryOneAndRefusesTheSmoother) {
  TemporaryFolder folder;
  const Sequence& sequence = Sequence::Get();
  const auto last_rank = [&](const std::string& error) {
    const CommandResult run =
        sequence.Run("po_invio_multi", folder.File(error), "--audit --set=filter.error=" + error);
    EXPECT_EQ(run.code, 0) << run.output;
    const std::string table = ReadFile(folder.File(error + "/observability.csv"));
    const std::string row = table.substr(table.rfind('\n', table.size() - 2) + 1);
    return row.substr(row.find(',') + 1, 3);
  };
  EXPECT_EQ(last_rank("right_invariant"), "11,");
  EXPECT_EQ(last_rank("so3xrn"), "12,");
  const CommandResult refused =
      sequence.Run("po_invio_multi", folder.File("no"), "--audit --backend=smoother");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.output, testing::HasSubstr("only a filter can be audited"));
}

TEST(Analyze, JointUseIsConsistentAndReuseIsNot) {
  const std::string words = "analyze --quiet --config=" + Source("configs/datasets/figure8_short.yaml") +
                            " --set=duration_s=4,path_m=5.2,max_features=60 --estimator=" +
                            Source("configs/estimators/po_invio_multi.yaml");
  const CommandResult json = Alidade(words + " --windows=8 --json");
  ASSERT_EQ(json.code, 0) << json.output;
  const auto rows = nlohmann::json::parse(json.output);
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0]["policy"], "joint");
  EXPECT_NEAR(rows[0]["nees_ratio"], 1, 1e-6);
  EXPECT_EQ(rows[2]["policy"], "reuse");
  EXPECT_GT(rows[2]["nees_ratio"], 1.1);
  const CommandResult table = Alidade(words + " --windows=6,8");
  EXPECT_THAT(table.output, testing::HasSubstr("| policy | 6 clones | 8 clones |\n|---|---:|---:|\n| joint"));
  const CommandResult refused = Alidade(words + " --windows=8,wide");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.output, testing::HasSubstr("--windows: found 'wide'"));
}

TEST(Run, EvaluatesWhatItWrote) {
  TemporaryFolder folder;
  const Sequence& sequence = Sequence::Get();
  ASSERT_EQ(sequence.Run("alidade_filter", folder.File("a")).code, 0);
  const std::string truth = sequence.path() + "/mav0/state_groundtruth_estimate0/data.csv";
  for (const char* file : {"states.csv", "trajectory.tum"}) {
    const CommandResult scored =
        Alidade("evaluate --json --truth=" + truth + " --estimate=" + folder.File(std::string("a/") + file));
    EXPECT_EQ(scored.code, 0) << scored.output;
    EXPECT_TRUE(nlohmann::json::accept(scored.output)) << scored.output;
  }
}

TEST(Run, SettingsMayBeRepeated) {
  TemporaryFolder folder;
  const Sequence& sequence = Sequence::Get();
  ASSERT_EQ(
      sequence.Run("alidade_filter", folder.File("a"), "--set filter.window=9,vision.pixel_noise_px=1.5")
          .code,
      0);
  const auto config = nlohmann::json::parse(ReadFile(folder.File("a/run.json")))["config"];
  EXPECT_EQ(config["filter"]["window"], 9);
  EXPECT_EQ(config["vision"]["pixel_noise_px"], 1.5);
  EXPECT_EQ(config["init"]["method"], "truth");
}

// GIVEN a run that is lost and starts again, and one whose GNSS never aligns WHEN they end THEN their exit
// code and their last lines tell them from a clean one.
TEST(Run, ThatWasLostOrNeverUsedItsGnssEndsWithItsOwnCode) {
  TemporaryFolder folder;
  const CommandResult made = Alidade("simulate --config=" + Source("configs/datasets/figure8.yaml") +
                                     " --seed=961 --set=duration_s=28,path_m=36,fault=imu,fault_start_s=8,"
                                     "fault_duration_s=1 --quiet --output=" +
                                     folder.File("faulty"));
  ASSERT_EQ(made.code, 0) << made.output;
  const CommandResult lost = Alidade("run --config=" + Source("configs/estimators/alidade_filter.yaml") +
                                     " --set=init.method=truth --dataset=" + folder.File("faulty") +
                                     " --output=" + folder.File("lost"));
  EXPECT_EQ(lost.code, 8) << lost.output;
  EXPECT_THAT(lost.output, testing::HasSubstr(", 1 restarts"));

  const CommandResult sky =
      Alidade("simulate --config=" + Source("configs/datasets/gnss_figure8_short.yaml") +
              " --set=duration_s=4,path_m=5.2 --quiet --output=" + folder.File("sky"));
  ASSERT_EQ(sky.code, 0) << sky.output;
  const CommandResult unused = Alidade("run --config=" + Source("configs/estimators/gvio.yaml") +
                                       " --set=init.method=truth --dataset=" + folder.File("sky") +
                                       " --output=" + folder.File("unused"));
  EXPECT_EQ(unused.code, 8) << unused.output;
  EXPECT_THAT(unused.output, testing::HasSubstr("GNSS was not used: "));
}

}  // namespace
}  // namespace alidade::test
