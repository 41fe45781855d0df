#pragma once

#include <atomic>
#include <map>
#include <string>

#include "core/status.h"

namespace alidade {

/// A command line of a plan, with {placeholders}.
struct ExternalCommand {
  std::string text;                       ///< for /bin/sh
  std::string program;                    ///< path of {program}; may be empty
  std::string result = "trajectory.tum";  ///< result file below {output}
  double timeout_s = 3600;                ///< time limit [s]
};

/// The command with every {placeholder} replaced by its value, quoted for the shell. kConfig: a placeholder
/// that is not in `values`.
Result<std::string> FillCommand(const std::string& text, const std::map<std::string, std::string>& values);

struct ExternalRun {
  double wall_s = 0;
  double cpu_s = 0;  ///< of the command and the processes it waited for
};

/// Runs a filled command in /bin/sh, in its own process group, with standard output and error in `log_path`;
/// terminates the group at the time limit or when `stop` is set. kDiverged: it failed, was terminated or
/// stopped, with the last line of the log; kOutput: it cannot be started.
Result<ExternalRun> RunExternal(const std::string& command, const std::string& log_path, double timeout_s,
                                const std::atomic<bool>* stop);

}  // namespace alidade
