#include "eval/metrics/tool_rpe.h"

namespace alidade {
namespace {

template <typename Choice>
std::optional<Choice> Parse(std::string_view name, std::initializer_list<Choice> choices) {
  for (const Choice choice : choices) {
    if (name == ToString(choice)) {
      return choice;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<RpeMethod> ParseRpeMethod(std::string_view name) {
  return Parse(name, {RpeMethod::kAlidade, RpeMethod::kEvo, RpeMethod::kRpg});
}

std::string_view ToString(RpeMethod method) {
  switch (method) {
    case RpeMethod::kAlidade:
      return "alidade";
    case RpeMethod::kEvo:
      return "evo";
    case RpeMethod::kRpg:
      return "rpg";
  }
  return "alidade";
}

std::optional<RpeUnit> ParseRpeUnit(std::string_view name) {
  return Parse(name, {RpeUnit::kFrames, RpeUnit::kMetres, RpeUnit::kDegrees, RpeUnit::kRadians});
}

std::string_view ToString(RpeUnit unit) {
  switch (unit) {
    case RpeUnit::kFrames:
      return "frames";
    case RpeUnit::kMetres:
      return "m";
    case RpeUnit::kDegrees:
      return "deg";
    case RpeUnit::kRadians:
      return "rad";
  }
  return "frames";
}

}  // namespace alidade
