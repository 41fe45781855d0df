#pragma once

#include <string>
#include <string_view>

namespace alidade {

/// The computer that times were measured on.
struct Machine {
  std::string cpu = "unknown";  ///< model name
  int cores = 0;                ///< logical ones; 0: unknown
};

/// The text of Linux' /proc/cpuinfo. What it does not contain stays unknown: on some processors the model
/// name.
[[nodiscard]] Machine ParseCpuInfo(std::string_view text);

/// Reads that file; one that cannot be read gives nothing.
[[nodiscard]] Machine ReadMachine(const std::string& path = "/proc/cpuinfo");

/// "Intel(R) Xeon(R) CPU (4 logical cores)", for people.
[[nodiscard]] std::string ToString(const Machine& machine);

}  // namespace alidade
