#pragma once

#include "core/config_schema.h"
#include "core/error_convention.h"

namespace alidade {

/// The key `error` of a back end's section; `what` is its description.
void DescribeErrorConvention(ConfigVisitor& visitor, std::string_view what, ErrorConvention* convention);

}  // namespace alidade
