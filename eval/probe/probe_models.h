#pragma once

#include "core/error_convention.h"
#include "eval/probe/probe_json.h"

namespace alidade::probe {

// One function a model: a case in, its answer out; the formats are in docs and in eval/probe/probe.h. Each
// throws CaseError.

Json PoseOnlyAnswer(const Json& input, ErrorConvention convention);
Json InverseDepthAnswer(const Json& input, ErrorConvention convention);
Json ImuPropagationAnswer(const Json& input, ErrorConvention convention);
Json PreintegrationAnswer(const Json& input, ErrorConvention convention);
/// Metres; H is 1x17 over (theta, p, v, bg, ba, clock, drift).
Json PseudorangeAnswer(const Json& input, ErrorConvention convention);
/// `predicted` and H are of -lambda D [m/s], `predicted_hz` is D; omega is the gyroscope's reading, so that
/// the rate is omega - bg.
Json DopplerAnswer(const Json& input, ErrorConvention convention);

}  // namespace alidade::probe
