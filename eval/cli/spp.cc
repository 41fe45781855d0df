#include <filesystem>
#include <functional>

#include "core/format.h"
#include "eval/cli/commands.h"
#include "eval/cli/flags.h"
#include "eval/cli/split_words.h"
#include "eval/cli/support.h"
#include "eval/config/config_yaml.h"
#include "eval/files/output_file.h"
#include "gnss/formats/rinex_observation.h"
#include "gnss/orbits/gnss_files.h"
#include "gnss/positioning/position_file.h"
#include "gnss/positioning/single_point.h"
#include "gnss/positioning/single_point_options.h"
#include "gnss/positioning/single_point_solution.h"

namespace alidade::cli {
namespace {

struct SppConfig {
  GnssCorrectionOptions corrections;
  SinglePointOptions solution;
};

Result<SppConfig> ConfigFromFlags() {
  SppConfig config;
  const std::function<void(ConfigVisitor&)> describe = [&config](ConfigVisitor& visitor) {
    config.corrections.Describe(visitor);
    config.solution.Describe(visitor);
  };
  if (!FLAGS_config.empty()) {
    ALIDADE_RETURN_IF_ERROR(ReadConfigFile(FLAGS_config, describe));
  }
  ALIDADE_RETURN_IF_ERROR(ApplySettings(SplitSettings(FLAGS_set), describe));
  ALIDADE_RETURN_IF_ERROR(config.corrections.Validate());
  return config;
}

void PrintWarnings(const ReaderWarnings& warnings) {
  for (const std::string& text : warnings.first) {
    PrintNote("skipped: " + text);
  }
  if (const auto more = warnings.count - static_cast<std::int64_t>(warnings.first.size()); more > 0) {
    PrintNote(Format("and %lld more", static_cast<long long>(more)));
  }
}

/// Reads the observations again, epoch by epoch, and appends the lines of the solutions to `text`.
Status SolveAll(std::size_t epochs, SinglePointSolver* solver, std::string* text) {
  std::size_t done = 0, solved = 0, read = 0;
  std::string first_failure;
  ProgressLine progress("epoch");
  const auto solve = [&](const ObservationEpoch& epoch) {
    const Result<SinglePointSolution> solution = solver->Solve(epoch);
    if (solution.ok()) {
      ++solved;
      AppendPosition(*solution, text);
    } else if (first_failure.empty()) {
      first_failure = solution.message();
    }
    progress.Update(++done, epochs);
  };
  ALIDADE_RETURN_IF_ERROR(ScanRinexObservation(FLAGS_obs, solve, &read).status());
  if (solved == 0) {
    return Status::Input(FLAGS_obs + ": no epoch has a solution; the first one: " + first_failure);
  }
  PrintNote(FLAGS_output + Format(": %zu of %zu epochs solved", solved, epochs) +
            (first_failure.empty() ? "" : "; first failure: " + first_failure));
  return Status::Ok();
}

int Run() {
  const Result<SppConfig> config = ConfigFromFlags();
  if (!config.ok()) {
    return Report(config.status());
  }
  // Twice through the file, which may be longer than memory: the receiver's data in its event records hold
  // for all epochs.
  std::size_t epochs = 0;
  const Result<ObservationFile> observations = ScanRinexObservation(FLAGS_obs, nullptr, &epochs);
  if (!observations.ok()) {
    return Report(observations.status());
  }
  ReaderWarnings warnings = observations->warnings;
  const auto catalog =
      LoadSatelliteCatalog({SplitWords(FLAGS_nav), SplitWords(FLAGS_sp3), SplitWords(FLAGS_clk)}, &warnings);
  if (!catalog.ok()) {
    return Report(catalog.status());
  }
  PrintWarnings(warnings);
  SinglePointSolver solver(MeasurementBuilder(*catalog, config->corrections, observations->glonass_channels),
                           config->solution, observations->approximate_position_E);
  std::vector<std::string> remarks = {std::string("program   : alidade ") + ALIDADE_VERSION};
  for (const std::string& list : {FLAGS_obs, FLAGS_nav, FLAGS_sp3, FLAGS_clk}) {
    for (const std::string& path : SplitWords(list)) {
      remarks.push_back("inp file  : " + std::filesystem::path(path).filename().string());
    }
  }
  std::string text = PositionFileHeader(remarks);
  if (const Status status = SolveAll(epochs, &solver, &text); !status.ok()) {
    return Report(status);
  }
  return Report(WriteLoneFileAtomically(FLAGS_output, text));
}

}  // namespace

int RunSpp(const std::vector<std::string>&) {
  if (const Status status = CheckOutputFile(FLAGS_output); !status.ok()) {
    return Report(status);
  }
  return Run();
}

}  // namespace alidade::cli
