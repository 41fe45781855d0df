#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
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

/// A few small images along the figure-8.
const char* const kTiny =
    "name: tiny\nduration_s: 3\npath_m: 4\nwidth_px: 188\nheight_px: 120\nfocal_px: 115\n"
    "landmark_min_distance_m: 0.8\n";

/// The image of rank `index` in the sequence.
std::string ImageOf(const std::string& sequence, size_t index) {
  std::vector<std::string> images;
  for (const auto& entry : std::filesystem::directory_iterator(sequence + "/mav0/cam0/data")) {
    images.push_back(entry.path().string());
  }
  std::sort(images.begin(), images.end());
  return images.at(index);
}

// GIVEN a torn image among many WHEN the front end meets it THEN it is skipped and named; GIVEN more than one
// of twenty THEN the sequence is refused.
TEST(Images, GivenATornImageThenItIsSkippedAndMoreThanAFewEndTheRun) {
  TemporaryFolder folder;
  const std::string seq = folder.File("seq");
  const std::string simulate =
      "simulate --render --quiet --jobs=2 --config=" + folder.Write("tiny.yaml", kTiny);
  ASSERT_EQ(Alidade(simulate + " --output=" + seq).code, 0);
  const std::string torn = ImageOf(seq, 7);
  std::filesystem::resize_file(torn, 100);
  const std::string track =
      "track --dataset=" + seq + " --overlay=10 --overwrite --output=" + folder.File("tracked");
  const CommandResult tracked = Alidade(track);
  EXPECT_EQ(tracked.code, 0) << tracked.output;
  EXPECT_THAT(tracked.output, testing::HasSubstr("30 frames"));
  EXPECT_THAT(tracked.output, testing::HasSubstr("1 of 31 images skipped, the first: " + torn));
  const CommandResult check = Alidade("check --dataset=" + seq);
  EXPECT_EQ(check.code, 0) << check.output;
  EXPECT_THAT(check.output, testing::HasSubstr("warning  cam0: " + torn));

  const std::string missing = ImageOf(seq, 20);
  std::filesystem::remove(missing);
  const CommandResult refused = Alidade(track);
  EXPECT_EQ(refused.code, 4) << refused.output;
  EXPECT_THAT(refused.output, testing::HasSubstr("2 of 31 images cannot be used, expected at most 5 %"));
  const CommandResult run = Alidade("run --dataset=" + seq + " --config=" + Source("configs/base.yaml") +
                                    " --output=" + folder.File("run"));
  EXPECT_EQ(run.code, 4) << run.output;
  const CommandResult checked = Alidade("check --dataset=" + seq);
  EXPECT_EQ(checked.code, 4) << checked.output;
  EXPECT_THAT(checked.output, testing::HasSubstr(missing));
}

// GIVEN a simulation WHEN it is rendered THEN a folder of images comes out that the front end tracks and
// draws.
TEST(Images, ARenderedSequenceIsTracked) {
  TemporaryFolder folder;
  const std::string config = folder.Write("tiny.yaml", kTiny);
  const std::string seq = folder.File("seq");
  const CommandResult simulated =
      Alidade("simulate --render --quiet --jobs=2 --config=" + config + " --output=" + seq);
  ASSERT_EQ(simulated.code, 0) << simulated.output;
  EXPECT_FALSE(std::filesystem::exists(seq + "/mav0/cam0/tracks.csv")) << "the front end makes them";
  const CommandResult check = Alidade("check --dataset=" + seq);
  EXPECT_EQ(check.code, 0) << check.output;
  const CommandResult tracked =
      Alidade("track --quiet --overlay=10 --dataset=" + seq + " --output=" + folder.File("tracked"));
  ASSERT_EQ(tracked.code, 0) << tracked.output;
  EXPECT_THAT(tracked.output, testing::HasSubstr("31 frames"));
  EXPECT_TRUE(std::filesystem::exists(folder.File("tracked/frontend.csv")));
  const auto overlays = std::filesystem::directory_iterator(folder.File("tracked/overlay"));
  EXPECT_EQ(std::distance(begin(overlays), end(overlays)), 4);
  ASSERT_EQ(Alidade("convert --quiet --compression=lz4 --dataset=" + seq + " --output=" + seq + ".bag").code,
            0);
  const CommandResult bag =
      Alidade("track --quiet --overlay=30 --dataset=" + seq + ".bag --output=" + folder.File("of_bag"));
  EXPECT_EQ(DigestIn(bag.output), DigestIn(tracked.output)) << bag.output;
  const std::string last =
      "/overlay/" +
      std::filesystem::path(*begin(std::filesystem::directory_iterator(folder.File("of_bag/overlay"))))
          .filename()
          .string();
  EXPECT_EQ(ReadFile(folder.File("of_bag") + last), ReadFile(folder.File("tracked") + last));
}

// GIVEN a plan with a rendered simulation WHEN it runs, and again with --resume after its cells are gone THEN
// the front end ran once and the tables show what it did.
TEST(Images, AComparisonFromPixelsKeepsItsLog) {
  TemporaryFolder folder;
  folder.Write("tiny.yaml", kTiny);
  const std::string plan =
      folder.Write("plan.yaml", "set: {init.method: truth}\nestimators:\n  - " +
                                    Source("configs/estimators/po_invio_two.yaml") + "\n  - " +
                                    Source("configs/estimators/invio_l5.yaml") +
                                    "\nsequences:\n  - {config: tiny.yaml, set: {render.enabled: true}}\n");
  const std::string out = folder.File("out");
  const CommandResult first = Alidade("compare --plan=" + plan + " --output=" + out);
  EXPECT_TRUE(first.code == 0 || first.code == 7) << first.output;
  EXPECT_THAT(ReadFile(out + "/tables.md"), testing::HasSubstr("Front end"));
  const std::string log = out + "/logs/tiny/1";
  const std::string timing = ReadFile(log + "/timing.csv");
  const std::string summary = ReadFile(out + "/summary.csv");
  std::filesystem::remove_all(out + "/cells");
  const CommandResult second = Alidade("compare --resume --plan=" + plan + " --output=" + out);
  EXPECT_EQ(second.code, first.code) << second.output;
  EXPECT_EQ(ReadFile(log + "/timing.csv"), timing) << "another run of the front end takes another time";
  EXPECT_EQ(DigestIn(ReadFile(out + "/summary.csv")), DigestIn(summary));
}

// Estimators that need different tracks cannot share one run of the front end.
TEST(Images, AComparisonFromPixelsRefusesTwoFrontends) {
  TemporaryFolder folder;
  folder.Write("tiny.yaml", kTiny);
  const std::string preset = Source("configs/estimators/invio_l5.yaml");
  const std::string plan =
      folder.Write("plan.yaml", "estimators:\n  - " + preset + "\n  - {config: " + preset +
                                    ", name: other, set: {frontend.max_features: 80}}\n"
                                    "sequences:\n  - {config: tiny.yaml, set: {render.enabled: true}}\n");
  const CommandResult refused = Alidade("compare --plan=" + plan + " --output=" + folder.File("out"));
  EXPECT_EQ(refused.code, 3) << refused.output;
  EXPECT_THAT(refused.output, testing::HasSubstr("frontend differs"));
}

}  // namespace
}  // namespace alidade::test
