#pragma once

#include <time.h>

namespace alidade {

/// CPU time the calling thread has spent so far [s]; for statistics alone, as Stopwatch.
[[nodiscard]] inline double ThreadCpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace alidade
