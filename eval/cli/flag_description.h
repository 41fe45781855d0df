#pragma once

#include <string>
#include <vector>

#include "eval/cli/command.h"

namespace alidade::cli {

/// What a person, or a shell, may write behind "--flag=".
enum class FlagValue {
  kSwitch,  ///< nothing
  kText,
  kNumber,
  kWord,    ///< one of FlagDescription::words
  kPath,    ///< a file or a folder
  kConfig,  ///< a configuration of FlagDescription::config: a file, or the name of a shipped one
};

/// One flag of one command, as the help, the manual page and the shell's completion describe it.
struct FlagDescription {
  std::string name;  ///< without the dashes in front
  std::string text;
  std::string type;      ///< bool, int32, uint32, double or string
  std::string fallback;  ///< as the program is built, not as it was called
  bool required = false;
  FlagValue value = FlagValue::kText;
  std::vector<std::string> words;
  ConfigKind config = ConfigKind::kEstimator;
};

/// `flag` is one of command.flags. Words are read from the flag's text, which starts with "a | b | c: ".
[[nodiscard]] FlagDescription DescribeFlag(const Command& command, const std::string& flag);

}  // namespace alidade::cli
