#include "eval/report/report.h"

#include <map>
#include <string>

#include "eval/files/escape_html.h"
#include "eval/files/output_file.h"
#include "eval/report/report_assets.h"
#include "eval/report/report_data.h"
#include "eval/report/tables_terminal.h"

namespace alidade {
namespace {

/// Puts `values` into the {{NAME}} places of the template, in one pass: what is put in is never searched
/// again.
std::string FillTemplate(std::string_view page,
                         const std::map<std::string, std::string, std::less<>>& values) {
  std::string filled;
  while (true) {
    const size_t open = page.find("{{");
    const size_t close = page.find("}}", open);
    if (open == std::string_view::npos || close == std::string_view::npos) {
      return filled.append(page);
    }
    filled.append(page.substr(0, open));
    const auto found = values.find(page.substr(open + 2, close - open - 2));
    if (found != values.end()) {
      filled += found->second;
    }
    page.remove_prefix(close + 2);
  }
}

}  // namespace

Status WriteReport(const Comparison& comparison, const std::string& path) {
  const std::string page = FillTemplate(kReportHtml, {{"TITLE", EscapeHtml(comparison.title)},
                                                      {"CSS", std::string(kReportCss)},
                                                      {"D3", std::string(kReportD3)},
                                                      {"DATA", ReportData(comparison)},
                                                      {"SCRIPT", std::string(kReportScript)},
                                                      {"TABLE", EscapeHtml(FormatTable(comparison))}});
  return WriteFileAtomically(path, page);
}

}  // namespace alidade
