#include "eval/report/label_marks.h"

#include <vector>

#include "eval/comparison/cell_group.h"

namespace alidade {

LabelMarks::LabelMarks(const Comparison& comparison) {
  const std::vector<std::string> labels = LabelsOf(comparison);
  for (size_t i = 0; i < labels.size(); ++i) {
    if (comparison.cells[i].smoothed) {
      smoothed_.insert(labels[i]);
    }
  }
}

std::string LabelMarks::Marked(const std::string& label) const {
  return smoothed_.count(label) > 0 ? label + " (smoothed)" : label;
}

}  // namespace alidade
