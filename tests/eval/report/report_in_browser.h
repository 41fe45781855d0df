#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "eval/report/report.h"
#include "tests/eval/report/headless_browser.h"
#include "tests/eval/report/synthetic_comparison.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {

inline constexpr int kPlots = 16;

class ReportInBrowser : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(HeadlessBrowser::kChromium)) {
      GTEST_SKIP() << "no " << HeadlessBrowser::kChromium << ": install the Debian package chromium";
    }
    ASSERT_TRUE(WriteReport(SyntheticComparison(300), folder_.File("report.html")).ok());
    page_ = ReadFile(folder_.File("report.html"));
  }

  /// Opens `page` with `address` ("#...") appended to its location.
  PageVisit Open(const std::string& page, const std::string& address = "") {
    const Result<PageVisit> visit = HeadlessBrowser().Open(folder_.Write("visited.html", page), address);
    EXPECT_TRUE(visit.ok()) << visit.message();
    return visit.ok() ? *visit : PageVisit();
  }

  /// The page with `script` run after its own scripts.
  [[nodiscard]] std::string WithScript(const std::string& script) const { return Probed(page_, script); }
  /// A page with a script of the test, which its security policy lets run beside its own.
  [[nodiscard]] static std::string Probed(std::string page, const std::string& script) {
    page = Admitting(std::move(page));
    return page.insert(page.rfind("</body>"), "<script nonce=\"test\">" + script + "</script>");
  }
  /// A page whose security policy also admits scripts with the nonce "test".
  [[nodiscard]] static std::string Admitting(std::string page) {
    const std::string sources = "script-src ";
    const std::size_t policy = page.find(sources);
    EXPECT_NE(policy, std::string::npos);
    return page.insert(policy + sources.size(), "'nonce-test' ");
  }

  TemporaryFolder folder_;
  std::string page_;
};

inline void ExpectWhole(const PageVisit& visit) {
  EXPECT_THAT(visit.console, ::testing::IsEmpty());
  EXPECT_EQ(visit.Mark("errors"), "");
  EXPECT_EQ(visit.Mark("ready"), "true");
  EXPECT_EQ(visit.Mark("plots"), std::to_string(kPlots));
}

}  // namespace alidade::test
