#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
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
  const auto config = nlohmann::json::parse(ReadFile(folder.File("a/run.json")))["config"];
  const int code = config["gnss"]["enabled"] ? 8 : 0;  // the sequence has no GNSS
  ASSERT_EQ(first.code, code) << first.output;
  ASSERT_EQ(sequence.Run(GetParam(), folder.File("b")).code, code);
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

TEST(Run, AuditSeparatesTheInvariantErrorFromTheOrdinaryOneAndRefusesTheSmoother) {
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

// GIVEN --quiet WHEN a run ends THEN its result, and nothing else, is printed.
TEST(Run, QuietPrintsTheResultAlone) {
  TemporaryFolder folder;
  const CommandResult run = Sequence::Get().Run("alidade_filter", folder.File("a"));
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.output, testing::StartsWith("ok: 61 frames, 0 skipped, start: truth"));
  EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1) << run.output;
}

// GIVEN an IMU that ends halfway WHEN an estimator has run THEN the warning names the spans, and the result
// is not "ok" and has a reason.
TEST(Run, OnHalfAnImuIsImpairedWithAReason) {
  TemporaryFolder folder;
  std::filesystem::copy(Sequence::Get().path(), folder.File("half"),
                        std::filesystem::copy_options::recursive);
  const std::string table = ReadFile(folder.File("half/mav0/imu0/data.csv"));
  folder.Write("half/mav0/imu0/data.csv", table.substr(0, table.find('\n', table.size() / 2) + 1));
  const CommandResult run = Alidade("run --set=init.method=truth --dataset=" + folder.File("half") +
                                    " --config=" + Source("configs/estimators/alidade_filter.yaml") +
                                    " --output=" + folder.File("a"));
  EXPECT_EQ(run.code, 8) << run.output;
  EXPECT_THAT(run.output, testing::ContainsRegex("warning: cam0: from .* s of cam0 are without IMU"));
  EXPECT_THAT(run.output, testing::ContainsRegex("\nimpaired: .* skipped .no imu sample reaches"));
  const auto json = nlohmann::json::parse(ReadFile(folder.File("a/run.json")));
  EXPECT_EQ(json["status"], "ok");
  EXPECT_EQ(json["impaired"].size(), 1u);
}

// GIVEN a camera whose rotation is wrong by 1 deg, which is reported in more than half of the run WHEN it
// ends THEN its last line, exit code and run.json distinguish it from a clean one.
TEST(Run, ThatIsMostlyDegradedIsImpaired) {
  TemporaryFolder folder;
  const CommandResult made = Alidade("simulate --config=" + Source("configs/datasets/figure8.yaml") +
                                     " --seed=921 --set=duration_s=20,path_m=26,"
                                     "calibration_rotation_error_rad=0.0175 --quiet --output=" +
                                     folder.File("seq"));
  ASSERT_EQ(made.code, 0) << made.output;
  const CommandResult run = Alidade("run --quiet --set=init.method=truth --dataset=" + folder.File("seq") +
                                    " --config=" + Source("configs/estimators/alidade_filter.yaml") +
                                    " --output=" + folder.File("a"));
  EXPECT_EQ(run.code, 8) << run.output;
  EXPECT_THAT(run.output, testing::ContainsRegex("^impaired: .* degraded .* whose model is in doubt"));
  const auto json = nlohmann::json::parse(ReadFile(folder.File("a/run.json")));
  EXPECT_GT(json["states"]["degraded"], json["states"]["ok"]);
  EXPECT_EQ(json["impaired"].size(), 1u);
}

// GIVEN sensors that the configuration enables and the sequence lacks THEN each is named in the last line.
TEST(Run, WithoutTheSensorsItIsToUseIsImpaired) {
  TemporaryFolder folder;
  const CommandResult run = Sequence::Get().Run("gvio", folder.File("a"), "--set=fix.enabled=true");
  EXPECT_EQ(run.code, 8) << run.output;
  EXPECT_THAT(run.output, testing::HasSubstr("GNSS was not used: the sequence has no GNSS; position fixes "
                                             "were not used: the sequence has no position fixes\n"));
  const auto json = nlohmann::json::parse(ReadFile(folder.File("a/run.json")));
  EXPECT_EQ(json["impaired"].size(), 2u);
}

// GIVEN an output that cannot be used and an input with a fault THEN the output is reported, which costs no
// time; GIVEN the fault alone THEN nothing is made.
TEST(Run, ChecksTheOutputBeforeItReadsTheInput) {
  TemporaryFolder folder;
  folder.Write("full/file", "");
  folder.Write("seq/mav0/imu0/data.csv", "torn");
  for (const std::string& command : std::vector<std::string>{
           "run --config=" + Source("configs/base.yaml"), std::string("track"), std::string("identify"),
           std::string("calibrate"), std::string("refine_truth")}) {
    const CommandResult full =
        Alidade(command + " --dataset=" + folder.File("seq") + " --output=" + folder.File("full"));
    EXPECT_EQ(full.code, 6) << command << "\n" << full.output;
    EXPECT_THAT(full.output, testing::HasSubstr("exists and is not empty"));
  }
  folder.Write("seq.bag", "");
  EXPECT_EQ(Alidade("convert --dataset=" + folder.File("seq") + " --output=" + folder.File("seq.bag")).code,
            6);
  const CommandResult torn = Alidade("run --config=" + Source("configs/base.yaml") +
                                     " --dataset=" + folder.File("seq") + " --output=" + folder.File("new"));
  EXPECT_EQ(torn.code, 4) << torn.output;
  EXPECT_FALSE(std::filesystem::exists(folder.File("new")));
}

// GIVEN a run that is lost and starts again, and one whose GNSS never aligns WHEN they end THEN their exit
// code and their last lines distinguish them from a clean one.
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
  EXPECT_THAT(lost.output, testing::HasSubstr("; 1 restart"));

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
