#include "eval/files/machine.h"

#include <algorithm>
#include <fstream>
#include <sstream>

namespace alidade {
namespace {

std::string_view TrimmedField(std::string_view text) {
  const size_t first = text.find_first_not_of(" \t\r");
  const size_t last = text.find_last_not_of(" \t\r");
  return first == std::string_view::npos ? std::string_view() : text.substr(first, last - first + 1);
}

}  // namespace

Machine ParseCpuInfo(std::string_view text) {
  Machine machine;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const size_t colon = line.find(':');
    if (colon == std::string_view::npos) {
      continue;
    }
    const std::string_view key = TrimmedField(line.substr(0, colon));
    const std::string_view value = TrimmedField(line.substr(colon + 1));
    machine.cores += key == "processor" ? 1 : 0;
    if (key == "model name" && !value.empty()) {
      machine.cpu = value;
    }
  }
  return machine;
}

Machine ReadMachine(const std::string& path) {
  std::ifstream file(path);  // the kernel's files have no size that could be asked for
  std::ostringstream text;
  text << file.rdbuf();
  return ParseCpuInfo(text.str());
}

std::string ToString(const Machine& machine) {
  const std::string count = std::to_string(machine.cores);
  return machine.cpu +
         (machine.cores > 0 ? " (" + count + " logical core" + (machine.cores > 1 ? "s" : "") + ")" : "");
}

}  // namespace alidade
