#include "core/error_convention_config.h"

namespace alidade {

void DescribeErrorConvention(ConfigVisitor& visitor, std::string_view what, ErrorConvention* convention) {
  visitor.Enumeration({"error", "-", what}, convention,
                      {{"right_invariant", ErrorConvention::kRightInvariant},
                       {"left_invariant", ErrorConvention::kLeftInvariant},
                       {"so3xrn", ErrorConvention::kSo3xRn}});
}

}  // namespace alidade
