#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/status.h"
#include "eval/cli/shipped_configs.h"

namespace alidade::cli {

/// One word of the command line and what it does.
struct Command {
  std::string name;
  std::string summary;
  std::string example;                ///< a line that does something useful, after "alidade "
  std::vector<std::string> flags;     ///< names in eval/cli/flags.h that it takes
  std::vector<std::string> required;  ///< of them, those that must be given
  size_t max_arguments = 0;           ///< words that are no flags
  int (*run)(const std::vector<std::string>& arguments) = nullptr;
  ConfigKind config = ConfigKind::kEstimator;  ///< what --config is
  std::map<std::string, std::string> texts{};  ///< of flags that mean something else here, by name
};

/// All commands, in the order of the help text (eval/cli/commands.cc).
[[nodiscard]] const std::vector<Command>& Commands();

}  // namespace alidade::cli
