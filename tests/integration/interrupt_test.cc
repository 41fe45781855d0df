#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

/// Runs the program in the background and sends it a signal once `ready`, a command of the shell, ends; its
/// own exit code, and the time from the signal to its end in `delay_ms`.
CommandResult Interrupted(const std::string& signal, const std::string& ready, const std::string& words,
                          int* delay_ms) {
  CommandResult result = Shell(std::string(ALIDADE_BINARY_DIR) + "/alidade " + words + " & program=$!; " +
                               ready + "; start=$(date +%s%N); kill -" + signal +
                               " $program; wait $program; code=$?; "
                               "echo delay $((($(date +%s%N) - start) / 1000000)); exit $code");
  const size_t found = result.output.rfind("delay ");
  *delay_ms = found == std::string::npos ? -1 : std::stoi(result.output.substr(found + 6));
  return result;
}

// GIVEN a simulation that takes long WHEN a signal comes THEN it ends soon, with the exit code of an
// interruption, and leaves whole files.
TEST(Interrupt, EndsASimulation) {
  for (const char* signal : {"INT", "TERM"}) {
    const TemporaryFolder folder;
    int delay_ms = 0;
    const CommandResult result =
        Interrupted(signal, "while [ ! -d " + folder.File("seq") + " ]; do sleep 0.05; done; sleep 0.2",
                    "simulate --quiet --set=duration_s=3000,path_m=3900 --config=" +
                        Source("configs/datasets/figure8_short.yaml") + " --output=" + folder.File("seq"),
                    &delay_ms);
    EXPECT_EQ(result.code, 130) << signal << ": " << result.output;
    EXPECT_LT(delay_ms, 2000);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
      EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr(".tmp")));
    }
  }
}

TEST(Interrupt, EndsAStudyOfStarts) {
  const TemporaryFolder folder;
  const std::string plan = folder.Write(
      "plan.yaml",
      "estimators: [" + Source("configs/estimators/po_invio_multi.yaml") +
          "]\nsequences:\n  - {name: s, config: " + Source("configs/datasets/figure8_short.yaml") +
          ", set: {duration_s: 3000, path_m: 3900}, seeds: [1]}\n");
  for (const char* signal : {"INT", "TERM"}) {
    int delay_ms = 0;
    const CommandResult result = Interrupted(
        signal, "sleep 2", "starts --starts=5000 --plan=" + plan + " --output=" + folder.File("starts.csv"),
        &delay_ms);
    EXPECT_EQ(result.code, 130) << signal << ": " << result.output;
    EXPECT_LT(delay_ms, 2000);
    EXPECT_FALSE(std::filesystem::exists(folder.File("starts.csv")));
  }
}

}  // namespace
}  // namespace alidade::test
