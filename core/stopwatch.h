#pragma once

#include <chrono>

namespace alidade {

/// Wall time since its making or its last Restart; times are reported, and no decision depends on them (equal
/// runs give equal bits).
class Stopwatch {
 public:
  [[nodiscard]] double ElapsedS() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }
  [[nodiscard]] double ElapsedMs() const { return 1e3 * ElapsedS(); }
  void Restart() { start_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point start_ = Clock::now();
};

}  // namespace alidade
