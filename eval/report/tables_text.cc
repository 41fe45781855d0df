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
    "Means over the runs that ended ok, with the standard error of the mean where there are several. "
    "Completed: share of the camera's time with an estimate, over all runs. x real time: seconds of camera "
    "data per second of front end and back end, of the back end alone where the tracks were read from a "
    "file. RMSE is unaligned. ATE: error after alignment to the truth, which summary.csv names (posyaw: in "
    "position and yaw about gravity). RPE: error of the relative motion over stretches of that length of the "
    "path. NEES: squared error in units of the covariance that the estimator reports. The best value of a "
    "column is bold (NEES: nearest to its degrees of freedom, 6, 3 and 3), among the estimators with the "
    "most runs ok; \u2248 marks values "
    "whose paired difference to it is not significant. Published figures are in italics. NEES in band: share "
    "of the instants at which the NEES averaged over the runs is in its 95 % chi-square band; the verdict "
    "compares the mean NEES with the band of that many independent runs. Pairs: differences on equal input "
    "and seed, with half of their 95 % interval (Student's t); significant when the interval excludes zero, "
    "bold when significantly better. p: of the pair alone; Holm: corrected for the number of pairs of the "
    "table. pairs.csv has all pairs. Efficiency: bound divided by achieved RMSE on the runs that both "
    "finished; hindsight is the batch "
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

std::string SmoothedRemark(const Comparison& comparison) {
  std::string names;
  for (const std::string& name : comparison.SmoothedEstimators()) {
    names += (names.empty() ? "" : ", ") + name;
  }
  return names.empty() ? ""
                       : "Smoothed: uses later data (" + names +
                             "), which the others do not have: a causal estimator's row uses data until its "
                             "stamp. A smoothed estimator is never marked as best.";
}

std::string ProvenanceText(const Provenance& provenance) {
  return provenance.version.empty() ? ""
                                    : "Alidade " + provenance.version + ", " + provenance.date +
                                          " (UTC), on " + ToString(provenance.machine);
}

std::string MarkdownText(const Comparison& comparison, const std::vector<TextTable>& tables) {
  std::string text = "# ";
  text += EscapeMarkdown(comparison.title) + "\n\n" + kReading + "\n";
  for (const std::string& remark : {TruthCovarianceRemark(comparison), SmoothedRemark(comparison)}) {
    text += remark.empty() ? "" : "\n" + EscapeMarkdown(remark) + "\n";
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
  const std::string made = ProvenanceText(comparison.provenance);
  text += made.empty() ? "" : "\nMade with " + EscapeMarkdown(made) + ".\n";
  return comparison.command.empty() ? text : text + "\nRepeat with:\n\n    " + comparison.command + "\n";
}

std::string LatexText(const Comparison& comparison, const std::vector<TextTable>& tables) {
  std::string text =
      "% Needs \\usepackage{booktabs}.\n% " + EscapeLatex(comparison.title) + "\n% " + kReading + "\n";
  for (const std::string& remark : {TruthCovarianceRemark(comparison), SmoothedRemark(comparison),
                                    ProvenanceText(comparison.provenance)}) {
    text += remark.empty() ? "" : "% " + EscapeLatex(remark) + "\n";
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
