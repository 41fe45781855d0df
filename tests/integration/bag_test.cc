#include <gtest/gtest.h>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

/// Files of a sequence that must come back byte for byte. The truth does to 1e-15 (a quaternion goes through
/// its matrix).
std::map<std::string, std::string> SequenceFiles(const std::string& folder) {
  std::map<std::string, std::string> files = ComparableFiles(folder);
  std::erase_if(files, [](const auto& file) {
    return file.first.find("groundtruth") != std::string::npos || file.first.ends_with("timestamps.csv");
  });
  return files;
}

class BagConversion : public testing::Test {
 protected:
  void SetUp() override {
    const CommandResult made =
        Alidade("simulate --quiet --config=" + Source("configs/datasets/gnss_figure8.yaml") +
                " --set=duration_s=20,path_m=80,gnss.systems=GREC --output=" + sequence_);
    ASSERT_EQ(made.code, 0) << made.output;
    const CommandResult packed =
        Alidade("convert --quiet --compression=lz4 --dataset=" + sequence_ + " --output=" + bag_);
    ASSERT_EQ(packed.code, 0) << packed.output;
  }
  CommandResult RunOn(const std::string& dataset, const std::string& output) {
    return Alidade("run --quiet --dataset=" + dataset +
                   " --config=" + Source("configs/estimators/gvio.yaml") +
                   " --set=init.method=truth,gnss.model_std_scale=0" + " --output=" + folder_.File(output));
  }
  /// What a run wrote, without the name and digest of its dataset.
  std::map<std::string, std::string> RunFiles(const std::string& output) {
    std::map<std::string, std::string> files = ComparableFiles(folder_.File(output));
    files.erase("run.json");
    return files;
  }

  TemporaryFolder folder_;
  std::string sequence_ = folder_.File("seq");
  std::string bag_ = folder_.File("seq.bag");
};

TEST_F(BagConversion, ThereAndBackGivesTheSameFiles) {
  ASSERT_EQ(Alidade("convert --quiet --dataset=" + bag_ + " --output=" + folder_.File("back")).code, 0);
  const auto files = SequenceFiles(sequence_);
  EXPECT_GE(files.size(), 6u);
  EXPECT_EQ(SequenceFiles(folder_.File("back")), files);
}

TEST_F(BagConversion, GvioOnTheBagWritesWhatItWritesOnTheFolder) {
  const CommandResult folder = RunOn(sequence_, "on_folder");
  ASSERT_EQ(folder.code, 0) << folder.output;
  const CommandResult bag = RunOn(bag_, "on_bag");
  ASSERT_EQ(bag.code, 0) << bag.output;
  const auto expected = RunFiles("on_folder");
  EXPECT_GT(expected.at("gnss.csv").size(), 10000u);
  EXPECT_EQ(RunFiles("on_bag"), expected);
}

TEST_F(BagConversion, NamesWhatItRefuses) {
  EXPECT_EQ(Alidade("convert --dataset=" + sequence_ + " --output=" + folder_.File("x")).code, 2);
  EXPECT_EQ(
      Alidade("convert --compression=zip --dataset=" + sequence_ + " --output=" + folder_.File("x.bag")).code,
      2);
  EXPECT_EQ(Alidade("convert --dataset=" + sequence_ + " --output=" + bag_).code, 6);
  EXPECT_EQ(Alidade("convert --topics=foo=/x --dataset=" + bag_ + " --output=" + folder_.File("x")).code, 2);
  EXPECT_EQ(Alidade("convert --dataset=" + folder_.File("none") + " --output=" + folder_.File("x.bag")).code,
            4);
}

}  // namespace
}  // namespace alidade::test
