#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "tests/integration/command.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

std::string DigestIn(const std::string& text) {
  std::smatch match;
  return std::regex_search(text, match, std::regex("[0-9a-f]{64}")) ? match.str() : "";
}

// GIVEN a sequence of images WHEN the front end runs alone, and when `run` meets the same images THEN both
// make one log.
TEST(Images, TrackAndRunMakeTheSameMeasurementLog) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  TemporaryFolder folder;
  const std::string dataset = SharedDir() + "/data/euroc_micro/V1_01_first95";
  const CommandResult tracked =
      Alidade("track --quiet --dataset=" + dataset + " --output=" + folder.File("tracked"));
  ASSERT_EQ(tracked.code, 0) << tracked.output;
  const std::string digest = DigestIn(tracked.output);
  EXPECT_EQ(digest.size(), 64u);
  for (const std::string& input : {dataset, folder.File("tracked")}) {
    const CommandResult run = Alidade("run --dataset=" + input + " --config=" + Source("configs/base.yaml") +
                                      " --set=init.method=static --overwrite --output=" + folder.File("run"));
    EXPECT_TRUE(run.code == 0 || run.code == 5) << run.output;
    EXPECT_EQ(DigestIn(run.output), digest) << input;
  }
}

}  // namespace
}  // namespace alidade::test
