#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "core/random.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/support/read_file.h"

// The committed files of each target, and a few random bytes, fed to it once.

namespace alidade::test {
namespace {

std::vector<FuzzTarget> AllTargets() {
  std::vector<FuzzTarget> all;
  for (const std::span<const FuzzTarget> targets : {ReaderTargets(), SequenceTargets(), SessionTargets()}) {
    all.insert(all.end(), targets.begin(), targets.end());
  }
  return all;
}

/// Folders of committed files: examples, and inputs that once aborted, hung or broke a Require. Each has the
/// name of its target.
std::vector<std::string> InputFolders() {
  std::vector<std::string> folders;
  for (const char* kind : {"seeds", "inputs"}) {
    std::error_code missing;  // without a finding there is no `inputs`
    for (const auto& entry : std::filesystem::directory_iterator(
             std::filesystem::path(ALIDADE_SOURCE_DIR) / "tests/fuzz" / kind, missing)) {
      folders.push_back(entry.path().string());
    }
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

class FuzzFilesTest : public testing::TestWithParam<std::string> {};

TEST_P(FuzzFilesTest, AreTakenOrRefused) {
  const FuzzTarget* const target = FindFuzzTarget(std::filesystem::path(GetParam()).filename().string());
  ASSERT_NE(target, nullptr) << GetParam() << " has the name of no target";
  ASSERT_FALSE(std::filesystem::is_empty(GetParam())) << GetParam();
  for (const auto& entry : std::filesystem::directory_iterator(GetParam())) {
    SCOPED_TRACE(entry.path().string());
    target->take(ReadFile(entry.path().string()));
  }
}

INSTANTIATE_TEST_SUITE_P(Committed, FuzzFilesTest, testing::ValuesIn(InputFolders()), [](const auto& param) {
  const std::filesystem::path folder = param.param;
  return folder.parent_path().filename().string() + "_" + folder.filename().string();
});

class FuzzInputsTest : public testing::TestWithParam<FuzzTarget> {};

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
