#include <algorithm>
#include <cstdio>
#include <map>
#include <sstream>
#include <utility>

#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/stored_run.h"
#include "eval/cli/support.h"
#include "eval/compare/plan_parser.h"
#include "eval/config/config_writer.h"
#include "eval/simulation/simulator.h"
#include "eval/study/fault_recovery.h"
#include "eval/study/fault_study_table.h"

namespace alidade::cli {
namespace {

/// A simulated sequence of the plan.
struct Scene {
  const PlanSequence* sequence = nullptr;
  SimulatorConfig config;
  std::string without_fault;  ///< its configuration but for name and fault

  [[nodiscard]] bool has_fault() const { return config.fault != SimFaultKind::kNone; }
};

/// What really happened.
struct Motion {
  Trajectory truth;
  TimeNs start_ns = 0;
  TimeNs last_ns = 0;
};

std::string TextWithoutFault(SimulatorConfig config) {
  std::istringstream lines(
      ConfigToYaml([&config](ConfigVisitor& visitor) { config.Describe(visitor); }, false));
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    text += line.starts_with("fault") || line.starts_with("name:") ? "" : line + "\n";
  }
  return text;
}

/// Scores the runs of one plan, one sequence after the other.
class FaultStudy {
 public:
  explicit FaultStudy(const Plan& plan) : plan_(plan) {}

  Result<std::vector<FaultStudyRow>> Execute() {
    ALIDADE_RETURN_IF_ERROR(FindScenes());
    for (const Scene& scene : scenes_) {
      if (!scene.has_fault()) {
        continue;
      }
      for (const PlanEstimator& estimator : plan_.estimators) {
        if (!estimator.external() && estimator.RunsOn(scene.sequence->name)) {
          ALIDADE_RETURN_IF_ERROR(AddRow(scene, estimator));
        }
      }
      PrintNote(scene.sequence->name + ": " + std::to_string(scene.sequence->seeds.size()) + " seeds");
    }
    const bool has_runs =
        std::any_of(rows_.begin(), rows_.end(), [](const FaultStudyRow& row) { return !row.runs.empty(); });
    return has_runs ? Result<std::vector<FaultStudyRow>>(std::move(rows_))
                    : Status::Input("fault_study: " + FLAGS_input +
                                    " holds no run of the simulated sequences with a fault of " + plan_.path);
  }

 private:
  Status FindScenes() {
    for (const PlanSequence& sequence : plan_.sequences) {
      if (!sequence.dataset.path.empty()) {
        continue;
      }
      const Result<SimulatorConfig> config = LoadSimulatorConfig(sequence.config, sequence.settings);
      ALIDADE_RETURN_IF_ERROR(config.status());
      scenes_.push_back({&sequence, *config, TextWithoutFault(*config)});
    }
    return Status::Ok();
  }

  /// Runs that are not there, as of an interrupted comparison, are left out.
  Status AddRow(const Scene& scene, const PlanEstimator& estimator) {
    FaultStudyRow row{scene.sequence->name, estimator.name, {}};
    for (const unsigned seed : scene.sequence->seeds) {
      const Result<std::optional<RunResult>> run = StoredRun(estimator.name, scene.sequence->name, seed);
      ALIDADE_RETURN_IF_ERROR(run.status());
      if (!run->has_value()) {
        continue;
      }
      const Result<const Motion*> motion = MotionOf(scene, seed);
      ALIDADE_RETURN_IF_ERROR(motion.status());
      const Result<std::optional<RunResult>> clean = CleanRun(scene, estimator, seed);
      ALIDADE_RETURN_IF_ERROR(clean.status());
      row.runs.push_back(Score(scene, estimator, **motion, **run, *clean));
    }
    rows_.push_back(std::move(row));
    return Status::Ok();
  }

  [[nodiscard]] FaultFigures Score(const Scene& scene, const PlanEstimator& estimator, const Motion& motion,
                                   const RunResult& run, const std::optional<RunResult>& clean) const {
    const EvaluationOptions options = plan_.MetricsOf(estimator, *scene.sequence);
    const FaultTimes times = FaultTimesOf(scene.config, motion.start_ns, motion.last_ns);
    const std::vector<RunInstant> rows = InstantsOf(run, motion.truth, options);
    if (!clean) {
      return ScoreFault(rows, times, nullptr);
    }
    const std::vector<RunInstant> clean_rows = InstantsOf(*clean, motion.truth, options);
    return ScoreFault(rows, times, &clean_rows);
  }

  /// The estimator's first stored run on the same sequence without the fault.
  [[nodiscard]] Result<std::optional<RunResult>> CleanRun(const Scene& scene, const PlanEstimator& estimator,
                                                          unsigned seed) const {
    for (const Scene& other : scenes_) {
      const std::vector<unsigned>& seeds = other.sequence->seeds;
      if (!other.has_fault() && other.without_fault == scene.without_fault &&
          other.sequence->estimator_settings == scene.sequence->estimator_settings &&
          estimator.RunsOn(other.sequence->name) &&
          std::find(seeds.begin(), seeds.end(), seed) != seeds.end()) {
        Result<std::optional<RunResult>> run = StoredRun(estimator.name, other.sequence->name, seed);
        if (!run.ok() || run->has_value()) {
          return run;
        }
      }
    }
    return std::optional<RunResult>();
  }

  /// Simulates it once for all faults.
  Result<const Motion*> MotionOf(const Scene& scene, unsigned seed) {
    const auto [place, is_new] = motions_.try_emplace({scene.without_fault, seed});
    if (is_new) {
      SimulatorConfig config = scene.config;
      config.fault = SimFaultKind::kNone;
      Result<Dataset> dataset = Simulate(config, seed);
      ALIDADE_RETURN_IF_ERROR(dataset.status());
      place->second = {std::move(*dataset->truth), dataset->imu.front().stamp_ns,
                       dataset->imu.back().stamp_ns};
    }
    return &place->second;
  }

  const Plan& plan_;
  std::vector<Scene> scenes_;
  std::map<std::pair<std::string, unsigned>, Motion> motions_;
  std::vector<FaultStudyRow> rows_;
};

}  // namespace

int RunFaultStudy(const std::vector<std::string>&) {
  const Result<Plan> plan = ReadPlan(FLAGS_plan, FLAGS_data);
  if (!plan.ok()) {
    return Report(plan.status());
  }
  const Result<std::vector<FaultStudyRow>> rows = FaultStudy(*plan).Execute();
  if (!rows.ok()) {
    return Report(rows.status());
  }
  std::fputs(FaultStudyTable(*rows).c_str(), stdout);
  return kExitDone;
}

}  // namespace alidade::cli
