// Opens the report in a headless browser: a page is right only when a browser draws it without a complaint.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "tests/eval/headless_browser.h"
#include "tests/eval/synthetic_comparison.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::HeadlessBrowser;
using test::PageVisit;
using test::ReadFile;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kPlots = 16;

class ReportInBrowser : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(HeadlessBrowser::kChromium)) {
      GTEST_SKIP() << "no " << HeadlessBrowser::kChromium << ": install the Debian package chromium";
    }
    ASSERT_TRUE(WriteReport(test::SyntheticComparison(300), folder_.File("report.html")).ok());
    page_ = ReadFile(folder_.File("report.html"));
  }

  /// Opens `page` with `address` ("#...") appended to its location.
  PageVisit Open(const std::string& page, const std::string& address = "") {
    const Result<PageVisit> visit = HeadlessBrowser().Open(folder_.Write("visited.html", page), address);
    EXPECT_TRUE(visit.ok()) << visit.message();
    return visit.ok() ? *visit : PageVisit();
  }

  /// The page with `script` run after its own scripts.
  [[nodiscard]] std::string WithScript(const std::string& script) const {
    std::string page = page_;
    return page.insert(page.rfind("</body>"), "<script>" + script + "</script>");
  }

  test::TemporaryFolder folder_;
  std::string page_;
};

/// A page that shows `name`, a file beside it, in a frame of `width` pixels (a window is never narrower than
/// 500), and marks what of it sticks out.
std::string InFrame(const std::string& name, int width) {
  return "<!DOCTYPE html><html><head></head><body style='margin:0'><iframe src='" + name +
         "' style='width:" + std::to_string(width) + R"(px;height:800px;border:0'></iframe><script>
    document.querySelector('iframe').addEventListener('load', function () {
      const page = this.contentDocument, root = page.documentElement;
      const boxes = Array.from(page.querySelectorAll('.table-scroll')).filter(function (box) { return box.clientWidth > 0; });
      const note = function (name, value) { document.documentElement.setAttribute('data-' + name, value); };
      note('ready', root.getAttribute('data-ready'));
      note('client', root.clientWidth);
      note('scroll', root.scrollWidth);
      note('boxes', boxes.length);
      note('boxes-outside', boxes.filter(function (box) { return box.getBoundingClientRect().right > root.clientWidth; }).length);
      note('tables-that-scroll', boxes.filter(function (box) { return box.scrollWidth > box.clientWidth; }).map(function (box) { return box.id; }).join(' '));
      note('plots-outside', Array.from(page.querySelectorAll('svg.plot')).filter(function (plot) {
        return plot.getBoundingClientRect().right > root.clientWidth; }).length);
    });
  </script></body></html>)";
}

void ExpectWhole(const PageVisit& visit) {
  EXPECT_THAT(visit.console, IsEmpty());
  EXPECT_EQ(visit.Mark("errors"), "");
  EXPECT_EQ(visit.Mark("ready"), "true");
  EXPECT_EQ(visit.Mark("plots"), std::to_string(kPlots));
}

TEST_F(ReportInBrowser, GivenAComparisonThenEveryPlotIsDrawnWithoutAComplaint) {
  const PageVisit visit = Open(page_);
  ExpectWhole(visit);
  // Three estimators in thirteen plots of lines, and the truth in two; three bands in each of six error
  // plots.
  EXPECT_EQ(visit.Mark("lines"), "41");
  EXPECT_EQ(visit.Mark("bands"), "18");
  EXPECT_THAT(visit.dom, HasSubstr("class=\"best\""));
  EXPECT_THAT(visit.dom, HasSubstr("alidade compare --plan=configs/plans/synthetic.yaml"));
  EXPECT_THAT(visit.dom, HasSubstr("<td class=\"digest\">5f1c1"));
}

TEST_F(ReportInBrowser, GivenAFailedRunThenItsReasonIsToldAndTheOthersAreDrawn) {
  const PageVisit visit = Open(page_, "#sequence=V1_01_easy&seed=2");
  ExpectWhole(visit);
  EXPECT_EQ(visit.Mark("lines"), "28");
  EXPECT_THAT(visit.dom, HasSubstr("&lt;/script&gt;&lt;b&gt;\"torn\" row, expected 4 columns</li>"));
  EXPECT_THAT(visit.dom, HasSubstr("1 of 2 ok"));
}

TEST_F(ReportInBrowser, GivenAnAuditedFilterThenItsLeakageIsDrawnAndTheOthersAreLeftOut) {
  Comparison comparison = test::SyntheticComparison(300);
  for (CellResult& cell : comparison.cells) {
    if (cell.estimator != "vins_mono_class") {
      cell.series.rank.assign(cell.series.time_s.size(), 11);
      cell.series.yaw_leak.assign(cell.series.time_s.size(), cell.estimator == "invio_l5" ? 4e3 : 3e-19);
      cell.series.position_leak.assign(cell.series.time_s.size(), 0);
    }
  }
  ASSERT_TRUE(WriteReport(comparison, folder_.File("audited.html")).ok());
  for (const char* address : {"", "#sequence=figure8&seed=all"}) {
    const PageVisit visit = Open(ReadFile(folder_.File("audited.html")), address);
    EXPECT_THAT(visit.console, IsEmpty());
    EXPECT_EQ(visit.Mark("errors"), "");
    EXPECT_EQ(visit.Mark("plots"), std::to_string(kPlots + 3));
    EXPECT_EQ(visit.Mark("lines"), *address == '\0' ? "47" : "53");  // two filters in three more plots
    EXPECT_THAT(visit.dom, HasSubstr("plot-yaw-leak"));
    EXPECT_THAT(visit.dom, HasSubstr(">1e-12<")) << "rounding is drawn at the floor";
  }
}

TEST_F(ReportInBrowser, GivenAllSeedsTogetherThenEveryEstimateIsDrawn) {
  const PageVisit visit = Open(page_, "#sequence=figure8&seed=all");
  ExpectWhole(visit);
  EXPECT_EQ(visit.Mark("lines"), "47");  // two more estimates of each estimator in top view and height
  EXPECT_THAT(visit.dom, HasSubstr("the mean of 2 independent runs"));
}

TEST_F(ReportInBrowser, GivenSeveralSeedsThenPairsAndTheBandOverTimeAreTold) {
  const PageVisit visit = Open(page_, "#sequence=figure8&seed=all");
  EXPECT_THAT(visit.dom, HasSubstr("row \u2212 column"));
  EXPECT_THAT(visit.dom, HasSubstr(", 2 pairs)"));
  EXPECT_THAT(visit.dom, HasSubstr("</span><span class=\"sub\">no difference</span>"));
  EXPECT_TRUE(
      std::regex_search(visit.dom, std::regex("Inside: po_invio_multi [0-9.]+ %, invio_l5 [0-9.]+ %")));
}

TEST_F(ReportInBrowser, GivenAnExternalTrajectoryThenWhatItLacksIsLeftOut) {
  Comparison comparison;
  comparison.title = "external";
  comparison.cells = {test::SyntheticCell("external", "walk", 1, 0.1, 1, 2, 50)};
  CellResult& cell = comparison.cells[0];
  cell.backend.clear();
  cell.align.clear();
  cell.rpe.clear();
  cell.nees_pose = cell.nees_ori = cell.nees_pos = cell.backend_ms = cell.backend_ms_p95 = 0;
  cell.series.sigma.clear();
  cell.series.backend_ms.clear();
  cell.series.features_used.clear();
  cell.series.tracks_in.clear();
  cell.series.nis_ratio.clear();
  std::fill(cell.series.nees_pose.begin(), cell.series.nees_pose.end(), std::nan(""));
  std::fill(cell.series.error.begin(), cell.series.error.end(), Vector6d::Zero());
  ASSERT_TRUE(WriteReport(comparison, folder_.File("external.html")).ok());
  const PageVisit visit = Open(ReadFile(folder_.File("external.html")));
  ExpectWhole(visit);
  EXPECT_EQ(visit.Mark("lines"), "10");  // two trajectories and their truth, six errors
  EXPECT_EQ(visit.Mark("bands"), "0");
  EXPECT_THAT(visit.dom, HasSubstr("no data for this selection"));
}

TEST_F(ReportInBrowser, GivenNothingToCompareThenThePageSaysSoInsteadOfFailing) {
  ASSERT_TRUE(WriteReport(Comparison{}, folder_.File("empty.html")).ok());
  const PageVisit visit = Open(ReadFile(folder_.File("empty.html")));
  EXPECT_THAT(visit.console, IsEmpty());
  EXPECT_THAT(visit.dom, HasSubstr("no runs"));
}

TEST_F(ReportInBrowser, GivenAPersonWhoPointsDragsAndSelectsThenThePlotsFollow) {
  const PageVisit visit = Open(WithScript(R"(
    const root = document.documentElement;
    const note = function (name, value) { root.setAttribute('data-' + name, value); };
    const overlay = function () { return document.querySelector('#plot-pos-0 .overlay'); };
    const send = function (type, share) {
      const box = overlay().getBoundingClientRect();
      overlay().dispatchEvent(new MouseEvent(type, { bubbles: true, clientX: box.left + share * box.width,
        clientY: box.top + 20 }));
    };
    send('mousemove', 0.5);
    note('tooltip', document.getElementById('tooltip').hidden ? 'hidden' : document.querySelectorAll('#tooltip tr').length);
    send('mousedown', 0.25);
    send('mousemove', 0.5);
    send('mouseup', 0.75);
    note('zoom', report.view.domain.map(Math.round).join(' '));
    document.getElementById('zoom-reset').click();
    note('unzoomed', report.view.domain === null);
    document.querySelector('.chip').click();
    note('lines-without-one', root.getAttribute('data-lines'));
    document.querySelector('#plot-top').closest('figure').querySelector('.save').click();
    const figure = document.getElementById('figure-select');
    figure.value = 'nees_pose';
    figure.dispatchEvent(new Event('change'));
    note('overview', document.getElementById('overview-note').textContent);
  )"));
  ExpectWhole(visit);
  EXPECT_EQ(visit.Mark("tooltip"), "3");
  EXPECT_EQ(visit.Mark("zoom"), "7 22");  // quarter to three quarters of 29.9 s
  EXPECT_EQ(visit.Mark("unzoomed"), "true");
  EXPECT_EQ(visit.Mark("lines-without-one"), "28");
  EXPECT_THAT(visit.Mark("overview"), HasSubstr("Ideal is 6."));
}

TEST_F(ReportInBrowser, GivenThePageThenItAsksTheNetworkForNothing) {
  EXPECT_FALSE(std::regex_search(page_.substr(0, page_.find("<script")),
                                 std::regex("(src|href)\\s*=\\s*[\"']?(https?:)?//|url\\(|@import")));
  const PageVisit visit =
      Open(WithScript("document.documentElement.setAttribute('data-requests', "
                      "performance.getEntriesByType('resource').filter("
                      "function (e) { return e.name.indexOf('data:') !== 0; }).length);"));
  EXPECT_EQ(visit.Mark("requests"), "0");
}

TEST_F(ReportInBrowser, GivenAPhoneThenOnlyTheTablesScrollSidewaysEachInItsBox) {
  for (const int width : {390, 1400}) {
    const PageVisit visit = Open(InFrame("report.html", width));
    EXPECT_EQ(visit.Mark("ready"), "true");
    EXPECT_EQ(visit.Mark("client"), std::to_string(width));
    EXPECT_LE(std::stoi("0" + visit.Mark("scroll")), width);
    EXPECT_EQ(visit.Mark("boxes"), "4");
    EXPECT_EQ(visit.Mark("boxes-outside"), "0");
    EXPECT_EQ(visit.Mark("plots-outside"), "0");
    if (width == 390) {
      EXPECT_THAT(visit.Mark("tables-that-scroll"), HasSubstr("sequence-table"));
    }
  }
}

TEST_F(ReportInBrowser, GivenPairsThenTheOverviewTellsWhichDifferencesAreSignificant) {
  const PageVisit best = Open(page_, "#figure=rmse_pos_m");
  EXPECT_THAT(best.dom, HasSubstr("the test of its difference to the best of the column"));
  EXPECT_TRUE(std::regex_search(
      best.dom, std::regex("class=\"sub test tie\" title=\"[^\"]*no difference\">\u2248 p = 0")));
  const PageVisit chosen = Open(page_, "#figure=rmse_pos_m&against=invio_l5");
  EXPECT_THAT(chosen.dom, HasSubstr("the test of its difference to invio_l5"));
  EXPECT_THAT(chosen.dom, HasSubstr("title=\"difference to invio_l5: "));
  EXPECT_THAT(best.dom, Not(HasSubstr("title=\"difference to invio_l5: ")));
}

TEST_F(ReportInBrowser, GivenAnEstimatorOrASequenceSwitchedOffThenItIsGoneFromTablesAndPlots) {
  const PageVisit visit = Open(WithScript(R"(
    const note = function (name, value) { document.documentElement.setAttribute('data-' + name, value); };
    const rows = function (id) { return document.querySelectorAll('#' + id + ' tbody tr:not(.reference)').length; };
    const press = function (id, name) { document.querySelector('#' + id + ' [data-name="' + name + '"]').click(); };
    note('rows', rows('overview-table') + ' ' + rows('sequence-table') + ' ' + rows('pairs-table'));
    press('chips', 'invio_l5');
    note('rows-without', rows('overview-table') + ' ' + rows('sequence-table') + ' ' + rows('pairs-table'));
    press('sequence-chips', 'figure8');
    note('columns', document.querySelectorAll('#overview-table thead th').length);
    note('title', document.getElementById('sequence-title').textContent);
    note('address', location.hash);
  )"));
  ExpectWhole(visit);
  EXPECT_EQ(visit.Mark("rows"), "3 3 6");  // pairs of the sequence, and over both
  EXPECT_EQ(visit.Mark("rows-without"), "2 2 4");
  EXPECT_EQ(visit.Mark("columns"), "2");
  EXPECT_EQ(visit.Mark("title"), "V1_01_easy");
  EXPECT_EQ(visit.Mark("address"), "#without=invio_l5&amp;skip=figure8");
  const PageVisit again = Open(page_, "#without=invio_l5&skip=figure8");
  EXPECT_EQ(again.Mark("lines"), visit.Mark("lines"));
  EXPECT_THAT(again.dom, HasSubstr("data-name=\"invio_l5\" aria-pressed=\"false\""));
}

TEST_F(ReportInBrowser, GivenRunsThatWereLostOrNotStartedThenTheOverviewNamesThem) {
  Comparison comparison = test::SyntheticComparison(60);
  comparison.notes = {"MH_05: its data is not there, expected the folder /data/<MH_05> & more"};
  ASSERT_TRUE(WriteReport(comparison, folder_.File("absent.html")).ok());
  const PageVisit visit = Open(ReadFile(folder_.File("absent.html")));
  EXPECT_THAT(
      visit.dom,
      HasSubstr("<li>MH_05: its data is not there, expected the folder /data/&lt;MH_05&gt; &amp; more</li>"));
  EXPECT_THAT(visit.dom, HasSubstr("1 not ok</b>; <b class=\"bad\">not run: 1</b>"));
  EXPECT_THAT(visit.dom, HasSubstr("vins_mono_class on V1_01_easy, seed 2: failed</span>"));
}

TEST_F(ReportInBrowser, GivenGnssThenItsInnovationsHaveAPlotOfTheirOwn) {
  Comparison comparison;
  comparison.cells = {test::SyntheticCell("gvio", "field", 1, 0.1, 1, 2, 60),
                      test::SyntheticCell("vio", "field", 1, 0.1, 1, 2, 60)};
  ASSERT_TRUE(WriteReport(comparison, folder_.File("without.html")).ok());
  EXPECT_THAT(Open(ReadFile(folder_.File("without.html"))).dom, Not(HasSubstr("of GNSS: gvio")));
  CellResult& gvio = comparison.cells[0];
  gvio.series.gnss_nis_ratio = gvio.series.nis_ratio;
  gvio.gnss_innovations = {0.97, 0.95, {0.5, 1.7}};
  ASSERT_TRUE(WriteReport(comparison, folder_.File("with.html")).ok());
  const PageVisit visit = Open(ReadFile(folder_.File("with.html")));
  EXPECT_THAT(visit.console, IsEmpty());
  EXPECT_EQ(visit.Mark("errors"), "");
  EXPECT_THAT(visit.dom, HasSubstr("of GNSS: gvio 0.97, 95.0 %."));
}

TEST_F(ReportInBrowser, GivenDifferentAlignmentsThenItSaysWhose) {
  Comparison comparison;
  comparison.title = "mixed";
  for (const char* name : {"gvio", "gvins_class", "pockf"}) {
    comparison.cells.push_back(test::SyntheticCell(name, "field", 1, 0.1, 1, 2, 60));
    comparison.cells.back().align = "none";
  }
  comparison.cells.back().align = "posyaw of the first 5 %";
  ASSERT_TRUE(WriteReport(comparison, folder_.File("mixed.html")).ok());
  const PageVisit visit = Open(ReadFile(folder_.File("mixed.html")));
  ExpectWhole(visit);
  EXPECT_THAT(visit.dom, HasSubstr("none: gvio, gvins_class; posyaw of the first 5 %: pockf"));
}

TEST_F(ReportInBrowser, GivenNamesOfMarkupThenTheyAreTextEverywhere) {
  const std::string evil = "<img src=x>&amp;\"'`${x}";
  Comparison comparison;
  comparison.title = evil;
  comparison.command = evil;
  comparison.notes = {evil};
  comparison.references = {{evil, evil, evil, {{"ate_pos_m", 0.1}}}};
  for (const unsigned seed : {1U, 2U}) {
    comparison.cells.push_back(test::SyntheticCell(evil, evil, seed, 0.1, 1, 2, 60));
    comparison.cells.push_back(test::SyntheticCell("plain", evil, seed, 0.12, 1, 2, 60));
    comparison.cells.back().message = evil;
  }
  comparison.cells.back().status = evil;
  comparison.cells[0].sky = {{evil, {0, 1}, {10, 11}, {40, 41}, {0.1, 0.2}, 1, 0.1}};
  ASSERT_TRUE(WriteReport(comparison, folder_.File("evil.html")).ok());
  std::string page = ReadFile(folder_.File("evil.html"));
  page.insert(page.rfind("</body>"), R"(<script>
    document.querySelector('#chips .chip').click();
    document.documentElement.setAttribute('data-images', document.images.length);
    document.documentElement.setAttribute('data-heading', document.querySelector('h1').textContent.length);
    document.documentElement.setAttribute('data-address', decodeURIComponent(location.hash).length);
  </script>)");
  const PageVisit visit = Open(page);
  EXPECT_THAT(visit.console, IsEmpty());
  EXPECT_EQ(visit.Mark("errors"), "");
  EXPECT_EQ(visit.Mark("ready"), "true");
  EXPECT_EQ(visit.Mark("images"), "0");
  EXPECT_EQ(visit.Mark("heading"), std::to_string(evil.size()));
  EXPECT_EQ(visit.Mark("address"), std::to_string(std::string("#without=").size() + evil.size()));
}

TEST_F(ReportInBrowser, GivenTenEstimatorsOnTenSequencesThenThePlotsStayReadable) {
  ASSERT_TRUE(WriteReport(test::LargeComparison(), folder_.File("large.html")).ok());
  const PageVisit visit = Open(ReadFile(folder_.File("large.html")));
  EXPECT_THAT(visit.console, IsEmpty());
  EXPECT_EQ(visit.Mark("errors"), "");
  EXPECT_EQ(visit.Mark("plots"), std::to_string(kPlots + 2));  // the sky and its residuals
  EXPECT_THAT(visit.dom, HasSubstr("The plots draw the first 8 of the 10 estimators"));
  EXPECT_EQ(visit.Mark("bands"), "48");
  const PageVisit phone = Open(InFrame("large.html", 390));
  EXPECT_LE(std::stoi("0" + phone.Mark("scroll")), 390);
  EXPECT_EQ(phone.Mark("boxes-outside"), "0");
}

// The checks above must be able to fail.
TEST_F(ReportInBrowser, GivenAPageWithAFaultThenTheFaultIsSeen) {
  const size_t call = page_.find("drawFacts();\n");
  ASSERT_NE(call, std::string::npos);
  std::string broken = page_;
  broken.replace(call, 12, "noSuchThing();");
  const PageVisit visit = Open(broken);
  EXPECT_THAT(visit.console, HasSubstr("noSuchThing"));
  EXPECT_THAT(visit.Mark("errors"), HasSubstr("noSuchThing"));
  EXPECT_EQ(visit.Mark("ready"), "");
  EXPECT_THAT(visit.dom, HasSubstr("This page met a fault"));
}

}  // namespace
}  // namespace alidade
