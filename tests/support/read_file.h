#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace alidade::test {

/// The file's bytes; empty when it cannot be read.
inline std::string ReadFile(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace alidade::test
