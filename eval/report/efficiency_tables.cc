#include "eval/report/efficiency_tables.h"

#include "eval/comparison/efficiency.h"
#include "eval/report/label_marks.h"

namespace alidade {

std::vector<TextTable> LayOutEfficiencyTables(const Comparison& comparison) {
  const LabelMarks marks(comparison);
  std::vector<TextTable> tables;
  for (const Efficiency& entry : ComputeEfficiency(comparison)) {
    const std::string title = kEfficiencyTitle + entry.sequence;
    if (tables.empty() || tables.back().title != title) {
      tables.push_back(
          {title,
           {"bound / achieved", "pairs", "hindsight ori.", "hindsight pos.", "smoothing \u03c3 ori.",
            "smoothing \u03c3 pos.", "filtering \u03c3 ori.", "filtering \u03c3 pos."},
           {}});
    }
    TextRow row{{{marks.Marked(entry.label)}, {std::to_string(entry.pairs)}}};
    for (const Ratio& ratio : {entry.achieved, entry.smoothed, entry.filtered}) {
      row.cells.push_back({FormatValue(ratio.ori, 2)});
      row.cells.push_back({FormatValue(ratio.pos, 2)});
    }
    tables.back().rows.push_back(row);
  }
  return tables;
}

}  // namespace alidade
