// Opens the report in a headless browser: a page is right only when a browser draws it without a complaint.
#include <regex>

#include "tests/eval/report/report_in_browser.h"

namespace alidade {
namespace {

using test::ExpectWhole;
using test::kPlots;
using test::PageVisit;
using test::ReadFile;
using test::ReportInBrowser;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

TEST_F(ReportInBrowser, GivenAFailedRunThenItsReasonIsShownAndTheOthersAreDrawn) {
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

TEST_F(ReportInBrowser, GivenSeveralSeedsThenPairsAndTheBandOverTimeAreShown) {
  const PageVisit visit = Open(page_, "#sequence=figure8&seed=all");
  EXPECT_THAT(visit.dom, HasSubstr("row \u2212 column"));
  EXPECT_THAT(visit.dom, HasSubstr(", 2 pairs)"));
  EXPECT_THAT(visit.dom, HasSubstr("</span><span class=\"sub\">no difference</span>"));
  EXPECT_THAT(visit.dom, HasSubstr("<span class=\"sub\">Holm = "));
  EXPECT_THAT(visit.dom, HasSubstr("NEES: squared error in units of the covariance"));
  EXPECT_THAT(visit.dom, HasSubstr("in position and yaw about gravity"));
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
  for (std::optional<double>* figure : {&cell.nees_pose, &cell.nees_ori, &cell.nees_pos,
                                        &cell.coverage_3sigma, &cell.backend_ms, &cell.backend_ms_p95}) {
    figure->reset();
  }
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

TEST_F(ReportInBrowser, GivenNothingToCompareThenThePageShowsThatInsteadOfFailing) {
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

TEST_F(ReportInBrowser, GivenAScriptOrAnImageThatIsNotThePagesThenTheBrowserRefusesIt) {
  std::string page = page_;
  page.insert(page.rfind("</body>"),
              "<script>document.documentElement.setAttribute('data-foreign', 'ran');</script>"
              "<img src='picture.svg'>");
  const PageVisit visit = Open(page);
  EXPECT_EQ(visit.Mark("ready"), "true");
  EXPECT_EQ(visit.Mark("foreign"), "");
  const std::string console = ::testing::PrintToString(visit.console);
  EXPECT_THAT(console, HasSubstr("Content Security Policy"));
  EXPECT_THAT(console, HasSubstr("picture.svg"));
}

TEST_F(ReportInBrowser, GivenAPhoneThenOnlyTheTablesScrollSidewaysEachInItsBox) {
  for (const int width : {390, 1400}) {
    const PageVisit visit = Open(InFrame("report.html", width));
    EXPECT_EQ(visit.Mark("ready"), "true");
    EXPECT_EQ(visit.Mark("client"), std::to_string(width));
    EXPECT_LE(std::stoi("0" + visit.Mark("scroll")), width);
    EXPECT_EQ(visit.Mark("boxes"), "7");
    EXPECT_EQ(visit.Mark("boxes-outside"), "0");
    EXPECT_EQ(visit.Mark("plots-outside"), "0");
    if (width == 390) {
      EXPECT_THAT(visit.Mark("tables-that-scroll"), HasSubstr("sequence-table"));
    }
  }
}

TEST_F(ReportInBrowser, GivenTenEstimatorsOnTenSequencesThenThePlotsStayReadable) {
  ASSERT_TRUE(WriteReport(test::LargeComparison(), folder_.File("large.html")).ok());
  const PageVisit visit = Open(ReadFile(folder_.File("large.html")));
  EXPECT_THAT(visit.console, IsEmpty());
  EXPECT_EQ(visit.Mark("errors"), "");
  EXPECT_EQ(visit.Mark("plots"), std::to_string(kPlots + 2));  // the sky and its residuals
  EXPECT_THAT(visit.dom, HasSubstr("The plots show the first 8 of the 10 selected estimators"));
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
  broken.replace(broken.rfind("<script>", call), 8, "<script nonce=\"test\">");
  const PageVisit visit = Open(Admitting(broken));
  EXPECT_THAT(visit.console, HasSubstr("noSuchThing"));
  EXPECT_THAT(visit.Mark("errors"), HasSubstr("noSuchThing"));
  EXPECT_EQ(visit.Mark("ready"), "");
  EXPECT_THAT(visit.dom, HasSubstr("This page met a fault"));
}

}  // namespace
}  // namespace alidade
