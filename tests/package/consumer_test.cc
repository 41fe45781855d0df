#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "tests/package/installed_tree.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

TEST(Consumer, AProjectOfItsOwnFindsBuildsAndRuns) {
  TemporaryFolder folder;
  const CommandResult configured =
      Shell(std::string(ALIDADE_CMAKE) + " -G Ninja -S " + Source("tests/package/consumer") + " -B " +
            folder.File("build") + " -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH='" ALIDADE_PREFIX "'");
  ASSERT_EQ(configured.code, 0) << configured.output;
  const CommandResult built = Shell(std::string(ALIDADE_CMAKE) + " --build " + folder.File("build"));
  ASSERT_EQ(built.code, 0) << built.output;

  const CommandResult run = ShellIn(folder.path(), "build/consumer");
  int states = 0;
  double path_m = 0, rmse_m = 1e9;
  ASSERT_EQ(std::sscanf(run.output.c_str(), "%d states over %lf m, RMSE %lf m", &states, &path_m, &rmse_m), 3)
      << run.output;
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(states, 101);  // 10 s at 10 Hz
  EXPECT_NEAR(path_m, 13, 0.1);
  EXPECT_GT(rmse_m, 0);
  EXPECT_LT(rmse_m, 0.3);
}

/// Speed [m/s] in the last row of a folder's truth.
double TrueSpeedAtTheEnd(const std::string& folder) {
  const std::string truth = ReadFile(folder + "/mav0/state_groundtruth_estimate0/data.csv");
  std::istringstream row(truth.substr(truth.rfind('\n', truth.size() - 2) + 1));
  std::vector<double> values;
  for (std::string value; std::getline(row, value, ',');) {
    values.push_back(std::stod(value));
  }
  return values.size() < 11 ? NAN : std::hypot(values[8], values[9], values[10]);
}

/// Lines of a text that contain `part`.
int LinesWith(const std::string& text, const std::string& part) {
  int lines = 0;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    lines += line.find(part) != std::string::npos ? 1 : 0;
  }
  return lines;
}

/// Expects build/robot of the folder to start and follow on a simulated log.
void ExpectRobotFollowsALog(const TemporaryFolder& folder) {
  const CommandResult simulated =
      ShellIn(folder.path(), Installed("bin/alidade") +
                                 " simulate --quiet --config=figure8_short "
                                 "--set=duration_s=12,path_m=12,rest_s=3 --output=log");
  ASSERT_EQ(simulated.code, 0) << simulated.output;
  const CommandResult run = ShellIn(folder.path(), "build/robot log");
  ASSERT_EQ(run.code, 0) << run.output;
  EXPECT_EQ(LinesWith(run.output, "started at") - LinesWith(run.output, "not started at"), 1) << run.output;
  EXPECT_GT(LinesWith(run.output, "state at"), 100);  // 10 Hz from the end of the first second on
  EXPECT_EQ(LinesWith(run.output, "too late") + LinesWith(run.output, "is skipped"), 0) << run.output;
  double newest_s = 0, speed_mps = 0;
  const std::size_t last = run.output.find("newest at");
  ASSERT_NE(last, std::string::npos) << run.output;
  ASSERT_EQ(std::sscanf(run.output.c_str() + last, "newest at %lf s, speed %lf m/s", &newest_s, &speed_mps),
            2);
  EXPECT_EQ(newest_s, 1012);
  EXPECT_NEAR(speed_mps, TrueSpeedAtTheEnd(folder.File("log")), 0.1);
}

/// Expects build/robot of the folder to end with an error without its input, and to name the file.
void ExpectRobotNamesMissingFiles(const TemporaryFolder& folder) {
  const auto expect = [&](const std::string& arguments, const std::string& text) {
    const CommandResult run = ShellIn(folder.path(), "build/robot " + arguments);
    EXPECT_EQ(run.code, 1) << text;
    EXPECT_THAT(run.output, testing::HasSubstr(text));
  };
  expect("", "usage: robot FOLDER");
  expect("none", "no IMU samples in none/mav0/imu0/data.csv");
  folder.Write("imu_alone/mav0/imu0/data.csv", "#\n1000000000,0,0,0,0,0,9.81\n");
  expect("imu_alone", "no tracks in imu_alone/mav0/cam0/tracks.csv");
}

// GIVEN a program that links alidade::run alone, WHEN it streams a recorded log into a session, THEN the
// session starts and follows, and the program needs neither OpenCV nor yaml nor what reads bags and
// downloads.
TEST(Consumer, ARobotNeedsTheSessionAlone) {
  TemporaryFolder folder;
  const CommandResult configured =
      Shell(std::string(ALIDADE_CMAKE) + " -G Ninja -S " + Source("docs/robot_example") + " -B " +
            folder.File("build") + " -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH='" ALIDADE_PREFIX "'" +
            " -DCMAKE_DISABLE_FIND_PACKAGE_OpenCV=ON -DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=ON" +
            " -DCMAKE_DISABLE_FIND_PACKAGE_BZip2=ON -DCMAKE_DISABLE_FIND_PACKAGE_OpenSSL=ON" +
            " -DCMAKE_DISABLE_FIND_PACKAGE_CURL=ON");
  ASSERT_EQ(configured.code, 0) << configured.output;
  const CommandResult built = Shell(std::string(ALIDADE_CMAKE) + " --build " + folder.File("build"));
  ASSERT_EQ(built.code, 0) << built.output;
  const CommandResult libraries = ShellIn(folder.path(), "ldd build/robot");
  ASSERT_THAT(libraries.output, testing::HasSubstr("libstdc++"));
  for (const char* unneeded : {"opencv", "yaml", "libssl", "libcrypto", "libcurl", "libbz2", "liblz4"}) {
    EXPECT_THAT(libraries.output, testing::Not(testing::HasSubstr(unneeded)));
  }
  // Of headers alone, such as a JSON library's, symbols remain.
  const CommandResult symbols = ShellIn(folder.path(), "nm -C build/robot");
  ASSERT_THAT(symbols.output, testing::HasSubstr("alidade::Session"));
  EXPECT_THAT(symbols.output, testing::Not(testing::HasSubstr("nlohmann")));

  ExpectRobotFollowsALog(folder);
  ExpectRobotNamesMissingFiles(folder);

  // A log that ends before a start is possible.
  folder.Write("short/mav0/imu0/data.csv", "#\n1000000000,0,0,0,0,0,9.81\n1010000000,0,0,0,0,0,9.81\n");
  folder.Write("short/mav0/cam0/tracks.csv", "#\n1000000000,0,100,100\n");
  const CommandResult without = ShellIn(folder.path(), "build/robot short");
  EXPECT_EQ(without.code, 1);
  EXPECT_THAT(without.output, testing::HasSubstr("no estimate: "));
}

TEST(Consumer, AnotherMinorVersionIsRefused) {
  TemporaryFolder folder;
  folder.Write("CMakeLists.txt",
               "cmake_minimum_required(VERSION 3.22)\nproject(other LANGUAGES CXX)\n"
               "find_package(alidade 0.0 CONFIG REQUIRED)\n");
  const CommandResult configured =
      Shell(std::string(ALIDADE_CMAKE) + " -G Ninja -S " + folder.path() + " -B " + folder.File("build") +
            " -DCMAKE_PREFIX_PATH='" ALIDADE_PREFIX "'");
  EXPECT_NE(configured.code, 0);
  EXPECT_THAT(configured.output, testing::HasSubstr("version: " ALIDADE_VERSION));
}

TEST(Consumer, InstalledHeadersIncludeNothingThatIsNotInstalled) {
  TemporaryFolder folder;
  std::string includes;
  const std::filesystem::path root = Installed("include/alidade");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    if (entry.is_regular_file()) {
      includes += "#include \"" + entry.path().lexically_relative(root).string() + "\"\n";
    }
  }
  ASSERT_THAT(includes, testing::HasSubstr("\"core/lie.h\""));
  const std::string source = folder.Write("all.cc", includes);
  const CommandResult compiled = Shell(std::string(ALIDADE_COMPILER) + " -std=c++20 -fsyntax-only -I" +
                                       root.string() + " -isystem /usr/include/eigen3 " + source);
  EXPECT_EQ(compiled.code, 0) << compiled.output;
  // What stays behind the implementation: a consumer's compiler does not need these.
  const CommandResult used =
      Shell("grep -rlE '#include <(opencv2|yaml-cpp|nlohmann|gflags)/' " + root.string());
  EXPECT_EQ(used.code, 1) << used.output;
}

}  // namespace
}  // namespace alidade::test
