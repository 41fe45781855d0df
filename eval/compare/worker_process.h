#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/status.h"

namespace alidade {

/// A child process that takes lines on its standard input and answers with lines on its standard output.
/// Standard error is shared.
class WorkerProcess {
 public:
  /// words: the program and its arguments. Error (kOutput): it cannot be started.
  static Result<WorkerProcess> Start(const std::vector<std::string>& words);
  /// Asks it to end, and waits; one that does not end in time is killed, with all that it started.
  ~WorkerProcess();
  WorkerProcess(WorkerProcess&& other) noexcept;
  WorkerProcess& operator=(WorkerProcess&&) = delete;
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  /// Sends a line. Lines to a process that has ended are lost.
  void Send(const std::string& line) const;
  /// Reads what has come; blocks when nothing has. False: the process closed its output.
  bool Read();
  /// The next whole line that was read.
  std::optional<std::string> Line();
  /// Of its output, for poll.
  [[nodiscard]] int descriptor() const { return from_; }

  /// Asks it to end (SIGTERM).
  void Interrupt();
  /// Ends it and all that it started (SIGKILL).
  void Kill() const;
  /// Of the process and all that it started (MemoryOfTree) [bytes].
  [[nodiscard]] int64_t Memory() const;
  /// Closes its input, waits for its end, and returns how it ended: "code 3", "signal 9 (Killed)".
  std::string Join();

 private:
  WorkerProcess(pid_t process, int to, int from) : process_(process), to_(to), from_(from) {}

  pid_t process_ = 0;  ///< 0: joined
  int to_ = -1;        ///< -1: closed
  int from_ = -1;
  std::optional<std::chrono::steady_clock::time_point> interrupted_;
  std::string text_;  ///< read, not yet taken
};

}  // namespace alidade
