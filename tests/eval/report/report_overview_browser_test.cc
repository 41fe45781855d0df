// The report's words and tables, as a browser shows it.
#include <regex>

#include "tests/eval/report/report_in_browser.h"

namespace alidade {
namespace {

using test::ExpectWhole;
using test::PageVisit;
using test::ReadFile;
using test::ReportInBrowser;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST_F(ReportInBrowser, GivenPairsThenTheOverviewMarksTheSignificantDifferences) {
  const PageVisit best = Open(page_, "#figure=rmse_pos_m");
  EXPECT_THAT(best.dom, HasSubstr("the test of its difference to the best of the column"));
  EXPECT_TRUE(std::regex_search(
      best.dom,
      std::regex("class=\"sub test tie\" title=\"[^\"]*no difference; Holm p = [0-9.]+\">\u2248 p = 0")));
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
  comparison.notes = {"MH_05: its data is missing, expected the folder /data/<MH_05> & more"};
  ASSERT_TRUE(WriteReport(comparison, folder_.File("absent.html")).ok());
  const PageVisit visit = Open(ReadFile(folder_.File("absent.html")));
  EXPECT_THAT(
      visit.dom,
      HasSubstr("<li>MH_05: its data is missing, expected the folder /data/&lt;MH_05&gt; &amp; more</li>"));
  EXPECT_THAT(visit.dom, HasSubstr("1 not ok</b>; <b class=\"bad\">not run: 1</b>"));
  EXPECT_THAT(visit.dom, HasSubstr("vins_mono_class on V1_01_easy, seed 2: failed</span>"));
}

TEST_F(ReportInBrowser, GivenGnssAndFixesThenTheirInnovationsHavePlotsOfTheirOwn) {
  Comparison comparison;
  comparison.cells = {test::SyntheticCell("gvio", "field", 1, 0.1, 1, 2, 60),
                      test::SyntheticCell("vio", "field", 1, 0.1, 1, 2, 60)};
  ASSERT_TRUE(WriteReport(comparison, folder_.File("without.html")).ok());
  EXPECT_THAT(Open(ReadFile(folder_.File("without.html"))).dom, Not(HasSubstr("of GNSS: gvio")));
  CellResult& gvio = comparison.cells[0];
  gvio.series.sensor_nis_ratio["gnss"] = gvio.series.nis_ratio;
  gvio.sensor_innovations["gnss"] = {0.97, 0.95, std::pair(0.5, 1.7)};
  comparison.cells[1].series.sensor_nis_ratio["fix"] = gvio.series.nis_ratio;
  comparison.cells[1].sensor_innovations["fix"] = {1.02, 0.94, std::pair(0.1, 2.3)};
  ASSERT_TRUE(WriteReport(comparison, folder_.File("with.html")).ok());
  const PageVisit visit = Open(ReadFile(folder_.File("with.html")));
  EXPECT_THAT(visit.console, IsEmpty());
  EXPECT_EQ(visit.Mark("errors"), "");
  EXPECT_THAT(visit.dom, HasSubstr("of GNSS: gvio 0.97, 95.0 %; of position fixes: vio 1.02, 94.0 %."));
}

TEST_F(ReportInBrowser, GivenATableThenItIsAtLeastAsWideAsItsPlace) {
  const PageVisit visit = Open(WithScript(R"(
    const boxes = Array.from(document.querySelectorAll('.table-scroll')).filter(function (box) { return box.clientWidth > 0; });
    const narrow = boxes.filter(function (box) { return box.firstElementChild.getBoundingClientRect().width < box.clientWidth - 1; });
    document.documentElement.setAttribute('data-tables', boxes.length);
    document.documentElement.setAttribute('data-narrow', narrow.map(function (box) { return box.id || 'map'; }).join(' '));
  )"));
  EXPECT_EQ(visit.Mark("tables"), "7");
  EXPECT_EQ(visit.Mark("narrow"), "");
}

TEST_F(ReportInBrowser, GivenAPlotThenItHasALegendOfItsOwn) {
  const PageVisit visit = Open(WithScript(R"(
    const entries = function (plot) { return plot.closest('figure').querySelectorAll('.plot-legend .legend').length; };
    const of = function (id) { return entries(document.getElementById('plot-' + id)); };
    const bare = Array.from(document.querySelectorAll('svg.plot')).filter(function (plot) { return entries(plot) < 3; });
    document.documentElement.setAttribute('data-bare', bare.map(function (plot) { return plot.id; }).join(' '));
    document.documentElement.setAttribute('data-legends', [of('top'), of('pos-0'), of('nees'), of('stages')].join(' '));
  )"));
  ExpectWhole(visit);
  EXPECT_EQ(visit.Mark("bare"), "");
  EXPECT_EQ(visit.Mark("legends"), "4 3 4 4")
      << "with the truth, three estimators, with the band, four stages";
}

TEST_F(ReportInBrowser, GivenASmoothedEstimatorThenItIsMarkedAndNotTheBest) {
  Comparison comparison = test::SyntheticComparison(60);
  for (CellResult& cell : comparison.cells) {
    if (cell.estimator == "po_invio_multi") {
      cell.smoothed = true;
      cell.ate_pos_m = 1e-3;
    }
  }
  ASSERT_TRUE(WriteReport(comparison, folder_.File("smoothed.html")).ok());
  const PageVisit visit = Open(Probed(ReadFile(folder_.File("smoothed.html")), R"(
    const row = document.querySelector('#overview-table tbody tr');
    document.documentElement.setAttribute('data-row', row.querySelector('th').textContent);
    document.documentElement.setAttribute('data-best', row.querySelectorAll('.best').length);
    document.documentElement.setAttribute('data-chip', document.querySelector('#chips .chip').textContent);
    document.documentElement.setAttribute('data-legend', document.querySelector('.plot-legend .legend').textContent);
    document.documentElement.setAttribute('data-note', document.getElementById('overview-note').textContent);
  )"));
  ExpectWhole(visit);
  EXPECT_EQ(visit.Mark("row"), "po_invio_multifilter, smoothed");
  EXPECT_EQ(visit.Mark("best"), "0");
  EXPECT_EQ(visit.Mark("chip"), "po_invio_multi (smoothed)");
  EXPECT_EQ(visit.Mark("legend"), "po_invio_multi (smoothed)");
  EXPECT_THAT(visit.Mark("note"), HasSubstr("Smoothed: uses later data (po_invio_multi), which"));
  const PageVisit causal =
      Open(WithScript("document.documentElement.setAttribute('data-note', "
                      "document.getElementById('overview-note').textContent);"));
  EXPECT_THAT(causal.Mark("note"), AllOf(HasSubstr("ATE"), Not(HasSubstr("Smoothed"))));
}

TEST_F(ReportInBrowser, GivenAnEstimatorThatLostEveryRunThenItsCompletionIsShownAllTheSame) {
  Comparison comparison = test::SyntheticComparison(60);
  for (CellResult& cell : comparison.cells) {
    if (cell.estimator == "invio_l5") {
      cell.status = "diverged";
      cell.completion = cell.seed == 1 ? 0.2 : 0.4;
    }
  }
  ASSERT_TRUE(WriteReport(comparison, folder_.File("lost.html")).ok());
  const PageVisit visit = Open(Probed(ReadFile(folder_.File("lost.html")), R"(
    const texts = function (id) {
      return Array.from(document.querySelectorAll('#' + id + ' tbody tr:nth-child(2) td')).map(function (cell) { return cell.textContent; });
    };
    document.documentElement.setAttribute('data-overview', texts('overview-table').join('|'));
    document.documentElement.setAttribute('data-note', document.getElementById('overview-note').textContent);
    document.documentElement.setAttribute('data-sequence-note', document.getElementById('sequence-note').textContent);
  )"),
                               "#figure=completion");
  ExpectWhole(visit);
  EXPECT_THAT(visit.Mark("overview"), HasSubstr("0.300\u00b1 0.1000 of 2 ok"));
  EXPECT_THAT(visit.Mark("note"), HasSubstr("mean over all seeds"));
  EXPECT_THAT(visit.Mark("note"), HasSubstr("share of the time from the first to the last camera frame"));
  EXPECT_THAT(visit.Mark("sequence-note"), HasSubstr("seconds of camera data that a second of front end"));
}

TEST_F(ReportInBrowser, GivenDifferentAlignmentsThenItNamesThem) {
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
  EXPECT_THAT(visit.dom,
              HasSubstr("none: gvio, gvins_class; posyaw of the first 5 %: pockf; none: as it is; posyaw: "
                        "in position and yaw about gravity"));
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
  const PageVisit visit = Open(Probed(ReadFile(folder_.File("evil.html")), R"(
    document.querySelector('#chips .chip').click();
    document.documentElement.setAttribute('data-images', document.images.length);
    document.documentElement.setAttribute('data-heading', document.querySelector('h1').textContent.length);
    document.documentElement.setAttribute('data-address', decodeURIComponent(location.hash).length);
  )"));
  EXPECT_THAT(visit.console, IsEmpty());
  EXPECT_EQ(visit.Mark("errors"), "");
  EXPECT_EQ(visit.Mark("ready"), "true");
  EXPECT_EQ(visit.Mark("images"), "0");
  EXPECT_EQ(visit.Mark("heading"), std::to_string(evil.size()));
  EXPECT_EQ(visit.Mark("address"), std::to_string(std::string("#without=").size() + evil.size()));
}

}  // namespace
}  // namespace alidade
