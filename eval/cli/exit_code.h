#pragma once

#include <string>
#include <vector>

namespace alidade::cli {

// Exit codes, fixed by the contract.
inline constexpr int kExitDone = 0;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitConfig = 3;
inline constexpr int kExitInput = 4;
inline constexpr int kExitDiverged = 5;
inline constexpr int kExitOutput = 6;
inline constexpr int kExitCellsFailed = 7;
inline constexpr int kExitImpaired = 8;
inline constexpr int kExitInterrupted = 130;

struct ExitCode {
  int code = 0;
  std::string meaning;
};
/// The codes above, as the help names them.
[[nodiscard]] const std::vector<ExitCode>& ExitCodes();

}  // namespace alidade::cli
