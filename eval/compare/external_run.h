#pragma once

#include <atomic>
#include <map>
#include <string>

#include "core/status.h"

namespace alidade {

/// A command line with {words} in it, as a plan gives it.
struct ExternalCommand {
  std::string text;                       ///< for /bin/sh
  std::string result = "trajectory.tum";  ///< file it leaves below {output}
  double timeout_s = 3600;                ///< then it is ended
};

/// The command with every {word} replaced by its value, quoted for the shell. kConfig: a word in braces that
/// is not among `values`.
Result<std::string> FillCommand(const std::string& text, const std::map<std::string, std::string>& values);

struct ExternalRun {
  double wall_s = 0;
  double cpu_s = 0;  ///< of the command and all it waited for
};

/// Runs a filled command in /bin/sh, in a process group of its own, with standard output and error into
/// `log_path`; ends the group when the time is over or `stop` is set. kDiverged: it failed, was ended or
/// stopped, with the last line of the log; kOutput: it cannot be started.
Result<ExternalRun> RunExternal(const std::string& command, const std::string& log_path, double timeout_s,
                                const std::atomic<bool>* stop);

}  // namespace alidade
