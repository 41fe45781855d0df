#include <gtest/gtest.h>

#include <filesystem>

#include "core/random.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/support/read_file.h"

// What fuzzing has found, and a few random bytes, fed to each target once.

namespace alidade::test {
namespace {

std::vector<FuzzTarget> AllTargets() {
  std::vector<FuzzTarget> all;
  for (const std::span<const FuzzTarget> targets : {ReaderTargets(), SequenceTargets(), SessionTargets()}) {
    all.insert(all.end(), targets.begin(), targets.end());
  }
  return all;
}

class FuzzInputsTest : public testing::TestWithParam<FuzzTarget> {};

// GIVEN an input that once aborted, hung or broke a promise, THEN it is taken or refused.
TEST_P(FuzzInputsTest, AreTakenOrRefused) {
  const std::filesystem::path folder =
      std::filesystem::path(ALIDADE_SOURCE_DIR) / "tests/fuzz/inputs" / GetParam().name;
  if (!std::filesystem::exists(folder)) {
    return;
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().string());
    GetParam().take(ReadFile(entry.path().string()));
  }
}

TEST_P(FuzzInputsTest, RandomBytesAreTakenOrRefused) {
  RandomStream random(1, GetParam().name);
  for (const int length : {0, 1, 7, 40, 200}) {
    std::string bytes;
    for (int i = 0; i < length; ++i) {
      bytes.push_back(static_cast<char>(static_cast<int>(random.Uniform(0, 256)) - 128));
    }
    GetParam().take(bytes);
  }
}

INSTANTIATE_TEST_SUITE_P(AllTargets, FuzzInputsTest, testing::ValuesIn(AllTargets()),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace alidade::test
