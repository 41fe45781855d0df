#include "core/error_convention_config.h"

#include <utility>
#include <vector>

namespace alidade {

void DescribeErrorConvention(ConfigVisitor& visitor, std::string_view what, ErrorConvention* convention) {
  std::vector<std::pair<std::string_view, ErrorConvention>> options;
  options.reserve(kErrorConventions.size());
  for (const ErrorConvention option : kErrorConventions) {
    options.emplace_back(ToString(option), option);
  }
  visitor.Enumeration({"error", "-", what}, convention, options);
}

}  // namespace alidade
