#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "eval/cli/shipped_configs.h"

namespace alidade::cli {

// Exit codes, fixed by the contract.
inline constexpr int kExitDone = 0;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitConfig = 3;
inline constexpr int kExitInput = 4;
inline constexpr int kExitDiverged = 5;
inline constexpr int kExitOutput = 6;
inline constexpr int kExitCellsFailed = 7;
inline constexpr int kExitInterrupted = 130;

struct ExitCode {
  int code = 0;
  std::string meaning;
};
/// The codes above, as the help names them.
[[nodiscard]] const std::vector<ExitCode>& ExitCodes();

/// One word of the command line and what it does.
struct Command {
  std::string name;
  std::string summary;
  std::vector<std::string> flags;     ///< names in eval/cli/flags.h that it takes
  std::vector<std::string> required;  ///< of them, those that must be given
  size_t max_arguments = 0;           ///< words that are no flags
  int (*run)(const std::vector<std::string>& arguments) = nullptr;
  ConfigKind config = ConfigKind::kEstimator;  ///< what --config is
};

/// All commands, in the order of the help text.
[[nodiscard]] const std::vector<Command>& Commands();

// One function a command, each in its own file.
int RunSimulate(const std::vector<std::string>& arguments);
int RunTrack(const std::vector<std::string>& arguments);
int RunRun(const std::vector<std::string>& arguments);
int RunEvaluate(const std::vector<std::string>& arguments);
int RunCompare(const std::vector<std::string>& arguments);
int RunProbe(const std::vector<std::string>& arguments);
int RunSpp(const std::vector<std::string>& arguments);
int RunStarts(const std::vector<std::string>& arguments);
int RunGnssStudy(const std::vector<std::string>& arguments);
int RunAnalyze(const std::vector<std::string>& arguments);
int RunCheck(const std::vector<std::string>& arguments);
int RunConvert(const std::vector<std::string>& arguments);
int RunConfig(const std::vector<std::string>& arguments);
int RunManual(const std::vector<std::string>& arguments);
int RunCompletion(const std::vector<std::string>& arguments);

}  // namespace alidade::cli
