#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace alidade {

/// Number of insertions, deletions, replacements and swaps of neighbours that turn a into b.
[[nodiscard]] int EditDistance(std::string_view a, std::string_view b);

/// The candidate nearest to the misspelt `name`, or empty when none is near.
[[nodiscard]] std::string NearestName(std::string_view name, const std::vector<std::string>& candidates);

/// "; did you mean 'X'?" or empty: to be appended to a message.
[[nodiscard]] std::string Suggestion(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace alidade
