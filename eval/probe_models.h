#pragma once

#include "core/error_convention.h"
#include "eval/probe_json.h"

namespace alidade::probe {

// One function a model: a case in, its answer out; the formats are in docs and in eval/probe.h. Each throws
// CaseError.

Json PoseOnlyAnswer(const Json& input, ErrorConvention convention);
Json InverseDepthAnswer(const Json& input, ErrorConvention convention);
Json ImuPropagationAnswer(const Json& input, ErrorConvention convention);
Json PreintegrationAnswer(const Json& input, ErrorConvention convention);

}  // namespace alidade::probe
