#pragma once

#include <string>

namespace alidade {

/// A word for /bin/sh that means `text`, whatever it holds.
[[nodiscard]] inline std::string ShellQuoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return quoted + "'";
}

}  // namespace alidade
