#include "eval/compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <thread>
#include <vector>

#include "core/blas.h"
#include "core/format.h"
#include "eval/cell_score.h"
#include "eval/compare_input.h"
#include "eval/config_json.h"
#include "eval/config_yaml.h"
#include "eval/external_cell.h"
#include "eval/recorder.h"

namespace alidade {
namespace {

/// One estimator on one sequence with one seed.
struct Cell {
  const PlanEstimator* estimator = nullptr;
  const EstimatorConfig* config = nullptr;  ///< null when external
  const PlanSequence* sequence = nullptr;
  CompareInput* input = nullptr;
  unsigned seed = 0;
  CellResult result;
};

std::string OneLine(const CellResult& cell) {
  const std::string figures = std::isfinite(cell.ate_pos_m)
                                  ? Format(", ATE %.3f m %.3f deg, %.2f ms a frame", cell.ate_pos_m,
                                           cell.ate_ori_deg, cell.backend_ms)
                                  : std::string();
  return cell.estimator + " / " + cell.sequence + " / " + std::to_string(cell.seed) + ": " + cell.status +
         figures + (cell.message.empty() ? "" : " (" + cell.message + ")");
}

/// One comparison from a plan to its tables.
class Comparer {
 public:
  Comparer(const Plan& plan, const CompareOptions& options) : plan_(plan), options_(options) {
    pipeline_.stop = options.stop;
  }

  Result<CompareOutcome> Execute() {
    ALIDADE_RETURN_IF_ERROR(LoadConfigs());
    ALIDADE_RETURN_IF_ERROR(MakeCells());
    RunAll();
    return Finish();
  }

 private:
  /// One configuration an estimator and sequence: a sequence may say what holds on it alone, such as its
  /// pixel noise.
  Status LoadConfigs() {
    for (const PlanSequence& sequence : plan_.sequences) {
      for (const PlanEstimator& estimator : plan_.estimators) {
        if (estimator.external()) {
          configs_[&sequence].push_back(nullptr);
          continue;
        }
        std::vector<std::string> settings = plan_.settings;
        for (const std::vector<std::string>* more : {&estimator.settings, &sequence.estimator_settings}) {
          settings.insert(settings.end(), more->begin(), more->end());
        }
        Result<EstimatorConfig> config = LoadEstimatorConfig(estimator.config, settings);
        if (!config.ok()) {
          return Status(config.code(),
                        "estimator " + estimator.name + " on " + sequence.name + ": " + config.message());
        }
        config->name = estimator.name;
        configs_[&sequence].push_back(std::make_unique<EstimatorConfig>(std::move(*config)));
      }
    }
    return Status::Ok();
  }

  /// The front end runs once a sequence: where it runs, all estimators must agree on its settings.
  Result<FrontendConfig> CommonFrontend(const PlanSequence& sequence) const {
    FrontendConfig common;
    nlohmann::ordered_json expected;
    for (const std::unique_ptr<EstimatorConfig>& config : configs_.at(&sequence)) {
      if (config == nullptr) {
        continue;
      }
      FrontendConfig frontend = config->frontend;
      const nlohmann::ordered_json found =
          ConfigToJson([&](ConfigVisitor& visitor) { frontend.Describe(visitor); });
      if (expected.is_null()) {
        expected = found;
        common = frontend;
      } else if (found != expected && !std::filesystem::exists(sequence.dataset + "/mav0/cam0/tracks.csv")) {
        return Status::Config("estimator " + config->name +
                              ": frontend differs from that of the other estimators, but the "
                              "front end runs once for sequence " +
                              sequence.name + "; expected equal settings");
      }
    }
    return common;
  }

  Status MakeCells() {
    for (const PlanSequence& sequence : plan_.sequences) {
      if (sequence.dataset.empty()) {
        ALIDADE_RETURN_IF_ERROR(AddSimulation(sequence));
      } else {
        const Result<FrontendConfig> frontend = CommonFrontend(sequence);
        if (!frontend.ok()) {
          return frontend.status();
        }
        inputs_.push_back(std::make_unique<CompareInput>(sequence, *frontend));
        for (const unsigned seed : sequence.seeds) {
          AddCells(sequence, seed, inputs_.back().get());
        }
      }
    }
    return Status::Ok();
  }

  Status AddSimulation(const PlanSequence& sequence) {
    const Result<SimulatorConfig> config = LoadSimulatorConfig(sequence.config, sequence.settings);
    if (!config.ok()) {
      return Status(config.code(), "sequence " + sequence.name + ": " + config.message());
    }
    for (const unsigned seed : sequence.seeds) {
      inputs_.push_back(std::make_unique<CompareInput>(sequence, *config, seed));
      AddCells(sequence, seed, inputs_.back().get());
    }
    return Status::Ok();
  }

  void AddCells(const PlanSequence& sequence, unsigned seed, CompareInput* input) {
    for (size_t i = 0; i < plan_.estimators.size(); ++i) {
      const PlanEstimator& estimator = plan_.estimators[i];
      if (estimator.external() && estimator.command.text.empty() &&
          estimator.trajectories.count(sequence.name) == 0) {
        continue;
      }
      const EstimatorConfig* config = configs_.at(&sequence)[i].get();
      Cell cell{&estimator, config, &sequence, input, seed, UnscoredCell()};
      cell.result.estimator = estimator.name;
      cell.result.backend = estimator.external() ? "external" : std::string(ToString(config->backend));
      cell.result.sequence = sequence.name;
      cell.result.seed = seed;
      input->AddUser();
      cells_.push_back(std::move(cell));
    }
  }

  void RunAll() {
    int jobs = options_.jobs;
    if (jobs > 1 && !BlasIsThreadSafe()) {
      Say("one job at a time: this OpenBLAS was built without locks; install libopenblas0-pthread");
      jobs = 1;
    }
    std::vector<std::thread> threads;
    for (int i = 1; i < jobs; ++i) {
      threads.emplace_back([this] { Work(); });
    }
    Work();
    for (std::thread& thread : threads) {
      thread.join();
    }
  }

  void Work() {
    for (size_t i = next_cell_++; i < cells_.size() && !Stopped(); i = next_cell_++) {
      Cell& cell = cells_[i];
      RunGuarded(&cell);
      cell.input->Release();
      Say("[" + std::to_string(++cells_done_) + "/" + std::to_string(cells_.size()) + "] " +
          OneLine(cell.result));
    }
  }

  /// Nothing that one cell does may end the others, an exception of a library least of all.
  void RunGuarded(Cell* cell) {
    try {
      RunCell(cell);
    } catch (const std::exception& error) {
      Fail(cell, error.what());
    }
  }

  static void Fail(Cell* cell, const std::string& message) {
    cell->result.status = "failed";
    cell->result.message = message;
  }

  void RunCell(Cell* cell) {
    const Result<CompareInput::Data>& data = cell->input->Acquire(pipeline_);
    if (!data.ok()) {
      return Fail(cell, data.message());
    }
    const Trajectory* truth = data->truth ? &*data->truth : nullptr;
    cell->result.input_digest = DigestOf(data->log);
    if (cell->result.input_digest != data->input_digest) {
      return Fail(cell, "the measurement log changed between two estimators");
    }
    if (cell->config == nullptr) {
      return RunExternalCell(*data, cell);
    }
    const std::string folder = FolderOf(*cell);
    const RunIdentity identity{*cell->config,
                               cell->sequence->name,
                               data->dataset_digest,
                               data->input_digest,
                               cell->seed,
                               data->log.imu.size(),
                               data->log.frames.size(),
                               plan_.audit && cell->config->backend == Backend::kFilter};
    if (options_.resume && HoldsRun(folder, identity)) {
      ++cells_reused_;
    } else {
      RunOptions run_options;
      run_options.truth = truth;
      run_options.seed = cell->seed;
      run_options.stop = options_.stop;
      run_options.audit = identity.audited;
      const RunResult result = RunEstimator(*cell->config, data->log, run_options);
      if (result.interrupted) {
        return Fail(cell, "interrupted");
      }
      if (const Status status = WriteRun(identity, result, folder); !status.ok()) {
        return Fail(cell, status.message());
      }
    }
    // Scored from what was written: fresh and resumed comparisons give the same figures to the last digit.
    const Result<RunResult> written = ReadRun(folder);
    return written.ok() ? ScoreRun(truth, *written, plan_.metrics, &cell->result)
                        : Fail(cell, written.message());
  }

  void RunExternalCell(const CompareInput::Data& data, Cell* cell) {
    const Trajectory* truth = data.truth ? &*data.truth : nullptr;
    const ExternalCell external{*cell->estimator,    *cell->sequence, cell->seed, data.log, truth,
                                data.dataset_digest, FolderOf(*cell)};
    const Result<ExternalOutcome> outcome = TrajectoryOfExternal(external, options_.resume, options_.stop);
    if (!outcome.ok()) {
      return Fail(cell, outcome.message());
    }
    ScoreTrajectory(truth, outcome->trajectory, plan_.metrics, &cell->result);
    if (outcome->run) {
      cells_reused_ += outcome->reused ? 1 : 0;
      // All of the program: it is one process to us.
      cell->result.backend_ms = 1e3 * outcome->run->wall_s / std::max(1, cell->result.frames);
    }
  }

  Result<CompareOutcome> Finish() {
    CompareOutcome outcome;
    outcome.interrupted = Stopped();
    outcome.cells_reused = cells_reused_;
    Comparison& comparison = outcome.comparison;
    comparison.title = plan_.title;
    comparison.references = plan_.references;
    comparison.command = options_.command;
    comparison.baseline = plan_.baseline;
    for (const auto& [name, path] : plan_.absent) {
      comparison.notes.push_back(name + ": its data is not there, expected the folder " + path);
    }
    comparison.pair_figures = plan_.pair_figures;
    comparison.pair_across = plan_.pair_across;
    for (const PlanEstimator& estimator : plan_.estimators) {
      for (Cell& cell : cells_) {
        if (cell.estimator == &estimator) {
          outcome.cells_failed += cell.result.status == "ok" ? 0 : 1;
          comparison.cells.push_back(std::move(cell.result));
        }
      }
    }
    if (!outcome.interrupted) {
      ALIDADE_RETURN_IF_ERROR(WriteTables(comparison, options_.output));
      ALIDADE_RETURN_IF_ERROR(WriteReport(comparison, options_.output + "/report.html"));
    }
    return outcome;
  }

  [[nodiscard]] std::string FolderOf(const Cell& cell) const {
    return options_.output + "/cells/" + cell.estimator->name + "/" + cell.sequence->name + "/" +
           std::to_string(cell.seed);
  }

  [[nodiscard]] bool Stopped() const { return options_.stop != nullptr && options_.stop->load(); }

  void Say(const std::string& line) {
    const std::lock_guard<std::mutex> lock(say_mutex_);
    if (options_.progress) {
      options_.progress(line);
    }
  }

  const Plan& plan_;
  const CompareOptions& options_;
  PipelineOptions pipeline_;
  /// Of each sequence, one an estimator in the plan's order; null when external.
  std::map<const PlanSequence*, std::vector<std::unique_ptr<EstimatorConfig>>> configs_;
  std::vector<std::unique_ptr<CompareInput>> inputs_;
  std::vector<Cell> cells_;
  std::atomic<size_t> next_cell_{0};
  std::atomic<size_t> cells_done_{0};
  std::atomic<int> cells_reused_{0};
  std::mutex say_mutex_;
};

}  // namespace

Result<CompareOutcome> Compare(const Plan& plan, const CompareOptions& options) {
  return Comparer(plan, options).Execute();
}

}  // namespace alidade
