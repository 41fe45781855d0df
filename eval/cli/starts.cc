#include <algorithm>
#include <cstdio>

#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/compare/compare_input.h"
#include "eval/compare/plan_parser.h"
#include "eval/config/config_yaml.h"
#include "eval/files/output_file.h"
#include "eval/study/start_study.h"

namespace alidade::cli {
namespace {

/// The starts of one sequence of the plan.
Result<std::vector<StartOutcome>> StudySequence(const Plan& plan, const PlanSequence& sequence, int count) {
  std::vector<std::string> settings = plan.settings;
  const PlanEstimator& estimator = plan.estimators.front();
  for (const std::vector<std::string>* more : {&estimator.settings, &sequence.estimator_settings}) {
    settings.insert(settings.end(), more->begin(), more->end());
  }
  const Result<EstimatorConfig> config = LoadEstimatorConfig(estimator.config, settings);
  if (!config.ok()) {
    return config.status();
  }
  const unsigned seed = sequence.seeds.front();
  std::unique_ptr<CompareInput> input;
  if (sequence.dataset.path.empty()) {
    const Result<SimulatorConfig> simulation = LoadSimulatorConfig(sequence.config, sequence.settings);
    if (!simulation.ok()) {
      return simulation.status();
    }
    input = std::make_unique<CompareInput>(sequence, *simulation, seed, config->frontend);
  } else {
    input = std::make_unique<CompareInput>(sequence, config->frontend);
  }
  const Result<CompareInput::Data>& data = input->Acquire({});
  if (!data.ok()) {
    return data.status();
  }
  if (!data->truth.has_value()) {
    return Status::Input("sequence " + sequence.name +
                         ": has no ground truth, so its starts cannot be evaluated");
  }
  return StartOften(*config, data->log, *data->truth, sequence.name, count, FLAGS_limit, seed);
}

}  // namespace

int RunStarts(const std::vector<std::string>&) {
  ExitOnInterrupt();
  if (FLAGS_starts < 1 || !(FLAGS_limit > 0)) {
    return Report(Status::Usage("starts: --starts must be at least 1 and --limit positive"));
  }
  const Result<Plan> plan = ReadPlan(FLAGS_plan, FLAGS_data);
  if (!plan.ok()) {
    return Report(plan.status());
  }
  if (plan->estimators.empty() || plan->estimators.front().external()) {
    return Report(
        Status::Config(FLAGS_plan + ": its first estimator gives the keys of the start; expected one"));
  }
  std::vector<StartOutcome> outcomes;
  const int sequences = static_cast<int>(plan->sequences.size());
  for (int i = 0; i < sequences; ++i) {
    // Spread evenly; the first sequences take what is left over.
    const int count = FLAGS_starts / sequences + (i < FLAGS_starts % sequences ? 1 : 0);
    const Result<std::vector<StartOutcome>> found =
        StudySequence(*plan, plan->sequences[static_cast<size_t>(i)], count);
    if (!found.ok()) {
      return Report(found.status());
    }
    outcomes.insert(outcomes.end(), found->begin(), found->end());
    PrintNote(plan->sequences[static_cast<size_t>(i)].name + ": " + std::to_string(found->size()) +
              " starts");
  }
  std::fputs(StartTable(outcomes).c_str(), stdout);
  return FLAGS_output.empty() ? kExitDone : Report(WriteLoneFileAtomically(FLAGS_output, StartCsv(outcomes)));
}

}  // namespace alidade::cli
