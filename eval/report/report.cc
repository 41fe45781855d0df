#include "eval/report/report.h"

#include <map>
#include <string>

#include "eval/files/escape_html.h"
#include "eval/files/hash.h"
#include "eval/files/output_file.h"
#include "eval/report/report_assets.h"
#include "eval/report/report_data.h"
#include "eval/report/tables_terminal.h"
#include "eval/report/tables_text.h"

namespace alidade {
namespace {

std::string Base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (size_t k = 0; k < 3; ++k) {
      word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (size_t k = 0; k < 4; ++k) {
      text.push_back(i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63] : '=');
    }
  }
  return text;
}

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

/// A source of a content security policy: the inline script with exactly this text.
std::string HashSource(std::string_view script) {
  const std::string hex = Sha256Hex(script);
  std::string bytes;
  for (size_t i = 0; i < hex.size(); i += 2) {
    bytes.push_back(static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  }
  return "'sha256-" + Base64(bytes) + "'";
}

/// Nothing but the page's own scripts and styles and images in it: names in a comparison come from elsewhere.
std::string SecurityPolicy() {
  return "default-src 'none'; script-src " + HashSource(kReportD3) + " " + HashSource(kReportScript) +
         "; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";
}

}  // namespace

Status WriteReport(const Comparison& comparison, const std::string& path) {
  const std::string page =
      FillTemplate(kReportHtml, {{"POLICY", SecurityPolicy()},
                                 {"TITLE", EscapeHtml(comparison.title)},
                                 {"MADE", EscapeHtml(ProvenanceText(comparison.provenance))},
                                 {"CSS", std::string(kReportCss)},
                                 {"D3", std::string(kReportD3)},
                                 {"DATA", ReportData(comparison)},
                                 {"SCRIPT", std::string(kReportScript)},
                                 {"TABLE", EscapeHtml(FormatTable(comparison))}});
  return WriteFileAtomically(path, page);
}

}  // namespace alidade
