#include "eval/table_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace alidade {
namespace {

const char* const kDash = "\u2013";

std::string Print(const char* format, int precision, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, precision, value);
  return buffer;
}

std::string Heading(const Figure& figure) {
  return figure.unit.empty() ? figure.label : figure.label + " [" + figure.unit + "]";
}

std::string RunsText(const AggregateRow& row) {
  return std::to_string(row.ok) + "/" + std::to_string(row.cells);
}

/// Why a row has no figures: the most frequent reason.
std::string FailureText(const AggregateRow& row) {
  const int most = std::max({row.diverged, row.not_initialized, row.failed});
  return most == row.diverged ? "diverged" : most == row.not_initialized ? "not initialized" : "failed";
}

std::string ReferenceName(const ReferenceFigure& reference) {
  return reference.source.empty() ? reference.estimator : reference.estimator + ", " + reference.source;
}

double ReferenceValue(const ReferenceFigure& reference, const std::string& key) {
  const auto found = reference.figures.find(key);
  return found == reference.figures.end() ? std::nan("") : found->second;
}

TextTable SequenceTable(const std::string& sequence, const std::vector<AggregateRow>& rows,
                        const Comparison& comparison, const std::vector<Figure>& figures,
                        const std::string& plus_minus) {
  TextTable table{sequence, {"estimator", "runs ok"}, {}};
  for (const Figure& figure : figures) {
    table.header.push_back(Heading(figure));
  }
  for (const AggregateRow& row : rows) {
    if (row.sequence != sequence) {
      continue;
    }
    TextRow text{{{row.label}, {RunsText(row)}}};
    for (size_t i = 0; i < figures.size(); ++i) {
      text.cells.push_back({FormatStatistic(row.figures[i], figures[i].decimals, plus_minus), row.best[i]});
    }
    if (row.ok == 0 && text.cells.size() > 2) {
      text.cells[2].text = FailureText(row);
    }
    table.rows.push_back(text);
  }
  for (const ReferenceFigure& reference : comparison.references) {
    if (reference.sequence != sequence) {
      continue;
    }
    TextRow text{{{ReferenceName(reference)}, {kDash}}, true};
    for (const Figure& figure : figures) {
      text.cells.push_back({FormatValue(ReferenceValue(reference, figure.key), figure.decimals)});
    }
    table.rows.push_back(text);
  }
  return table;
}

/// One row a source and estimator of the references that have the figure.
void AppendReferenceRows(const std::vector<std::string>& sequences, const Comparison& comparison,
                         const Figure& figure, TextTable* table) {
  std::vector<std::string> done;
  for (const ReferenceFigure& first : comparison.references) {
    const std::string name = ReferenceName(first);
    if (std::find(done.begin(), done.end(), name) != done.end()) {
      continue;
    }
    done.push_back(name);
    TextRow text{{{name}}, true};
    bool any = false;
    for (const std::string& sequence : sequences) {
      double value = std::nan("");
      for (const ReferenceFigure& reference : comparison.references) {
        if (ReferenceName(reference) == name && reference.sequence == sequence) {
          value = ReferenceValue(reference, figure.key);
        }
      }
      any = any || !std::isnan(value);
      text.cells.push_back({FormatValue(value, figure.decimals)});
    }
    if (any) {
      table->rows.push_back(text);
    }
  }
}

TextTable OverviewTable(size_t index, const std::vector<AggregateRow>& rows, const Comparison& comparison,
                        const std::vector<Figure>& figures, const std::string& plus_minus) {
  const Figure& figure = figures[index];
  const std::vector<std::string> sequences = ListSequences(rows);
  TextTable table{"Overview: " + Heading(figure), {"estimator"}, {}};
  table.header.insert(table.header.end(), sequences.begin(), sequences.end());
  for (const std::string& label : ListLabels(rows)) {
    TextRow text{{{label}}};
    for (const std::string& sequence : sequences) {
      TextCell cell{kDash};
      for (const AggregateRow& row : rows) {
        if (row.label == label && row.sequence == sequence) {
          cell.text = row.ok == 0 ? FailureText(row)
                                  : FormatStatistic(row.figures[index], figure.decimals, plus_minus);
          cell.text += row.ok > 0 && row.ok < row.cells ? " (" + RunsText(row) + ")" : "";
          cell.best = row.best[index];
        }
      }
      text.cells.push_back(cell);
    }
    table.rows.push_back(text);
  }
  AppendReferenceRows(sequences, comparison, figure, &table);
  return table;
}

}  // namespace

std::string FormatValue(double value, int decimals) {
  if (std::isnan(value)) {
    return kDash;
  }
  const double magnitude = std::abs(value);
  if (magnitude >= 1e6 || (magnitude > 0 && magnitude < std::pow(10.0, 1 - decimals))) {
    return Print("%.*g", 2, value);
  }
  return Print("%.*f", decimals, value);
}

std::string FormatStatistic(const Statistic& statistic, int decimals, const std::string& plus_minus) {
  const std::string mean = FormatValue(statistic.mean, decimals);
  if (std::isnan(statistic.standard_error)) {
    return mean;
  }
  // The error shows the digits that the mean shows, unless the mean itself needs more.
  const double magnitude = std::abs(statistic.mean);
  const bool fixed = magnitude < 1e6 && magnitude >= std::pow(10.0, 1 - decimals);
  return mean + plus_minus +
         (fixed ? Print("%.*f", decimals, statistic.standard_error)
                : FormatValue(statistic.standard_error, decimals));
}

std::vector<TextTable> LayOutTables(const Comparison& comparison, const std::string& plus_minus) {
  const std::vector<Figure> figures = ListFigures(comparison);
  const std::vector<AggregateRow> rows = Aggregate(comparison, figures);
  const std::vector<std::string> sequences = ListSequences(rows);
  std::vector<TextTable> tables;
  for (size_t i = 0; i < figures.size() && sequences.size() > 1; ++i) {
    if (figures[i].key == "ate_pos_m" || figures[i].key == "ate_ori_deg") {
      tables.push_back(OverviewTable(i, rows, comparison, figures, plus_minus));
    }
  }
  for (const std::string& sequence : sequences) {
    tables.push_back(SequenceTable(sequence, rows, comparison, figures, plus_minus));
  }
  return tables;
}

}  // namespace alidade
