#include "eval/report/tables_terminal.h"

#include <algorithm>
#include <iterator>

#include "eval/report/pair_tables.h"
#include "eval/report/table_layout.h"
#include "eval/report/tables_text.h"
#include "eval/report/text_table.h"

namespace alidade {
namespace {

/// Columns that a character takes on a terminal: our tables hold nothing wider than one.
size_t DisplayWidth(const std::string& text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // not a UTF-8 continuation byte
  }));
}

std::string Pad(const std::string& text, size_t width, bool right) {
  const size_t shown = DisplayWidth(text);
  const std::string blanks(width > shown ? width - shown : 0, ' ');
  return right ? blanks + text : text + blanks;
}

/// The best value is starred; every other number keeps the star's place, so that the digits line up.
std::string Mark(const TextCell& cell, size_t column) {
  return column == 0 ? cell.text : cell.text + (cell.best ? "*" : " ");
}

std::string TerminalTable(const TextTable& table) {
  std::vector<size_t> widths;
  for (size_t i = 0; i < table.header.size(); ++i) {
    size_t width = DisplayWidth(table.header[i]) + (i > 0 ? 1 : 0);
    for (const TextRow& row : table.rows) {
      width = std::max(width, DisplayWidth(Mark(row.cells[i], i)));
    }
    widths.push_back(width);
  }
  std::string text = table.title + "\n";
  size_t total = 0;
  for (size_t i = 0; i < widths.size(); ++i) {
    text += (i > 0 ? " " : "  ") + Pad(table.header[i] + (i > 0 ? " " : ""), widths[i], i > 0);
    total += widths[i] + (i > 0 ? 1 : 0);
  }
  const std::string rule = "  " + std::string(total, '-') + "\n";
  text += "\n" + rule;
  bool references = false;
  for (const TextRow& row : table.rows) {
    text += row.reference && !references ? rule : "";
    references = row.reference;
    for (size_t i = 0; i < widths.size(); ++i) {
      text += (i > 0 ? " " : "  ") + Pad(Mark(row.cells[i], i), widths[i], i > 0);
    }
    text += "\n";
  }
  return text;
}

/// Columns whose headings begin so are in the files alone.
constexpr const char* kDropped[] = {
    "RPE",       "front end", "back end p95",   "NEES pos.", "NEES ori.",    "NEES vel.",
    "NEES gyro", "NEES acc",  "alarms inside ", "features",  "NEES in band", "x real time"};

/// A terminal is narrow: the columns one reads first; the files have them all.
TextTable KeepColumns(const TextTable& table) {
  TextTable kept{table.title, {}, {}};
  std::vector<size_t> columns;
  for (size_t i = 0; i < table.header.size(); ++i) {
    const std::string& heading = table.header[i];
    const bool drop = std::any_of(std::begin(kDropped), std::end(kDropped),
                                  [&heading](const char* start) { return heading.starts_with(start); });
    if (!drop) {
      columns.push_back(i);
      kept.header.push_back(heading);
    }
  }
  for (const TextRow& row : table.rows) {
    TextRow shorter{{}, row.reference};
    for (const size_t column : columns) {
      shorter.cells.push_back(row.cells[column]);
    }
    kept.rows.push_back(shorter);
  }
  return kept;
}

}  // namespace

std::string FormatTable(const Comparison& comparison) {
  std::string text = comparison.title.empty() ? "" : comparison.title + "\n\n";
  for (const TextTable& table : LayOutTables(comparison, "\u00b1")) {
    // The overviews repeat the tables of the sequences; the matrices of pairs are too wide.
    if (!table.title.starts_with("Overview") && !table.title.starts_with(kPairTitle)) {
      text += TerminalTable(KeepColumns(table)) + "\n";
    }
  }
  text += "Means over ok runs \u00b1 standard error; * best of the column (NEES: nearest to 6, 3).\n";
  for (const std::string& remark : {TruthCovarianceRemark(comparison), SmoothedRemark(comparison)}) {
    text += remark.empty() ? "" : remark + "\n";
  }
  for (const std::string& line : LostRuns(comparison)) {
    text += line + "\n";
  }
  for (const std::string& note : comparison.notes) {
    text += "not run: " + note + "\n";
  }
  return text;
}

}  // namespace alidade
