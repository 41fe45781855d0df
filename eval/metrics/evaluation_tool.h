#pragma once

#include <optional>
#include <string_view>

namespace alidade {

/// Whose rule makes pairs of rows (eval/metrics/tool_association.h), or whose definition the relative pose
/// error has (eval/metrics/tool_rpe.h): ours, or that of evo or rpg_trajectory_evaluation.
enum class EvaluationTool { kAlidade, kEvo, kRpg };
[[nodiscard]] std::optional<EvaluationTool> ParseEvaluationTool(std::string_view name);  // alidade|evo|rpg
[[nodiscard]] std::string_view ToString(EvaluationTool tool);
/// The largest stamp difference of a pair [s] where none is given: 0.01, of rpg 0.02.
[[nodiscard]] double DefaultMaxDt(EvaluationTool tool);

}  // namespace alidade
