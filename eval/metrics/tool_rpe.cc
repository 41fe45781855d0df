#include "eval/metrics/tool_rpe.h"

namespace alidade {

std::optional<RpeUnit> ParseRpeUnit(std::string_view name) {
  for (const RpeUnit unit : {RpeUnit::kFrames, RpeUnit::kMetres, RpeUnit::kDegrees, RpeUnit::kRadians}) {
    if (name == ToString(unit)) {
      return unit;
    }
  }
  return std::nullopt;
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
