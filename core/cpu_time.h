#pragma once

#include <time.h>

namespace alidade {

[[nodiscard]] inline double SecondsOf(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// CPU time the calling thread has spent so far [s]; for statistics alone, as Stopwatch.
[[nodiscard]] inline double ThreadCpuSeconds() {
  return SecondsOf(CLOCK_THREAD_CPUTIME_ID);
}

/// The same of all threads of this process.
[[nodiscard]] inline double ProcessCpuSeconds() {
  return SecondsOf(CLOCK_PROCESS_CPUTIME_ID);
}

}  // namespace alidade
