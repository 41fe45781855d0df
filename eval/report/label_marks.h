#pragma once

#include <set>
#include <string>

#include "eval/comparison/comparison.h"

namespace alidade {

/// How tables name estimators: those that use later data than the others have a word behind their label.
class LabelMarks {
 public:
  explicit LabelMarks(const Comparison& comparison);

  /// "batch (smoothed)"; a causal estimator's label as it is.
  [[nodiscard]] std::string Marked(const std::string& label) const;

 private:
  std::set<std::string> smoothed_;
};

}  // namespace alidade
