#include "eval/metrics/evaluation_tool.h"

namespace alidade {

std::optional<EvaluationTool> ParseEvaluationTool(std::string_view name) {
  for (const EvaluationTool tool : {EvaluationTool::kAlidade, EvaluationTool::kEvo, EvaluationTool::kRpg}) {
    if (name == ToString(tool)) {
      return tool;
    }
  }
  return std::nullopt;
}

std::string_view ToString(EvaluationTool tool) {
  switch (tool) {
    case EvaluationTool::kAlidade:
      return "alidade";
    case EvaluationTool::kEvo:
      return "evo";
    case EvaluationTool::kRpg:
      return "rpg";
  }
  return "alidade";
}

double DefaultMaxDt(EvaluationTool tool) {
  return tool == EvaluationTool::kRpg ? 0.02 : 0.01;
}

}  // namespace alidade
