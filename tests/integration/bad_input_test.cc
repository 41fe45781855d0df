#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

struct BadCall {
  std::string words;
  int code;
  std::string message;
};

/// A folder with a small sequence `seq` and files that are wrong in one way each.
class BadInput : public testing::Test {
 protected:
  void SetUp() override {
    const CommandResult made =
        Alidade("simulate --config=" + Source("configs/datasets/figure8_short.yaml") +
                " --set=duration_s=5,path_m=6.5 --output=" + folder_.File("seq") + " --quiet");
    ASSERT_EQ(made.code, 0) << made.output;
    folder_.Write("unknown_key.yaml", "base: " + Source("configs/base.yaml") + "\nfilter:\n  windw: 3\n");
    folder_.Write("comma.yaml", ",");
    folder_.Write("long_base.yaml", "base: " + std::string(300, 'x') + "\n");
    std::filesystem::create_symlink(folder_.File("loop"), folder_.File("loop"));
    folder_.Write("torn.tum", "1.0 2.0 3.0\n");
    folder_.Write("plan.yaml",
                  "estimators: [" + Source("configs/base.yaml") + "]\nsequences: [{paht: seq}]\n");
    folder_.Write("file", "");
    folder_.Write("no_imu/mav0/cam0/tracks.csv", "");
    std::filesystem::copy(folder_.File("seq"), folder_.File("torn_imu"),
                          std::filesystem::copy_options::recursive);
    folder_.Write("torn_imu/mav0/imu0/data.csv",
                  ReadFile(folder_.File("seq/mav0/imu0/data.csv")) + "2000000000000,1,2\n");
    std::filesystem::copy(folder_.File("seq"), folder_.File("no_truth"),
                          std::filesystem::copy_options::recursive);
    std::filesystem::remove_all(folder_.File("no_truth/mav0/state_groundtruth_estimate0"));
  }

  static void ExpectRefused(const std::vector<BadCall>& calls) {
    for (const BadCall& call : calls) {
      const CommandResult result = Alidade(call.words);
      EXPECT_EQ(result.code, call.code) << call.words << "\n" << result.output;
      EXPECT_THAT(result.output, HasSubstr(call.message)) << call.words;
      EXPECT_LT(result.output.size(), 2000u) << call.words << "\n" << result.output;
    }
  }

  TemporaryFolder folder_;
  const std::string base_ = Source("configs/base.yaml");
  const std::string seq_ = folder_.File("seq");
  const std::string out_ = folder_.File("out");
  const std::string run_ = "run --dataset=" + seq_ + " --output=" + out_;
};

// GIVEN a few rows of the IMU twice, late or not finite WHEN an estimator runs THEN they are reported and
// counted, and its states are those of a clean file.
TEST_F(BadInput, FaultyImuRowsAreDroppedAndCounted) {
  std::filesystem::copy(folder_.File("seq"), folder_.File("faulty"),
                        std::filesystem::copy_options::recursive);
  std::string table = ReadFile(folder_.File("seq/mav0/imu0/data.csv"));
  size_t start = 0;
  for (int line = 0; line < 100; ++line) {
    start = table.find('\n', start) + 1;
  }
  const std::string row = table.substr(start, table.find('\n', start) + 1 - start);
  const std::string nan = row.substr(0, row.find(',')) + ",nan,0,0,0,0,9.81\n";
  table.insert(start, row + nan);
  folder_.Write("faulty/mav0/imu0/data.csv", table + row);
  const std::string words =
      "run --config=" + Source("configs/base.yaml") + " --set=init.method=truth --dataset=";
  const CommandResult clean = Alidade(words + folder_.File("seq") + " --output=" + folder_.File("of_clean"));
  ASSERT_EQ(clean.code, 0) << clean.output;
  const CommandResult faulty =
      Alidade(words + folder_.File("faulty") + " --output=" + folder_.File("of_faulty"));
  ASSERT_EQ(faulty.code, 0) << faulty.output;
  EXPECT_THAT(faulty.output, HasSubstr("3 dropped (1 duplicate, 1 late, 1 not finite)"));
  EXPECT_THAT(ReadFile(folder_.File("of_clean/run.json")), HasSubstr("\"imu_rejected\": 0"));
  EXPECT_THAT(ReadFile(folder_.File("of_faulty/run.json")), HasSubstr("\"imu_rejected\": 3"));
  EXPECT_EQ(ReadFile(folder_.File("of_faulty/states.csv")), ReadFile(folder_.File("of_clean/states.csv")));
  const CommandResult check = Alidade("check --dataset=" + folder_.File("faulty"));
  EXPECT_THAT(check.output, HasSubstr("rows 3 dropped"));
}

// Every refused call ends with its exit code and a message that names what is wrong.
TEST_F(BadInput, WordsAndFlagsOfARunAreNamed) {
  ExpectRefused({
      {"", 2, "Usage: alidade <command>"},
      {"evalute", 2, "did you mean 'evaluate'"},
      {"run --datset=x", 2, "did you mean '--dataset'"},
      {"run --plan=x", 2, "unknown flag '--plan'"},
      {run_, 2, "--config is missing"},
      {run_ + " --config=" + base_ + " --output=twice", 2, "--output: given twice"},
      {run_ + " --config=" + base_ + " --seed=x", 2, "--seed: found 'x'"},
      {run_ + " --config=" + base_ + " --seed=-1", 2, "--seed: found '-1'"},
      {run_ + " --config=" + base_ + " --seed", 2, "--seed: found no value"},
      {run_ + " --config=" + base_ + " --backend=ekf", 2, "expected filter, smoother or batch"},
      {run_ + " --config=" + base_ + " extra", 2, "found 'extra'"},
  });
}

TEST_F(BadInput, ConfigurationsAreNamed) {
  ExpectRefused({
      {run_ + " --config=" + folder_.File("none.yaml"), 3, "none.yaml"},
      {run_ + " --config=" + folder_.File("unknown_key.yaml"), 3, "unknown_key.yaml:3:3"},
      {run_ + " --config=" + base_ + " --set=filter.windw=3", 3, "filter.window"},
      {run_ + " --config=" + base_ + " --set=filter.window=0", 3, "filter.window"},
      {run_ + " --config=" + base_ + " --set=filter.window=6 --set=filter.window=7", 3,
       "setting 'filter.window': found '6' and '7', expected one value"},
      {run_ + " --config=" + base_ + " --set=calibration.extrinsics=true,backend=batch", 3, "batch back end"},
      {run_ + " --config=" + folder_.File("comma.yaml"), 3, "comma.yaml:1:1"},
      {run_ + " --config=" + folder_.File("long_base.yaml"), 3, "File name too long"},
      {"simulate --config=" + base_ + " --output=" + out_, 3, "base.yaml"},
      {"simulate --config=" + Source("configs/datasets/figure8.yaml") +
           " --set=duration_s=nan --output=" + out_,
       3, "duration_s"},
      {"simulate --config=" + Source("configs/datasets/figure8.yaml") +
           " --set=render.line_delay_s=nan --output=" + out_,
       3, "render.line_delay_s: found 'nan', expected a finite number"},
      {"simulate --config=" + Source("configs/datasets/figure8.yaml") +
           " --set=render.line_delay_s=29.7 --output=" + out_,
       3, "render.line_delay_s: found '29.7', expected a number in [-0.001, 0.001]"},
      {"compare --plan=" + folder_.File("plan.yaml") + " --output=" + out_, 3, "did you mean 'path'"},
      {"config --check " + folder_.File("unknown_key.yaml"), 3, "did you mean"},
      {"spp --obs=x --nav=y --output=" + folder_.File("z.pos") + " --set=systems=GX", 3, "found 'X'"},
  });
}

TEST_F(BadInput, FilesAndFoldersAreNamed) {
  const std::string longer = folder_.File(std::string(300, 'x'));
  ExpectRefused({
      {"run --dataset=" + folder_.File("none") + " --config=" + base_ + " --output=" + out_, 4, "none"},
      {"run --dataset=" + folder_.File("no_imu") + " --config=" + base_ + " --output=" + out_, 4, "imu0"},
      {"run --dataset=" + folder_.File("torn_imu") + " --config=" + base_ + " --output=" + out_, 4,
       "data.csv:50"},
      {"run --dataset=" + folder_.File("no_truth") + " --config=" + base_ +
           " --set=init.method=truth --output=" + folder_.File("of_no_truth"),
       4, "no ground truth"},
      {run_ + " --config=" + folder_.File("loop"), 3, "Too many levels of symbolic links"},
      {"run --dataset=" + longer + " --config=" + base_ + " --output=" + out_, 4, "File name too long"},
      {"run --dataset=" + folder_.File("loop") + " --config=" + base_ + " --output=" + out_, 4,
       "Too many levels of symbolic links"},
      {"check --dataset=" + longer, 4, "File name too long"},
      {"track --dataset=" + longer + " --output=" + out_, 4, "File name too long"},
      {"convert --dataset=" + longer + " --output=" + out_ + ".bag", 4, "File name too long"},
      {"convert --dataset=" + seq_ + " --output=" + longer + ".bag", 6, "File name too long"},
      {"spp --obs=" + longer + " --nav=x --output=" + folder_.File("z.pos"), 4, "File name too long"},
      {"spp --obs=x --nav=x --output=" + longer, 4, "x: cannot be read"},
      {"run --dataset=" + seq_ + " --config=" + base_ + " --output=" + seq_, 6, "lies in the dataset"},
      {"run --dataset=" + seq_ + " --config=" + base_ + " --output=" + seq_ + "/mav0/imu0 --overwrite", 6,
       "expected a folder outside of it"},
      {"run --dataset=" + seq_ + " --config=" + base_ + " --output=/ --overwrite", 6,
       "root of the file system"},
      {"run --dataset=" + seq_ + " --config=" + base_ + " --output=" + folder_.File("file") + "/x", 6,
       "file/x"},
      {"track --dataset=" + seq_ + " --output=" + folder_.File("tracks"), 4, "no images"},
      {"check --dataset=" + folder_.File("none"), 4, "none"},
      {"spp --obs=none.rnx --nav=none.nav --output=" + folder_.File("z.pos"), 4, "none.rnx: cannot be read"},
      {"spp --obs=x --nav=y --output=" + folder_.File("file"), 6, "--overwrite"},
  });
}

TEST_F(BadInput, FlagsOfTheOtherCommandsAreNamed) {
  const std::string truth = seq_ + "/mav0/state_groundtruth_estimate0/data.csv";
  ExpectRefused({
      {"evaluate --truth=" + folder_.File("torn.tum") + " --estimate=" + folder_.File("torn.tum"), 4,
       "torn.tum:1"},
      {"evaluate --max_dt=-1 --truth=" + truth + " --estimate=" + truth, 2,
       "evaluate: --max_dt: found -1, expected 0 to "},
      {"evaluate --truth=a --estimate=b --align=yaw", 2, "--align: found 'yaw'"},
      {"evaluate --truth=a --estimate=b --rpe=8,x", 2, "--rpe: found 'x'"},
      {"evaluate --truth=a --estimate=b --association=tum", 2, "--association: found 'tum'"},
      {"evaluate --truth=a --estimate=b --rpe_by=kitti", 2, "--rpe_by: found 'kitti'"},
      {"evaluate --truth=a --estimate=b --rpe_by=evo --rpe_unit=s", 2, "frames, m, deg or rad"},
      {"evaluate --truth=a --estimate=b --rpe_by=rpg --rpe_all_pairs", 2, "only with --rpe_by=evo"},
      {"data", 2, "list [NAME], fetch NAME"},
      {"data fetch tumvi", 2, "--output is missing"},
      {"data fetch tumvy --output=x", 2, "did you mean 'tumvi'"},
      {"data fetch gvins --output=x", 2, "by hand from https://github.com/HKUST"},
      {"data verify tumvi/room1 --data=absent", 4, "1 of 1 files of tumvi"},
      {"compare --plan=" + folder_.File("plan.yaml") + " --jobs=0 --output=" + out_, 2, "--jobs: found 0"},
      {"probe --model=pose_onyl --input=" + folder_.File("file"), 2, "did you mean 'pose_only'"},
      {"probe --model=pose_only --input=" + folder_.File("file"), 4, "not JSON"},
      {"probe --model=pose_only --input=" + folder_.File("file") + " --error=left", 2,
       "--error: found 'left'"},
      {"config", 2, "--show FILE"},
      {"config --diff " + base_, 2, "--diff FILE FILE2"},
      {"spp --obs=x --nav=y", 2, "--output is missing"},
  });
}

// GIVEN a camera sheet with focal lengths in mm and a principal point far away THEN check lists both faults,
// and a run does not begin.
TEST_F(BadInput, AnImplausibleSheetIsRefusedWithAllItsFaults) {
  const std::string sheet = "seq/mav0/cam0/sensor.yaml";
  const std::string text = ReadFile(folder_.File(sheet));
  const size_t key = text.find("intrinsics:");
  ASSERT_NE(key, std::string::npos);
  folder_.Write(sheet,
                text.substr(0, key) + "intrinsics: [4, 4, -4000, 240]" + text.substr(text.find('\n', key)));
  const std::string run = "run --config=" + Source("configs/base.yaml") + " --output=" + folder_.File("out");
  for (const std::string& words : {std::string("check"), run}) {
    const CommandResult result = Alidade(words + " --dataset=" + folder_.File("seq"));
    EXPECT_EQ(result.code, 4) << result.output;
    EXPECT_THAT(result.output, HasSubstr("cam0/sensor.yaml: intrinsics: found fu 4 px, fv 4 px"));
    EXPECT_THAT(result.output,
                HasSubstr("cam0/sensor.yaml: intrinsics: found the principal point cu -4000 px"));
  }
}

TEST_F(BadInput, EstimatorThatNeverStartsKeepsItsOutputsAndExits5) {
  const std::string out = folder_.File("out");
  const CommandResult result =
      Alidade("run --dataset=" + folder_.File("seq") + " --config=" + Source("configs/base.yaml") +
              " --set=init.method=static --output " + out + " --quiet");
  EXPECT_EQ(result.code, 5) << result.output;
  EXPECT_THAT(result.output, HasSubstr("not initialised"));
  EXPECT_THAT(ReadFile(out + "/run.json"), HasSubstr("\"not_initialized\""));
  EXPECT_TRUE(std::filesystem::exists(out + "/states.csv"));
}

TEST(Help, ListsCommandsAndFlagsWithDefaults) {
  const CommandResult general = Alidade("help");
  EXPECT_EQ(general.code, 0);
  for (const char* command :
       {"simulate", "track", "run", "evaluate", "compare", "probe", "spp", "check", "config"}) {
    EXPECT_THAT(general.output, HasSubstr(command));
    const CommandResult help = Alidade(std::string(command) + " --help");
    EXPECT_EQ(help.code, 0);
    EXPECT_THAT(help.output, HasSubstr("Flags:"));
    EXPECT_EQ(help.output, Alidade(std::string("help ") + command).output);
  }
  EXPECT_THAT(Alidade("evaluate --help").output, HasSubstr("default 0.01"));
}

// An example with --help behind it is parsed like any other call.
TEST(Help, EveryCommandHasAnExampleThatIsUnderstood) {
  const std::string general = Alidade("help").output;
  std::istringstream lines(general.substr(general.find("Commands:\n") + 10));
  int commands = 0;
  for (std::string line; std::getline(lines, line) && line.starts_with("  ");) {
    const std::string command = line.substr(2, line.find(' ', 2) - 2);
    if (command == "help") {
      continue;
    }
    const std::string help = Alidade(command + " --help").output;
    const size_t start = help.find("Example:\n  alidade ");
    ASSERT_NE(start, std::string::npos) << command;
    std::string example = help.substr(start + 19, help.find('\n', start + 19) - start - 19);
    EXPECT_TRUE(example.starts_with(command)) << example;
    example = example.substr(0, example.find(" |"));
    const CommandResult parsed = Alidade(example + " --help");
    EXPECT_EQ(parsed.code, 0) << example << "\n" << parsed.output;
    ++commands;
  }
  EXPECT_GT(commands, 15);
}

}  // namespace
}  // namespace alidade::test
