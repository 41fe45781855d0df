#pragma once

namespace alidade {

/// What down-weights large residuals; see RobustWeight in core/robust.h.
enum class RobustKernel { kNone, kHuber, kCauchy, kLogTail };

}  // namespace alidade
