#include "eval/study/gnss_study.h"

#include <algorithm>
#include <cstdio>

#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/stored_run.h"
#include "eval/cli/support.h"
#include "eval/compare/compare_input.h"
#include "eval/compare/plan_parser.h"
#include "eval/config/config_yaml.h"
#include "eval/study/gnss_study_tables.h"

namespace alidade::cli {
namespace {

/// Whether an estimator uses raw GNSS or position fixes.
bool IsGlobal(const EstimatorConfig& config) {
  bool global = config.gnss.enabled;
  ForEachSensorEntry([&](auto entry, Sensor) { global = global || entry.Config(config).enabled; });
  return global;
}

/// Scores the runs of one plan, one sequence after the other.
class Study {
 public:
  explicit Study(const Plan& plan) : plan_(plan) {}

  Result<std::vector<GnssStudyRow>> Execute() {
    for (const PlanSequence& sequence : plan_.sequences) {
      ALIDADE_RETURN_IF_ERROR(AddSequence(sequence));
      PrintNote(sequence.name + ": " + std::to_string(sequence.seeds.size()) + " seeds");
    }
    return std::move(rows_);
  }

 private:
  Status AddSequence(const PlanSequence& sequence) {
    if (!sequence.dataset.path.empty()) {
      return Status::Usage("gnss_study: sequence " + sequence.name + " is a dataset, expected a simulation");
    }
    const Result<SimulatorConfig> simulation = LoadSimulatorConfig(sequence.config, sequence.settings);
    ALIDADE_RETURN_IF_ERROR(simulation.status());
    first_row_ = rows_.size();
    for (const PlanEstimator& estimator : plan_.estimators) {
      if (estimator.external() || !estimator.RunsOn(sequence.name)) {
        continue;
      }
      const Result<EstimatorConfig> config = ConfigOf(estimator, sequence);
      ALIDADE_RETURN_IF_ERROR(config.status());
      if (IsGlobal(*config)) {
        GnssStudyRow& row = rows_.emplace_back();
        row.sequence = sequence.name;
        row.estimator = estimator.name;
        single_point_ = config->gnss;
      }
    }
    for (const unsigned seed : sequence.seeds) {
      ALIDADE_RETURN_IF_ERROR(AddSeed(sequence, *simulation, seed));
    }
    return Status::Ok();
  }

  Result<EstimatorConfig> ConfigOf(const PlanEstimator& estimator, const PlanSequence& sequence) const {
    std::vector<std::string> settings = plan_.settings;
    for (const std::vector<std::string>* more : {&estimator.settings, &sequence.estimator_settings}) {
      settings.insert(settings.end(), more->begin(), more->end());
    }
    return LoadEstimatorConfig(estimator.config, settings);
  }

  /// Runs that are not there, as of an interrupted comparison, are left out.
  Status AddSeed(const PlanSequence& sequence, const SimulatorConfig& simulation, unsigned seed) {
    std::vector<std::pair<GnssStudyRow*, RunResult>> runs;
    for (std::size_t i = first_row_; i < rows_.size(); ++i) {
      Result<std::optional<RunResult>> run = StoredRun(rows_[i].estimator, sequence.name, seed);
      ALIDADE_RETURN_IF_ERROR(run.status());
      if (run->has_value()) {
        runs.emplace_back(&rows_[i], *std::move(*run));
      }
    }
    return runs.empty() ? Status::Ok() : ScoreSeed(sequence, simulation, seed, runs);
  }

  Status ScoreSeed(const PlanSequence& sequence, const SimulatorConfig& simulation, unsigned seed,
                   const std::vector<std::pair<GnssStudyRow*, RunResult>>& runs) const {
    CompareInput input(sequence, simulation, seed, FrontendConfig());
    const Result<CompareInput::Data>& data = input.Acquire({});
    ALIDADE_RETURN_IF_ERROR(data.status());
    const Trajectory& truth = *data->truth;
    const TimeNs start_ns = data->log.imu.front().stamp_ns;
    const GnssScenario scenario =
        ScenarioOf(simulation, SecondsBetween(start_ns, data->log.imu.back().stamp_ns));
    const Result<GnssRunFigures> odometry = Odometry(sequence, seed, truth, start_ns, scenario);
    ALIDADE_RETURN_IF_ERROR(odometry.status());
    const double single_point_m = SinglePointRmse(single_point_, data->log, truth);
    for (const auto& [row, run] : runs) {
      row->scenario = scenario;
      row->runs.push_back({seed, ScoreGlobalRun(run, truth, start_ns, scenario), *odometry, single_point_m});
    }
    return Status::Ok();
  }

  /// What an estimator without GNSS and fixes did on the same motion; NaN without one.
  Result<GnssRunFigures> Odometry(const PlanSequence& sequence, unsigned seed, const Trajectory& truth,
                                  TimeNs start_ns, const GnssScenario& scenario) const {
    for (const PlanSequence& other : plan_.sequences) {
      const bool has_seed = std::find(other.seeds.begin(), other.seeds.end(), seed) != other.seeds.end();
      if (!scenario.HasOutage() || !has_seed || MotionOf(other) != MotionOf(sequence)) {
        continue;
      }
      for (const PlanEstimator& estimator : plan_.estimators) {
        if (estimator.external() || !estimator.RunsOn(other.name)) {
          continue;
        }
        const Result<EstimatorConfig> config = ConfigOf(estimator, other);
        ALIDADE_RETURN_IF_ERROR(config.status());
        if (IsGlobal(*config)) {
          continue;
        }
        const Result<std::optional<RunResult>> run = StoredRun(estimator.name, other.name, seed);
        ALIDADE_RETURN_IF_ERROR(run.status());
        if (run->has_value()) {
          return ScoreOdometry(**run, truth, start_ns, scenario);
        }
      }
    }
    return GnssRunFigures{};
  }

  /// What makes the trajectory of a simulation: all of it but the receiver and the position sensor.
  static std::vector<std::string> MotionOf(const PlanSequence& sequence) {
    std::vector<std::string> motion = sequence.settings;
    std::erase_if(motion, [](const std::string& setting) {
      bool of_sensor = setting.starts_with("gnss.");
      ForEachSensorEntry([&](auto entry, Sensor) {
        of_sensor = of_sensor || setting.starts_with(std::string(entry.kKey) + ".");
      });
      return of_sensor;
    });
    motion.push_back(sequence.config);
    return motion;
  }

  const Plan& plan_;
  GnssConfig single_point_;
  std::size_t first_row_ = 0;  ///< of the sequence at hand
  std::vector<GnssStudyRow> rows_;
};

}  // namespace

int RunGnssStudy(const std::vector<std::string>&) {
  const Result<Plan> plan = ReadPlan(FLAGS_plan, FLAGS_data);
  if (!plan.ok()) {
    return Report(plan.status());
  }
  const Result<std::vector<GnssStudyRow>> rows = Study(*plan).Execute();
  if (!rows.ok()) {
    return Report(rows.status());
  }
  std::fputs(GnssStudyTables(*rows).c_str(), stdout);
  return kExitDone;
}

}  // namespace alidade::cli
