#pragma once

#include <optional>
#include <string_view>

namespace alidade {

/// Whose rule makes pairs of rows: ours, or that of evo or rpg_trajectory_evaluation
/// (eval/metrics/tool_association.h).
enum class AssociationMethod { kAlidade, kEvo, kRpg };
[[nodiscard]] std::optional<AssociationMethod> ParseAssociationMethod(
    std::string_view name);  // alidade|evo|rpg
[[nodiscard]] std::string_view ToString(AssociationMethod method);
/// The largest stamp difference of a pair [s] where none is given: 0.01, of rpg 0.02.
[[nodiscard]] double DefaultMaxDt(AssociationMethod method);

}  // namespace alidade
