#pragma once

#include <string>
#include <vector>

namespace alidade::cli {

/// Splits at every comma; no empty words.
[[nodiscard]] std::vector<std::string> SplitWords(const std::string& text);

}  // namespace alidade::cli
