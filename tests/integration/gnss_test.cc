#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/integration/command.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

CommandResult SimulateFigureEight(const std::string& settings, int seed, const std::string& output) {
  return Alidade("simulate --quiet --config=" + Source("configs/datasets/gnss_figure8.yaml") +
                 " --seed=" + std::to_string(seed) + " --set=" + settings + " --output=" + output);
}

CommandResult RunPreset(const std::string& sequence, const std::string& preset, const std::string& output,
                        const std::string& more = "") {
  return Alidade("run --quiet --dataset=" + sequence +
                 " --config=" + Source("configs/estimators/" + preset + ".yaml") +
                 " --set=init.method=truth,gnss.model_std_scale=0,gnss.pseudorange_std_m=0.5" + more +
                 " --output=" + output);
}

/// Unaligned position RMSE [m].
double Rmse(const std::string& sequence, const std::string& estimate) {
  const CommandResult scored =
      Alidade("evaluate --json --align=none --truth=" + sequence +
              "/mav0/state_groundtruth_estimate0/data.csv --estimate=" + estimate + "/states.csv");
  const nlohmann::json json = nlohmann::json::parse(scored.output, nullptr, false);
  EXPECT_TRUE(json.is_object()) << scored.output;
  return json.is_object() ? json["unaligned"].value("pos_rmse_m", 1e9) : 1e9;
}

/// 30 s of the figure-8 of 500 m with GNSS at 10 Hz, for all tests of this suite.
class GnssRun : public testing::TestWithParam<std::string> {
 protected:
  static const std::string& Sequence() {
    static const TemporaryFolder folder;
    static const std::string path = [] {
      const CommandResult made = SimulateFigureEight("duration_s=30,path_m=125", 1, folder.File("seq"));
      EXPECT_EQ(made.code, 0) << made.output;
      return folder.File("seq");
    }();
    return path;
  }
};

TEST_P(GnssRun, AlignsAndStandsInEnu) {
  TemporaryFolder folder;
  const CommandResult run = RunPreset(Sequence(), GetParam(), folder.File("run"));
  ASSERT_EQ(run.code, 0) << run.output;
  const nlohmann::json json = nlohmann::json::parse(ReadFile(folder.File("run/run.json")));
  ASSERT_TRUE(json["gnss"]["aligned"]) << json["gnss"];
  EXPECT_GT(json["gnss"]["epochs_used"], 100);
  EXPECT_LT(Rmse(Sequence(), folder.File("run")), 0.6);
  const std::string states = ReadFile(folder.File("run/states.csv"));
  EXPECT_NE(states.substr(0, states.find('\n')).find(",clock_m,drift_mps"), std::string::npos);
  EXPECT_GT(ReadFile(folder.File("run/trajectory.pos")).size(), 10000u);
  EXPECT_GT(ReadFile(folder.File("run/gnss.csv")).size(), 10000u);
}

TEST_P(GnssRun, WithoutTheKeyThereIsNoGnss) {
  TemporaryFolder folder;
  ASSERT_EQ(RunPreset(Sequence(), GetParam(), folder.File("run"), ",gnss.enabled=false").code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder.File("run/trajectory.pos")));
}

INSTANTIATE_TEST_SUITE_P(Presets, GnssRun, testing::Values("gvio", "gvins_class"),
                         [](const auto& test) { return test.param; });

// Huber's minimum is ten to eighty metres off in these: what most satellites agree on counts.
TEST(GnssReflections, LeaveTheAlignmentAlone) {
  const TemporaryFolder folder;
  for (const int seed : {7, 8, 125}) {
    const std::string sequence = folder.File("seq" + std::to_string(seed));
    const CommandResult made =
        SimulateFigureEight("gnss.nlos_rate=0.2,duration_s=12,path_m=50", seed, sequence);
    ASSERT_EQ(made.code, 0) << made.output;
    const std::string estimate = folder.File("run" + std::to_string(seed));
    const CommandResult run = RunPreset(sequence, "gvio", estimate);
    ASSERT_EQ(run.code, 0) << run.output;
    EXPECT_LT(Rmse(sequence, estimate), 3) << seed;
  }
}

// RTKLIB's single-point program on noise-free RINEX of ours.
TEST(GnssOracle, RtklibFindsTheTruthWithinACentimetre) {
  if (std::system("which rnx2rtkp > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "rnx2rtkp (Debian package rtklib) is not installed";
  }
  TemporaryFolder folder;
  // At rest the truth is one position.
  const CommandResult made = Alidade(
      "simulate --quiet --config=" + Source("configs/datasets/gnss_figure8.yaml") +
      " --output=" + folder.File("seq") +
      " --set='duration_s=25,path_m=1,rest_s=20,landmark_count=10,gnss.rate_hz=1,gnss.pseudorange_noise_m=0,"
      "gnss.range_rate_noise_mps=0,gnss.ionosphere=false,gnss.troposphere=false,"
      "gnss.inter_system_bias_m=0'");
  ASSERT_EQ(made.code, 0) << made.output;
  const std::string gnss = folder.File("seq/mav0/gnss0/");
  folder.Write("rtk.conf",
               "pos1-posmode=single\npos1-elmask=10\npos1-ionoopt=off\npos1-tropopt=off\npos1-navsys=45\n"
               "out-solformat=xyz\nout-timeform=tow\n");
  const std::string solved = folder.File("rtk.pos");
  ASSERT_EQ(std::system(("rnx2rtkp -k " + folder.File("rtk.conf") + " -o " + solved + " " + gnss +
                         "obs.rnx " + gnss + "nav.rnx > /dev/null 2>&1")
                            .c_str()),
            0);
  // The figure-8 begins at the anchor.
  const std::string sheet = ReadFile(gnss + "sensor.yaml");
  double x = 0, y = 0, z = 0;
  const std::string::size_type place = sheet.find("anchor_E: [");
  ASSERT_NE(place, std::string::npos);
  ASSERT_EQ(std::sscanf(sheet.c_str() + place, "anchor_E: [%lf, %lf, %lf]", &x, &y, &z), 3);
  int epochs = 0;
  std::istringstream lines(ReadFile(solved));
  for (std::string line; std::getline(lines, line);) {
    int week = 0;
    double tow = 0, px = 0, py = 0, pz = 0;
    if (line.starts_with('%') ||
        std::sscanf(line.c_str(), "%d %lf %lf %lf %lf", &week, &tow, &px, &py, &pz) != 5) {
      continue;
    }
    if (++epochs <= 18) {  // at rest
      // The antenna's lever arm is 0.164 m, whatever the attitude.
      EXPECT_NEAR(std::hypot(px - x, py - y, pz - z), std::sqrt(0.1 * 0.1 + 0.05 * 0.05 + 0.12 * 0.12), 0.01)
          << line;
    }
  }
  EXPECT_GE(epochs, 18);
}

TEST(GnssWithoutCamera, BothBackEndsWalk) {
  const std::string walk = SharedDir() + "/data/gnss_imu/walk_0827";
  if (SharedDir().empty() || !std::filesystem::exists(walk)) {
    GTEST_SKIP() << "walk_0827 is not there";
  }
  TemporaryFolder folder;
  for (const std::string backend : {"filter", "smoother"}) {
    const CommandResult run =
        Alidade("run --quiet --dataset=" + walk + " --config=" + Source("configs/estimators/gnss_imu.yaml") +
                " --backend=" + backend + " --output=" + folder.File(backend));
    ASSERT_EQ(run.code, 0) << run.output;
    const nlohmann::json json = nlohmann::json::parse(ReadFile(folder.File(backend + "/run.json")));
    EXPECT_EQ(json["initialization"]["method"], "gnss");
    EXPECT_GT(json["gnss"]["epochs_used"], 300);
  }
}

}  // namespace
}  // namespace alidade::test
