#include "eval/report/tables_text.h"

#include <string_view>

namespace alidade {
namespace {

/// Puts a backslash before each of the characters `special`; line breaks become blanks.
std::string Backslash(const std::string& text, std::string_view special) {
  std::string escaped;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) {
      escaped += '\\';
    }
    escaped += c == '\n' || c == '\r' ? ' ' : c;
  }
  return escaped;
}

std::string EscapeMarkdown(const std::string& text) {
  return Backslash(text, "|_*`<>\\[]");
}

void ReplaceAll(const std::string& from, const std::string& to, std::string* text) {
  for (size_t at = text->find(from); at != std::string::npos; at = text->find(from, at + to.size())) {
    text->replace(at, from.size(), to);
  }
}

std::string EscapeLatex(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    escaped +=
        c == '\\' ? std::string("\x01") : std::string(1, c);  // held apart from the backslashes that follow
  }
  escaped = Backslash(escaped, "&%$#_{}");
  ReplaceAll("\x01", "\\textbackslash{}", &escaped);
  ReplaceAll("~", "\\textasciitilde{}", &escaped);
  ReplaceAll("^", "\\textasciicircum{}", &escaped);
  ReplaceAll("\u00b1", "$\\pm$", &escaped);
  ReplaceAll("\u03c3", "$\\sigma$", &escaped);
  ReplaceAll("\u2013", "--", &escaped);
  ReplaceAll("\u2248", "$\\approx$", &escaped);
  ReplaceAll("\u2212", "$-$", &escaped);
  return escaped;
}

std::string MarkdownTable(const TextTable& table) {
  std::string text = "## ";
  text += EscapeMarkdown(table.title) + "\n\n|";
  for (const std::string& heading : table.header) {
    text.append(" ").append(EscapeMarkdown(heading)).append(" |");
  }
  text += "\n|:---|";
  for (size_t i = 1; i < table.header.size(); ++i) {
    text += "---:|";
  }
  for (const TextRow& row : table.rows) {
    text += "\n|";
    for (const TextCell& cell : row.cells) {
      const std::string mark = cell.best ? "**" : row.reference ? "*" : "";
      text.append(" ").append(mark).append(EscapeMarkdown(cell.text)).append(mark).append(" |");
    }
  }
  return text + "\n";
}

std::string LatexTable(const TextTable& table) {
  std::string text = "\\begin{table}\n  \\centering\n  \\caption{" + EscapeLatex(table.title) +
                     "}\n  \\begin{tabular}{l" + std::string(table.header.size() - 1, 'r') +
                     "}\n    \\toprule\n    ";
  for (size_t i = 0; i < table.header.size(); ++i) {
    text += (i > 0 ? " & " : "") + EscapeLatex(table.header[i]);
  }
  text += " \\\\\n    \\midrule\n";
  bool references = false;
  for (const TextRow& row : table.rows) {
    text += row.reference && !references ? "    \\midrule\n" : "";
    references = row.reference;
    text += "    ";
    for (size_t i = 0; i < row.cells.size(); ++i) {
      const TextCell& cell = row.cells[i];
      const std::string command = cell.best ? "\\textbf{" : row.reference ? "\\textit{" : "{";
      text += (i > 0 ? " & " : "") + command + EscapeLatex(cell.text) + "}";
    }
    text += " \\\\\n";
  }
  return text + "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n";
}

const char* const kReading =
    "Means over the runs that ended ok, with the standard error of the mean where there are several. RMSE is "
    "unaligned; the alignment of ATE is in summary.csv. The best value of a column is bold (NEES: nearest to "
    "its degrees of freedom, 6, 3 and 3), among the estimators with the most runs ok; \u2248 marks values "
    "whose paired difference to it is not significant. Published figures are in italics. NEES in band: share "
    "of the instants at which the NEES averaged over the runs is in its 95 % chi-square band; the verdict "
    "compares the mean NEES with the band of that many independent runs. Pairs: differences on equal input "
    "and seed, with half of their 95 % interval (Student's t); significant when the interval excludes zero, "
    "bold "
    "when significantly better. p: of the pair alone; Holm: corrected for the number of pairs of the table. "
    "pairs.csv has all pairs. "
    "Efficiency: bound divided by achieved RMSE on the runs that both finished; hindsight is the batch "
    "estimate's own RMSE, smoothing the deviation it predicts for itself, filtering the deviation given only "
    "the data up to each frame, the bound of online estimators.";

}  // namespace

std::vector<std::string> LostRuns(const Comparison& comparison) {
  std::vector<std::string> lines;
  for (const CellResult& cell : comparison.cells) {
    if (cell.status != "ok") {
      lines.push_back(cell.estimator + " on " + cell.sequence + ", seed " + std::to_string(cell.seed) + ": " +
                      cell.status + (cell.message.empty() ? "" : ": " + cell.message));
    }
  }
  return lines;
}

std::string TruthCovarianceRemark(const Comparison& comparison) {
  std::string names;
  for (const std::string& name : comparison.SequencesWithTruthCovariance()) {
    names += (names.empty() ? "" : ", ") + name;
  }
  return names.empty() ? ""
                       : "NEES and 3 \u03c3 are those of P_estimate + P_truth: the truth has a covariance (" +
                             names + ").";
}

std::string MarkdownText(const Comparison& comparison, const std::vector<TextTable>& tables) {
  std::string text = "# ";
  text += EscapeMarkdown(comparison.title) + "\n\n" + kReading + "\n";
  if (const std::string remark = TruthCovarianceRemark(comparison); !remark.empty()) {
    text += "\n" + EscapeMarkdown(remark) + "\n";
  }
  for (const TextTable& table : tables) {
    text += "\n";
    text += MarkdownTable(table);
  }
  const std::vector<std::string> lost = LostRuns(comparison);
  text += lost.empty() ? "\nEvery run ended ok.\n" : "\n## Runs that did not end ok\n\n";
  for (const std::string& line : lost) {
    text += "- " + EscapeMarkdown(line) + "\n";
  }
  text += comparison.shown_note.empty() ? "" : "\n" + comparison.shown_note + "\n";
  text += comparison.notes.empty() ? "" : "\n## Not run\n\n";
  for (const std::string& note : comparison.notes) {
    text += "- " + EscapeMarkdown(note) + "\n";
  }
  return comparison.command.empty() ? text : text + "\nRepeat with:\n\n    " + comparison.command + "\n";
}

std::string LatexText(const Comparison& comparison, const std::vector<TextTable>& tables) {
  std::string text =
      "% Needs \\usepackage{booktabs}.\n% " + EscapeLatex(comparison.title) + "\n% " + kReading + "\n";
  if (const std::string remark = TruthCovarianceRemark(comparison); !remark.empty()) {
    text += "% " + EscapeLatex(remark) + "\n";
  }
  for (const TextTable& table : tables) {
    text += "\n";
    text += LatexTable(table);
  }
  for (const std::string& line : LostRuns(comparison)) {
    text += "\n% Not ok: " + EscapeLatex(line);
  }
  for (const std::string& note : comparison.notes) {
    text += "\n% Not run: " + EscapeLatex(note);
  }
  return text;
}

}  // namespace alidade
