#pragma once

#include <string>

#include "tests/integration/command.h"

namespace alidade::test {

/// Path below the tree into which the test package_install has installed everything.
inline std::string Installed(const std::string& path) {
  return std::string(ALIDADE_PREFIX) + "/" + path;
}

/// Runs a command of the shell in another folder.
inline CommandResult ShellIn(const std::string& folder, const std::string& command) {
  return Shell("cd '" + folder + "' && { " + command + "; }");
}

/// One short run from end to end by the program at `program`, with shipped configurations by their names.
inline std::string SimulateAndRun(const std::string& program) {
  return program + " simulate --quiet --config=figure8_short --set=duration_s=6,path_m=7.8 --output=seq && " +
         program + " run --quiet --dataset=seq --config=alidade_filter --set=init.method=truth --output=out";
}

}  // namespace alidade::test
