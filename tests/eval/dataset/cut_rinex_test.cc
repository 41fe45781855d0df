#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/check.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/dataset_writer.h"
#include "tests/eval/dataset/healthy_dataset.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

// Observations whose file was cut, as by a full disk or a copy that was interrupted.

namespace alidade {
namespace {

using testing::HasSubstr;

class CutRinex : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(WriteDataset(test::WithGnss(0, 0), folder_.path()).ok());
    text_ = test::ReadFile(folder_.File(kObservations));
    ASSERT_TRUE(text_.ends_with('\n'));
  }

  /// What `check` warns of, and the number of epochs.
  [[nodiscard]] std::pair<std::string, std::size_t> ReadCutTo(std::size_t bytes) const {
    folder_.Write(kObservations, text_.substr(0, bytes));
    const Result<Dataset> dataset = ReadDataset(folder_.path());
    CHECK(dataset.ok()) << dataset.message();
    return {test::Complaints(*dataset, DatasetFinding::Severity::kWarning), dataset->gnss->epochs.size()};
  }

  static constexpr char kObservations[] = "mav0/gnss0/obs.rnx";
  test::TemporaryFolder folder_;
  std::string text_;
};

TEST_F(CutRinex, AWholeFileIsNoComplaint) {
  const auto [warnings, epochs] = ReadCutTo(text_.size());
  EXPECT_THAT(warnings, testing::Not(HasSubstr("obs.rnx")));
  EXPECT_EQ(epochs, 10u);
}

TEST_F(CutRinex, WithinAnEpochTheEpochIsPassedOverAndNamed) {
  const std::size_t line = text_.rfind('\n', text_.size() - 2) + 1;  // the last satellite is gone
  const auto [warnings, epochs] = ReadCutTo(line);
  EXPECT_THAT(warnings,
              testing::AllOf(HasSubstr("obs.rnx:"), HasSubstr("the last epoch is truncated; skipped")));
  EXPECT_EQ(epochs, 9u);
}

TEST_F(CutRinex, WithinANumberOrBehindOneItIsNamed) {
  const std::size_t line = text_.rfind('\n', text_.size() - 2) + 1;
  EXPECT_THAT(ReadCutTo(line + 10).first, HasSubstr("expected a number of width 14"));
  EXPECT_THAT(ReadCutTo(line + 3 + 16).first,
              HasSubstr("obs.rnx: the last line has no line end, expected one"));
}

TEST_F(CutRinex, AnOffsetThatLeavesNoValidTimeIsRefused) {
  const auto message = [this](const char* offset) {
    folder_.Write("mav0/gnss0/sensor.yaml", std::string("p_BA: [0, 0, 0]\ntime_offset_s: ") + offset + "\n");
    return ReadDataset(folder_.path()).message();
  };
  EXPECT_THAT(message("-4.7e9"),
              HasSubstr("sensor.yaml:2:16: time_offset_s: found '-4.7e9', expected a number "
                        "within +-4.6e9 s"));
  EXPECT_THAT(message("4.6e9"), HasSubstr("sensor.yaml: time_offset_s: found 4.6e+09 s with the stamp "));
}

}  // namespace
}  // namespace alidade
