#include <glog/logging.h>

#include <cstdio>
#include <exception>

#include "eval/cli/command_line.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"

namespace alidade::cli {
namespace {

/// Where a flag names a shipped configuration, it names its file from here on.
Status LocateConfigs(const Command& command) {
  const std::vector<std::pair<std::string*, ConfigKind>> flags = {{&FLAGS_config, command.config},
                                                                  {&FLAGS_estimator, ConfigKind::kEstimator},
                                                                  {&FLAGS_plan, ConfigKind::kPlan}};
  for (const auto& [flag, kind] : flags) {
    const Result<std::string> file = LocateConfig(kind, *flag);
    ALIDADE_RETURN_IF_ERROR(file.status());
    *flag = *file;
  }
  return Status::Ok();
}

int Main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && (words[0] == "--version" || words[0] == "version")) {
    std::printf("alidade %s\n", ALIDADE_VERSION);
    return kExitDone;
  }
  const Result<Parsed> parsed = ParseCommandLine(words);
  if (!parsed.ok()) {
    return Report(parsed.status());
  }
  if (parsed->help) {
    std::fputs((parsed->command == nullptr ? GeneralHelp() : CommandHelp(*parsed->command)).c_str(), stdout);
    return kExitDone;
  }
  if (const Status status = LocateConfigs(*parsed->command); !status.ok()) {
    return Report(status);
  }
  const int code = parsed->command->run(parsed->arguments);
  // A full disk or a closed pipe shows itself only when the buffer is written.
  if (code == kExitDone && (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)) {
    return Report(Status::Output("standard output: cannot be written"));
  }
  return code;
}

}  // namespace
}  // namespace alidade::cli

int main(int argc, char** argv) {
  FLAGS_logtostderr = true;
  google::InitGoogleLogging(argv[0]);
  try {
    return alidade::cli::Main(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("alidade: out of memory\n", stderr);
    return alidade::cli::kExitInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "alidade: unexpected failure: %s\n", error.what());
    return alidade::cli::kExitInput;
  }
}
