#pragma once

#include <string>

#include "eval/truth/refine_dataset.h"

namespace alidade {

/// What a refinement found, as a few lines and as one JSON object with keys in a fixed order.
[[nodiscard]] std::string FormatRefinementText(const RefinedTruth& refined);
[[nodiscard]] std::string FormatRefinementJson(const RefinedTruth& refined, const Dataset& dataset,
                                               const RefineOptions& options);

}  // namespace alidade
