#include "eval/report/pair_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/format.h"
#include "eval/files/csv_text.h"
#include "eval/report/label_marks.h"

namespace alidade {
namespace {

const char* const kMinus = "\u2212";

/// The same pair seen from the other side.
PairedDifference Reversed(const PairedDifference& pair) {
  PairedDifference other = pair;
  std::swap(other.first, other.second);
  std::swap(other.first_mean, other.second_mean);
  std::swap(other.first_lower, other.second_lower);
  std::swap(other.only_first, other.only_second);
  other.difference.mean = -pair.difference.mean;
  other.difference.low = -pair.difference.high;
  other.difference.high = -pair.difference.low;
  const std::map<PairVerdict, PairVerdict> opposite = {{PairVerdict::kBetter, PairVerdict::kWorse},
                                                       {PairVerdict::kWorse, PairVerdict::kBetter},
                                                       {PairVerdict::kLower, PairVerdict::kHigher},
                                                       {PairVerdict::kHigher, PairVerdict::kLower}};
  const auto found = opposite.find(pair.verdict);
  other.verdict = found == opposite.end() ? pair.verdict : found->second;
  return other;
}

std::string ShortVerdict(PairVerdict verdict) {
  switch (verdict) {
    case PairVerdict::kTooFew:
      return "?";
    case PairVerdict::kNoDifference:
      return "no difference";
    case PairVerdict::kBetter:
      return "better";
    case PairVerdict::kWorse:
      return "worse";
    case PairVerdict::kLower:
      return "lower";
    case PairVerdict::kHigher:
      return "higher";
  }
  return "";
}

/// "p 0.012", or "p < 0.001".
std::string PValue(const std::string& name, double p) {
  return name + (p < 0.001 ? std::string(" < 0.001") : Format(" %.2g", p));
}

TextCell PairCell(const PairedDifference& pair, int decimals, const std::string& plus_minus) {
  const PairedT& test = pair.difference;
  const std::string half = FormatValue(0.5 * (test.high - test.low), decimals);
  const int lost = pair.only_first + pair.only_second + pair.neither;
  return {(test.mean < 0 ? kMinus : "") + FormatValue(std::abs(test.mean), decimals) + plus_minus + half +
              " " + ShortVerdict(pair.verdict) + " (" + PValue("p", test.p_value) + ", " +
              PValue("Holm", pair.holm_p_value) + ")" +
              (lost > 0 ? " (" + std::to_string(lost) + " lost)" : ""),
          pair.verdict == PairVerdict::kBetter};
}

/// Rows and columns in the order of the comparison.
std::vector<std::string> LabelsOf(const std::vector<const PairedDifference*>& pairs) {
  std::vector<std::string> labels;
  const auto add = [&labels](const std::string& label) {
    if (std::find(labels.begin(), labels.end(), label) == labels.end()) {
      labels.push_back(label);
    }
  };
  for (const PairedDifference* pair : pairs) {
    add(pair->first);
  }
  for (const PairedDifference* pair : pairs) {
    add(pair->second);
  }
  return labels;
}

TextTable Matrix(const std::string& sequence, const Figure& figure,
                 const std::vector<const PairedDifference*>& pairs, const LabelMarks& marks,
                 const std::string& plus_minus) {
  std::map<std::pair<std::string, std::string>, PairedDifference> by_name;
  for (const PairedDifference* pair : pairs) {
    by_name[{pair->first, pair->second}] = *pair;
    by_name[{pair->second, pair->first}] = Reversed(*pair);
  }
  const std::vector<std::string> labels = LabelsOf(pairs);
  TextTable table{kPairTitle + figure.label + (figure.unit.empty() ? "" : " [" + figure.unit + "]") + ", " +
                      sequence + " (row minus column)",
                  {"row is ... than column"},
                  {}};
  for (const std::string& label : labels) {
    table.header.push_back(marks.Marked(label));
  }
  for (const std::string& row : labels) {
    TextRow text{{{marks.Marked(row)}}};
    for (const std::string& column : labels) {
      const auto found = by_name.find({row, column});
      text.cells.push_back(found == by_name.end() ? TextCell{kDash}
                                                  : PairCell(found->second, figure.decimals, plus_minus));
    }
    table.rows.push_back(text);
  }
  return table;
}

}  // namespace

std::vector<TextTable> LayOutPairTables(const Comparison& comparison, const std::vector<Figure>& figures,
                                        const std::string& plus_minus) {
  const std::vector<PairedDifference> all = ComparePairs(comparison, figures);
  std::vector<std::string> sequences;
  for (const PairedDifference& pair : all) {
    const bool wanted = comparison.pair_across == (pair.sequence == kAllSequences);
    if (wanted && std::find(sequences.begin(), sequences.end(), pair.sequence) == sequences.end()) {
      sequences.push_back(pair.sequence);
    }
  }
  const LabelMarks marks(comparison);
  std::vector<TextTable> tables;
  for (const std::string& sequence : sequences) {
    for (const std::string& key : comparison.pair_figures) {
      const std::optional<size_t> figure = FindFigure(figures, key);
      std::vector<const PairedDifference*> pairs;
      for (const PairedDifference& pair : all) {
        if (pair.sequence == sequence && figure == pair.figure && pair.verdict != PairVerdict::kTooFew) {
          pairs.push_back(&pair);
        }
      }
      if (!pairs.empty()) {
        tables.push_back(Matrix(sequence, figures[*figure], pairs, marks, plus_minus));
      }
    }
  }
  return tables;
}

std::string PairsCsv(const Comparison& comparison, const std::vector<Figure>& figures) {
  std::string text =
      "sequence,figure,a,b,pairs,only_a,only_b,neither,a_mean,b_mean,ratio,difference,standard_error,"
      "ci95_low,ci95_high,p_value,a_lower,b_lower,sign_p_value,verdict,holm_p_value\n";
  for (const PairedDifference& pair : ComparePairs(comparison, figures)) {
    const PairedT& test = pair.difference;
    std::vector<std::string> fields = {CsvText(pair.sequence), figures[pair.figure].key, CsvText(pair.first),
                                       CsvText(pair.second)};
    for (const int count : {test.count, pair.only_first, pair.only_second, pair.neither}) {
      fields.push_back(std::to_string(count));
    }
    for (const double value : {pair.first_mean, pair.second_mean, pair.first_mean / pair.second_mean,
                               test.mean, test.standard_error, test.low, test.high, test.p_value}) {
      fields.push_back(CsvNumber(value));
    }
    fields.push_back(std::to_string(pair.first_lower));
    fields.push_back(std::to_string(pair.second_lower));
    fields.push_back(CsvNumber(pair.sign_p_value));
    fields.push_back(ToString(pair.verdict));
    fields.push_back(CsvNumber(pair.holm_p_value));
    text += JoinCsv(fields);
  }
  return text;
}

}  // namespace alidade
