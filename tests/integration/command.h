#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>

#include "tests/support/read_file.h"

namespace alidade::test {

struct CommandResult {
  int code = -1;
  std::string output;  ///< standard output and standard error
};

/// Runs a command of the shell.
inline CommandResult Shell(const std::string& command) {
  CommandResult result;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) {
    return result;
  }
  std::array<char, 4096> buffer;
  for (size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    result.output.append(buffer.data(), n);
  }
  const int status = pclose(pipe);
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

/// Runs the built program with these words, as a shell would.
inline CommandResult Alidade(const std::string& words) {
  return Shell(std::string(ALIDADE_BINARY_DIR) + "/alidade " + words);
}

/// Path below the folder -> content, for all files that equal runs must write equally: timing.csv is left
/// out, run.json ends before its times.
inline std::map<std::string, std::string> ComparableFiles(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_regular_file() || name == "timing.csv") {
      continue;
    }
    std::string text = ReadFile(entry.path());
    if (name == "run.json") {
      text = text.substr(0, text.find("\"times\""));
    }
    files[entry.path().lexically_relative(folder).string()] = text;
  }
  return files;
}

/// Path of a file of the repository.
inline std::string Source(const std::string& path) {
  return std::string(ALIDADE_SOURCE_DIR) + "/" + path;
}

}  // namespace alidade::test
