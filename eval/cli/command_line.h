#pragma once

#include <string>
#include <vector>

#include "eval/cli/command.h"

namespace alidade::cli {

/// A command line that has been understood: its flags are set, these words are left.
struct Parsed {
  const Command* command = nullptr;
  std::vector<std::string> arguments;
  bool help = false;
};

/// Finds the command and sets its flags. `--flag=value`, `--flag value`, `--switch`, `--noswitch`; '-' and
/// '_' are equal inside names; --set may be repeated. Done here instead of by gflags because a flag belongs
/// to commands and every fault must be kUsage with a suggestion: unknown command or flag, flag of another
/// command, missing or ill-typed value, missing required flag, too many words.
Result<Parsed> ParseCommandLine(const std::vector<std::string>& words);

/// The list of commands.
[[nodiscard]] std::string GeneralHelp();
/// The flags of one command with their defaults.
[[nodiscard]] std::string CommandHelp(const Command& command);

}  // namespace alidade::cli
