#include "eval/report/paper_figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "eval/report/figure_files.h"
#include "eval/report/svg_axis.h"
#include "eval/report/svg_plot.h"
#include "tests/eval/report/synthetic_comparison.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::ReadFile;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

int CountOf(const std::string& word, const std::string& text) {
  int count = 0;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    ++count;
  }
  return count;
}

std::string FigureNamed(const std::string& name, const Comparison& comparison) {
  for (const PaperFigure& figure : DrawPaperFigures(comparison)) {
    if (figure.name == name) {
      return figure.svg;
    }
  }
  ADD_FAILURE() << "no figure " << name;
  return "";
}

TEST(SvgAxis, GivenARangeThenTicksAreRoundAndInside) {
  EXPECT_THAT(SvgAxis(-0.3, 2.1, 0, 100, false).Ticks(5), ElementsAre(0, 0.5, 1, 1.5, 2));
  EXPECT_FALSE(std::signbit(SvgAxis(-1e-9, 2, 0, 100, false).Ticks(4).front())) << "no tick says -0";
  EXPECT_THAT(SvgAxis(0.5, 20, 0, 100, true).Ticks(5), ElementsAre(0.5, 1, 2, 5, 10, 20));
  EXPECT_THAT(SvgAxis(1e-4, 1e3, 0, 100, true).Ticks(5), ElementsAre(1e-4, 1e-2, 1e0, 1e2));
  EXPECT_DOUBLE_EQ(SvgAxis(1, 100, 10, 30, true).At(10), 20);
  EXPECT_DOUBLE_EQ(SvgAxis(0, 4, 100, 0, false).At(1), 75);
}

TEST(SvgCanvas, GivenTextOfMarkupThenItIsEscaped) {
  SvgCanvas canvas(10, 10);
  canvas.Text(1, 2, "<a> & \"b\"");
  EXPECT_THAT(canvas.Finish(), HasSubstr(">&lt;a&gt; &amp; &quot;b&quot;</text>"));
  EXPECT_THAT(canvas.Finish(), HasSubstr("width=\"10pt\" height=\"10pt\" viewBox=\"0 0 10 10\""));
}

TEST(SvgPlot, GivenAGapThenTheCurveIsBrokenThere) {
  SvgPlot plot;
  plot.curves = {{SvgStroke(), {0, 1, 2, 3, 4}, {1, 2, std::nan(""), 2, 1}}};
  SvgCanvas canvas(100, 100);
  DrawPlot(plot, {10, 10, 80, 80}, &canvas);
  EXPECT_EQ(CountOf("<polyline", canvas.Finish()), 2);
  EXPECT_THAT(canvas.Finish(), Not(HasSubstr("nan")));
}

TEST(PaperFigures, GivenAComparisonThenEverySequenceHasItsSix) {
  const Comparison comparison = test::SyntheticComparison(100);
  std::vector<std::string> names;
  for (const PaperFigure& figure : DrawPaperFigures(comparison)) {
    names.push_back(figure.name);
    EXPECT_THAT(figure.svg, StartsWith("<?xml"));
    EXPECT_THAT(figure.svg, Not(HasSubstr("nan")));
    EXPECT_THAT(figure.svg, Not(HasSubstr("no data")));
    EXPECT_THAT(figure.svg, HasSubstr(">po_invio_multi</text>"));
  }
  EXPECT_EQ(names.size(), 15U);
  EXPECT_THAT(names, ::testing::IsSupersetOf({"figure8_trajectory", "figure8_position_error",
                                              "V1_01_easy_nees", "V1_01_easy_rpe", "V1_01_easy_time",
                                              "nees_map", "rmse_pos_map", "rmse_ori_map"}));
  // Three estimates and the truth; in three frames three errors and their bands; three boxes at three
  // lengths.
  EXPECT_EQ(CountOf("<polyline", FigureNamed("figure8_trajectory", comparison)), 4);
  EXPECT_EQ(CountOf("<polyline", FigureNamed("figure8_position_error", comparison)), 9);
  EXPECT_EQ(CountOf("<polygon", FigureNamed("figure8_position_error", comparison)), 9);
  EXPECT_EQ(CountOf("fill-opacity=\"0.18\"", FigureNamed("figure8_rpe", comparison)), 9);
}

TEST(PaperFigures, GivenAnEstimatorThatLostEveryRunThenTheLegendShowsIt) {
  Comparison comparison = test::SyntheticComparison(50);
  for (CellResult& cell : comparison.cells) {
    cell.status = cell.estimator == "invio_l5" ? "diverged" : cell.status;
  }
  const std::string svg = FigureNamed("figure8_trajectory", comparison);
  EXPECT_THAT(svg, HasSubstr(">invio_l5 (no run ok)</text>"));
  EXPECT_EQ(CountOf("<polyline", svg), 3);
}

TEST(PaperFigures, GivenTheSameComparisonThenTheSameBytes) {
  for (const PaperFigure& figure : DrawPaperFigures(test::SyntheticComparison(60))) {
    EXPECT_EQ(figure.svg, FigureNamed(figure.name, test::SyntheticComparison(60)));
  }
}

TEST(FigureFiles, GivenFormatsThenUnknownOnesAreNamed) {
  EXPECT_FALSE(ParseFigureFormats("")->svg);
  EXPECT_TRUE(ParseFigureFormats("svg")->svg);
  const Result<FigureFormats> unknown = ParseFigureFormats("svg,png");
  EXPECT_EQ(unknown.code(), StatusCode::kUsage);
  EXPECT_THAT(unknown.message(), HasSubstr("found \"png\", expected svg, pdf or svg,pdf"));
}

class PathWithoutPrograms : public ::testing::Test {
 protected:
  void SetUp() override { setenv("PATH", "/nonexistent", 1); }
  void TearDown() override { setenv("PATH", path_.c_str(), 1); }
  std::string path_ = std::getenv("PATH");
};

TEST_F(PathWithoutPrograms, GivenNoConverterThenPdfIsRefusedWithThePackageToInstall) {
  EXPECT_TRUE(ParseFigureFormats("svg").ok());
  const Result<FigureFormats> pdf = ParseFigureFormats("svg,pdf");
  EXPECT_EQ(pdf.code(), StatusCode::kUsage);
  EXPECT_THAT(pdf.message(), HasSubstr("librsvg2-bin"));
}

TEST(FigureFiles, GivenPdfThenEveryFigureIsOneAndEqualComparisonsGiveEqualBytes) {
  const Result<FigureFormats> formats = ParseFigureFormats("pdf");
  if (!formats.ok()) {
    GTEST_SKIP() << formats.message();
  }
  const test::TemporaryFolder folder;
  Comparison comparison = test::SyntheticComparison(40);
  for (CellResult& cell : comparison.cells) {
    cell.sequence = "it's $HOME";  // no shell reads it
  }
  ASSERT_TRUE(WriteFigureFiles(comparison, *formats, folder.File("a")).ok());
  ASSERT_TRUE(WriteFigureFiles(comparison, *formats, folder.File("b")).ok());
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.File("a/figures"))) {
    const std::string text = ReadFile(entry.path().string());
    EXPECT_THAT(text, StartsWith("%PDF-"));
    EXPECT_EQ(text, ReadFile(folder.File("b/figures/" + entry.path().filename().string()))) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 6) << "and no SVG, which was not asked for";
}

TEST(FigureFiles, GivenAFolderThatCannotBeThenTheErrorNamesIt) {
  const test::TemporaryFolder folder;
  FigureFormats formats;
  formats.svg = true;
  const Status status = WriteFigureFiles(test::SyntheticComparison(20), formats, folder.Write("taken", ""));
  EXPECT_EQ(status.code(), StatusCode::kOutput);
  EXPECT_THAT(status.message(), HasSubstr("taken"));
}

}  // namespace
}  // namespace alidade
