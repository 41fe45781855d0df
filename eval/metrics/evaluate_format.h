#pragma once

#include <string>

#include "eval/metrics/evaluate.h"

namespace alidade {

/// Text of a few lines, six significant digits.
[[nodiscard]] std::string FormatEvaluationText(const Evaluation& evaluation);

/// One JSON object with keys in a fixed order and numbers rounded to nine significant digits (the same text
/// on every machine); NaN becomes null.
[[nodiscard]] std::string FormatEvaluationJson(const Evaluation& evaluation);

}  // namespace alidade
