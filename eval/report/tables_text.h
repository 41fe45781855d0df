#pragma once

#include <string>
#include <vector>

#include "eval/comparison/comparison.h"
#include "eval/report/text_table.h"

namespace alidade {

/// A line for every run that did not end ok, with the reason.
[[nodiscard]] std::vector<std::string> LostRuns(const Comparison& comparison);

/// A sentence on the sequences whose NEES include the covariance of the truth; empty when there are none.
[[nodiscard]] std::string TruthCovarianceRemark(const Comparison& comparison);

/// A sentence on the estimators that are smoothed; empty when there are none.
[[nodiscard]] std::string SmoothedRemark(const Comparison& comparison);

/// "Alidade 0.1.0, 2026-11-25 (UTC), on <CPU> (4 logical cores)"; empty when it is not recorded.
[[nodiscard]] std::string ProvenanceText(const Provenance& provenance);

/// tables.md: GitHub tables; the best of a column in bold, published figures in italics. Names are escaped.
[[nodiscard]] std::string MarkdownText(const Comparison& comparison, const std::vector<TextTable>& tables);

/// tables.tex: the same as booktabs tables, to be input into a paper.
[[nodiscard]] std::string LatexText(const Comparison& comparison, const std::vector<TextTable>& tables);

}  // namespace alidade
