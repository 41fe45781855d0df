#include "eval/report/table_layout.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <tuple>

#include "core/format.h"
#include "eval/report/efficiency_tables.h"
#include "eval/report/heat_map.h"
#include "eval/report/label_marks.h"
#include "eval/report/pair_tables.h"

namespace alidade {
namespace {

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

/// Rows of a sequence whose difference to its best is not significant, by figure.
class Ties {
 public:
  Ties(const Comparison& comparison, const std::vector<Figure>& figures,
       const std::vector<AggregateRow>& rows) {
    std::set<std::tuple<std::string, std::string, size_t>> best;
    for (const AggregateRow& row : rows) {
      for (size_t i = 0; i < figures.size(); ++i) {
        if (row.best[i]) {
          best.emplace(row.sequence, row.label, i);
        }
      }
    }
    for (const PairedDifference& pair : ComparePairs(comparison, figures)) {
      if (pair.verdict == PairVerdict::kNoDifference) {
        const bool first = best.count({pair.sequence, pair.first, pair.figure}) > 0;
        const bool second = best.count({pair.sequence, pair.second, pair.figure}) > 0;
        if (first != second) {
          ties_.emplace(pair.sequence, first ? pair.second : pair.first, pair.figure);
        }
      }
    }
  }
  /// What stands behind the value.
  [[nodiscard]] std::string MarkOf(const AggregateRow& row, size_t figure) const {
    return ties_.count({row.sequence, row.label, figure}) > 0 ? " \u2248" : "";
  }

 private:
  std::set<std::tuple<std::string, std::string, size_t>> ties_;
};

std::string ReferenceName(const ReferenceFigure& reference) {
  return reference.source.empty() ? reference.estimator : reference.estimator + ", " + reference.source;
}

double ReferenceValue(const ReferenceFigure& reference, const std::string& key) {
  const auto found = reference.figures.find(key);
  return found == reference.figures.end() ? std::nan("") : found->second;
}

std::string Percent(double share) {
  return std::isnan(share) ? kDash : Format("%.1f %%", 100 * share);
}

/// The columns after the figures, in the order of SummaryHeadings.
std::vector<TextCell> SummaryCells(const AggregateRow& row, const std::vector<Figure>& figures,
                                   const Comparison& comparison) {
  const std::optional<size_t> nees = FindFigure(figures, "nees_pose");
  std::vector<TextCell> cells = {{nees ? FormatValue(row.figures[*nees].largest, 1) : kDash},
                                 {Percent(row.nees_inside_share)},
                                 {row.nees_verdict.empty() ? kDash : row.nees_verdict}};
  if (!comparison.baseline.empty()) {
    cells.push_back({FormatValue(row.rmse_pos_ratio, 2)});
    cells.push_back({FormatValue(row.rmse_ori_ratio, 2)});
  }
  return cells;
}

std::vector<std::string> SummaryHeadings(const Comparison& comparison) {
  std::vector<std::string> headings = {"NEES worst run", "NEES in band", "NEES verdict"};
  if (!comparison.baseline.empty()) {
    headings.push_back("RMSE pos. / " + comparison.baseline);
    headings.push_back("RMSE ori. / " + comparison.baseline);
  }
  return headings;
}

TextTable SequenceTable(const std::string& sequence, const std::vector<AggregateRow>& rows,
                        const Comparison& comparison, const std::vector<Figure>& figures, const Ties& ties,
                        const std::string& plus_minus) {
  const LabelMarks marks(comparison);
  TextTable table{sequence, {"estimator", "runs ok"}, {}};
  for (const Figure& figure : figures) {
    table.header.push_back(Heading(figure));
  }
  const std::vector<std::string> more = SummaryHeadings(comparison);
  table.header.insert(table.header.end(), more.begin(), more.end());
  for (const AggregateRow& row : rows) {
    if (row.sequence != sequence) {
      continue;
    }
    TextRow text{{{marks.Marked(row.label)}, {RunsText(row)}}};
    for (size_t i = 0; i < figures.size(); ++i) {
      text.cells.push_back(
          {FormatStatistic(row.figures[i], figures[i].decimals, plus_minus) + ties.MarkOf(row, i),
           row.best[i]});
    }
    if (row.ok == 0 && text.cells.size() > 2) {
      text.cells[2].text = FailureText(row);
    }
    const std::vector<TextCell> summary = SummaryCells(row, figures, comparison);
    text.cells.insert(text.cells.end(), summary.begin(), summary.end());
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
    text.cells.resize(table.header.size(), TextCell{kDash});
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
    double sum = 0;
    for (const std::string& sequence : sequences) {
      double value = std::nan("");
      for (const ReferenceFigure& reference : comparison.references) {
        if (ReferenceName(reference) == name && reference.sequence == sequence) {
          value = ReferenceValue(reference, figure.key);
        }
      }
      any = any || !std::isnan(value);
      sum += value;
      text.cells.push_back({FormatValue(value, figure.decimals)});
    }
    text.cells.push_back({FormatValue(sum / static_cast<double>(sequences.size()), figure.decimals)});
    if (any) {
      table->rows.push_back(text);
    }
  }
}

TextTable OverviewTable(size_t index, const std::vector<AggregateRow>& rows, const Comparison& comparison,
                        const std::vector<Figure>& figures, const Ties& ties, const std::string& plus_minus) {
  const Figure& figure = figures[index];
  const std::vector<std::string> sequences = ListSequences(rows);
  const LabelMarks marks(comparison);
  TextTable table{"Overview: " + Heading(figure), {"estimator"}, {}};
  table.header.insert(table.header.end(), sequences.begin(), sequences.end());
  table.header.emplace_back("mean");
  for (const std::string& label : ListLabels(rows)) {
    TextRow text{{{marks.Marked(label)}}};
    double sum = 0;
    for (const std::string& sequence : sequences) {
      TextCell cell{kDash};
      double value = std::nan("");
      for (const AggregateRow& row : rows) {
        if (row.label == label && row.sequence == sequence) {
          cell.text = row.ok == 0 ? FailureText(row)
                                  : FormatStatistic(row.figures[index], figure.decimals, plus_minus);
          cell.text += ties.MarkOf(row, index);
          cell.text += row.ok > 0 && row.ok < row.cells ? " (" + RunsText(row) + ")" : "";
          cell.best = row.best[index];
          value = row.figures[index].mean;
        }
      }
      sum += value;
      text.cells.push_back(cell);
    }
    // Only of an estimator that has every sequence: a mean over the easy ones would flatter it.
    text.cells.push_back({FormatValue(sum / static_cast<double>(sequences.size()), figure.decimals)});
    table.rows.push_back(text);
  }
  AppendReferenceRows(sequences, comparison, figure, &table);
  return table;
}

/// What the front end made of the images, where it ran in this comparison.
TextTable FrontendTable(const std::vector<FrontendSummary>& frontends) {
  TextTable table;
  table.title = "Front end: tracks an image, their length, their end, and time";
  table.header = {"sequence",           "seed",        "images",        "features a frame",
                  "mean life (frames)", "median life", "lost (%)",      "rejected (%)",
                  "thinned (%)",        "ms a frame",  "95 % of frames"};
  for (const FrontendSummary& front : frontends) {
    TextRow row;
    row.cells = {{front.sequence}, {std::to_string(front.seed)}, {std::to_string(front.images)}};
    for (const auto& [value, decimals] :
         {std::pair(front.features_per_frame, 1), std::pair(front.mean_length, 1),
          std::pair(front.median_length, 0), std::pair(100 * front.lost_share, 2),
          std::pair(100 * front.rejected_share, 2), std::pair(100 * front.thinned_share, 2),
          std::pair(front.mean_ms, 2), std::pair(front.p95_ms, 2)}) {
      row.cells.push_back({FormatValue(value, decimals)});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<TextTable> LayOutTables(const Comparison& comparison, const std::string& plus_minus) {
  const std::vector<Figure> figures = ListFigures(comparison);
  const std::vector<AggregateRow> rows = Aggregate(comparison, figures);
  const std::vector<std::string> sequences = ListSequences(rows);
  const Ties ties(comparison, figures, rows);
  std::vector<TextTable> tables;
  for (size_t i = 0; i < figures.size() && sequences.size() > 1; ++i) {
    if (figures[i].key == "ate_pos_m" || figures[i].key == "ate_ori_deg") {
      tables.push_back(OverviewTable(i, rows, comparison, figures, ties, plus_minus));
    }
  }
  for (const HeatMap& map : MakeHeatMaps(rows, figures)) {
    tables.push_back(HeatTable(map));
    for (std::string& heading : tables.back().header) {
      heading = LabelMarks(comparison).Marked(heading);
    }
  }
  for (const std::string& sequence : sequences) {
    tables.push_back(SequenceTable(sequence, rows, comparison, figures, ties, plus_minus));
  }
  if (!comparison.frontends.empty()) {
    tables.push_back(FrontendTable(comparison.frontends));
  }
  const std::vector<TextTable> efficiency = LayOutEfficiencyTables(comparison);
  tables.insert(tables.end(), efficiency.begin(), efficiency.end());
  const std::vector<TextTable> pairs = LayOutPairTables(comparison, figures, plus_minus);
  tables.insert(tables.end(), pairs.begin(), pairs.end());
  return tables;
}

}  // namespace alidade
