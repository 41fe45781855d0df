#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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

// GIVEN a program that links alidade::run alone, WHEN it streams its messages into a session, THEN the
// session starts and follows, and the program needs neither OpenCV nor yaml nor what reads bags.
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
  EXPECT_THAT(libraries.output, testing::Not(testing::HasSubstr("opencv")));
  EXPECT_THAT(libraries.output, testing::Not(testing::HasSubstr("yaml")));

  const CommandResult run = ShellIn(folder.path(), "build/robot");
  ASSERT_EQ(run.code, 0) << run.output;
  EXPECT_THAT(run.output, testing::HasSubstr("started at"));
  const std::size_t last = run.output.rfind('\n', run.output.size() - 2);
  int states = 0;
  double newest_s = 0, speed_mps = 0;
  ASSERT_EQ(std::sscanf(run.output.c_str() + (last == std::string::npos ? 0 : last + 1),
                        "%d states, newest at %lf s, speed %lf m/s", &states, &newest_s, &speed_mps),
            3)
      << run.output;
  EXPECT_GT(states, 100);
  EXPECT_EQ(newest_s, 15);
  EXPECT_NEAR(speed_mps, std::hypot(1.8, 0.4 * std::cos(30)), 0.05);
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
