#pragma once

namespace alidade {

/// Keeps every BLAS call of this process on one thread from now on, so that results do not depend on the
/// machine's cores and runs side by side do not fight for them. Whoever calls BLAS calls this first. Safe
/// from any thread, at no cost after the first time.
void UseOneThreadPerBlasCall();

/// False when two threads must not be in BLAS at once: an OpenBLAS built without threads (Debian's
/// libopenblas0-serial) hands the same work space to both and silently returns wrong numbers.
[[nodiscard]] bool BlasIsThreadSafe();

}  // namespace alidade
