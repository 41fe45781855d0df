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

void SayWarnings(const ReaderWarnings& warnings) {
  for (const std::string& text : warnings.first) {
    Say("skipped: " + text);
  }
  if (const auto more = warnings.count - static_cast<std::int64_t>(warnings.first.size()); more > 0) {
    Say(Format("and %lld more", static_cast<long long>(more)));
  }
}

Result<std::vector<SinglePointSolution>> SolveAll(const ObservationFile& observations,
                                                  SinglePointSolver* solver) {
  std::vector<SinglePointSolution> solutions;
  std::string first_failure;
  ProgressLine progress("epoch");
  for (std::size_t i = 0; i < observations.epochs.size(); ++i) {
    Result<SinglePointSolution> solution = solver->Solve(observations.epochs[i]);
    if (solution.ok()) {
      solutions.push_back(*std::move(solution));
    } else if (first_failure.empty()) {
      first_failure = solution.message();
    }
    progress.Update(i + 1, observations.epochs.size());
  }
  if (solutions.empty()) {
    return Status::Input(FLAGS_obs + ": no epoch has a solution; the first one: " + first_failure);
  }
  Say(FLAGS_output + Format(": %zu of %zu epochs solved", solutions.size(), observations.epochs.size()) +
      (first_failure.empty() ? "" : "; first failure: " + first_failure));
  return solutions;
}

int Run() {
  const Result<SppConfig> config = ConfigFromFlags();
  if (!config.ok()) {
    return Report(config.status());
  }
  const Result<ObservationFile> observations = ReadRinexObservation(FLAGS_obs);
  if (!observations.ok()) {
    return Report(observations.status());
  }
  ReaderWarnings warnings = observations->warnings;
  const auto catalog =
      LoadSatelliteCatalog({SplitWords(FLAGS_nav), SplitWords(FLAGS_sp3), SplitWords(FLAGS_clk)}, &warnings);
  if (!catalog.ok()) {
    return Report(catalog.status());
  }
  SayWarnings(warnings);
  SinglePointSolver solver(MeasurementBuilder(*catalog, config->corrections, observations->glonass_channels),
                           config->solution, observations->approximate_position_E);
  const Result<std::vector<SinglePointSolution>> solutions = SolveAll(*observations, &solver);
  if (!solutions.ok()) {
    return Report(solutions.status());
  }
  std::vector<std::string> remarks = {std::string("program   : alidade ") + ALIDADE_VERSION};
  for (const std::string& list : {FLAGS_obs, FLAGS_nav, FLAGS_sp3, FLAGS_clk}) {
    for (const std::string& path : SplitWords(list)) {
      remarks.push_back("inp file  : " + std::filesystem::path(path).filename().string());
    }
  }
  return Report(WriteFileAtomically(FLAGS_output, FormatPositionFile(*solutions, remarks)));
}

}  // namespace

int RunSpp(const std::vector<std::string>&) {
  std::error_code ignored;
  if (!FLAGS_overwrite && std::filesystem::exists(FLAGS_output, ignored)) {
    return Report(Status::Output(FLAGS_output + ": exists, expected a new file or --overwrite"));
  }
  return Run();
}

}  // namespace alidade::cli
