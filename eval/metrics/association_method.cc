#include "eval/metrics/association_method.h"

namespace alidade {

std::optional<AssociationMethod> ParseAssociationMethod(std::string_view name) {
  for (const AssociationMethod method :
       {AssociationMethod::kAlidade, AssociationMethod::kEvo, AssociationMethod::kRpg}) {
    if (name == ToString(method)) {
      return method;
    }
  }
  return std::nullopt;
}

std::string_view ToString(AssociationMethod method) {
  switch (method) {
    case AssociationMethod::kAlidade:
      return "alidade";
    case AssociationMethod::kEvo:
      return "evo";
    case AssociationMethod::kRpg:
      return "rpg";
  }
  return "alidade";
}

double DefaultMaxDt(AssociationMethod method) {
  return method == AssociationMethod::kRpg ? 0.02 : 0.01;
}

}  // namespace alidade
