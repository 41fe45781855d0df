#include "eval/compare/compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <thread>
#include <vector>

#include "core/blas.h"
#include "core/format.h"
#include "core/numbers.h"
#include "eval/compare/compare_cell.h"
#include "eval/compare/compare_configs.h"
#include "eval/comparison/cell_score.h"
#include "eval/files/input_file.h"
#include "eval/report/report.h"
#include "eval/report/tables.h"
#include "eval/run/make_estimator.h"

namespace alidade {
namespace {

std::string OneLine(const CellResult& cell) {
  std::string figures;
  if (cell.ate_pos_m) {
    figures = Format(", ATE %.3f m %.3f deg, %.2f ms a frame", *cell.ate_pos_m,
                     cell.ate_ori_deg.value_or(kNan), cell.backend_ms.value_or(kNan));
  }
  return cell.estimator + " / " + cell.sequence + " / " + std::to_string(cell.seed) + ": " + cell.status +
         figures + (cell.message.empty() ? "" : " (" + cell.message + ")");
}

/// One comparison from a plan to its tables.
class Comparer {
 public:
  Comparer(const Plan& plan, const CompareOptions& options) : plan_(plan), options_(options) {
    pipeline_.stop = options.stop;
    pipeline_.jobs = options.jobs;
  }

  Result<CompareOutcome> Execute() {
    ALIDADE_RETURN_IF_ERROR(configs_.Load(plan_));
    ALIDADE_RETURN_IF_ERROR(MakeCells());
    RunAll();
    return Finish();
  }

 private:
  Status MakeCells() {
    for (const PlanSequence& sequence : plan_.sequences) {
      if (sequence.dataset.path.empty()) {
        ALIDADE_RETURN_IF_ERROR(AddSimulation(sequence));
      } else {
        FrontendConfig frontend;
        if (!MayExist(sequence.dataset.path + "/mav0/cam0/tracks.csv")) {
          ALIDADE_RETURN_IF_ERROR(configs_.CommonFrontend(sequence, &frontend));
        }
        inputs_.push_back(std::make_unique<CompareInput>(sequence, frontend, CacheOf(sequence, 0)));
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
    FrontendConfig frontend;
    if (config->render.enabled) {
      ALIDADE_RETURN_IF_ERROR(configs_.CommonFrontend(sequence, &frontend));
    }
    for (const unsigned seed : sequence.seeds) {
      inputs_.push_back(
          std::make_unique<CompareInput>(sequence, *config, seed, frontend, CacheOf(sequence, seed)));
      AddCells(sequence, seed, inputs_.back().get());
    }
    return Status::Ok();
  }

  void AddCells(const PlanSequence& sequence, unsigned seed, CompareInput* input) {
    for (size_t i = 0; i < plan_.estimators.size(); ++i) {
      const PlanEstimator& estimator = plan_.estimators[i];
      if (!estimator.RunsOn(sequence.name)) {
        continue;
      }
      const EstimatorConfig* config = configs_.Of(sequence, i);
      CompareCell cell{&estimator, config, &sequence, input, seed, "", {}};
      cell.folder =
          options_.output + "/cells/" + estimator.name + "/" + sequence.name + "/" + std::to_string(seed);
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
      Say("using one job: this OpenBLAS was built without locks; install libopenblas0-pthread");
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
      CompareCell& cell = cells_[i];
      const auto note = [this, &cell](const CompareInput::Data& data) { NoteInput(cell, data); };
      cells_reused_ += RunCompareCell(plan_, options_, pipeline_, note, &cell) ? 1 : 0;
      cell.input->Release();
      Say("[" + std::to_string(++cells_done_) + "/" + std::to_string(cells_.size()) + "] " +
          OneLine(cell.result));
    }
  }

  /// Says once an input what was odd about it and what its front end did, and keeps the latter for the
  /// tables.
  void NoteInput(const CompareCell& cell, const CompareInput::Data& data) {
    FrontendSummary summary = data.frontend.value_or(FrontendSummary());
    summary.sequence = cell.sequence->name;
    summary.seed = cell.seed;
    {
      const std::lock_guard<std::mutex> lock(noted_mutex_);
      if (!noted_.insert(cell.input).second) {
        return;
      }
      if (data.frontend) {
        frontends_.emplace(cell.input, summary);
      }
    }
    for (const std::string& remark : data.remarks) {
      Say(remark);
    }
    if (!data.frontend) {
      return;
    }
    Say("front end of " + summary.sequence + ": " +
        Format("%d images, %.2f ms each, %.0f features, tracks of %.0f frames, %.2f %% rejected",
               summary.images, summary.mean_ms, summary.features_per_frame, summary.mean_length,
               100 * summary.rejected_share));
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
    comparison.notes = NotesOfAbsent();
    for (const PlanSequence& sequence : plan_.sequences) {
      if (!sequence.group.empty()) {
        comparison.groups[sequence.name] = sequence.group;
      }
    }
    for (const std::unique_ptr<CompareInput>& input : inputs_) {
      if (const auto found = frontends_.find(input.get()); found != frontends_.end()) {
        comparison.frontends.push_back(found->second);
      }
    }
    comparison.pair_figures = plan_.pair_figures;
    comparison.pair_across = plan_.pair_across;
    for (const PlanEstimator& estimator : plan_.estimators) {
      for (CompareCell& cell : cells_) {
        if (cell.estimator == &estimator) {
          outcome.cells_failed += cell.result.status == "ok" ? 0 : 1;
          comparison.cells.push_back(std::move(cell.result));
        }
      }
    }
    if (!outcome.interrupted) {
      ALIDADE_RETURN_IF_ERROR(WriteTables(comparison, options_.output));
      ALIDADE_RETURN_IF_ERROR(WriteFigureFiles(comparison, options_.figures, options_.output));
      ALIDADE_RETURN_IF_ERROR(WriteReport(comparison, options_.output + "/report.html"));
    }
    return outcome;
  }

  /// What was not run, and why.
  [[nodiscard]] std::vector<std::string> NotesOfAbsent() const {
    std::vector<std::string> notes;
    for (const auto& [name, path] : plan_.absent) {
      notes.push_back(name + ": its data is missing, expected " + path);
    }
    for (const auto& [name, path] : plan_.absent_programs) {
      notes.push_back(name + ": its program is missing, expected " + path);
    }
    for (const PlanEstimator& estimator : plan_.estimators) {
      if (std::none_of(cells_.begin(), cells_.end(),
                       [&](const CompareCell& cell) { return cell.estimator == &estimator; })) {
        notes.push_back(estimator.name + ": all its sequences are missing");
      }
    }
    return notes;
  }

  [[nodiscard]] FrontendCache CacheOf(const PlanSequence& sequence, unsigned seed) const {
    return {options_.output + "/logs/" + sequence.name + "/" + std::to_string(seed), options_.resume};
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
  CompareConfigs configs_;
  std::vector<std::unique_ptr<CompareInput>> inputs_;
  std::vector<CompareCell> cells_;
  std::map<const CompareInput*, FrontendSummary> frontends_;
  std::set<const CompareInput*> noted_;
  std::mutex noted_mutex_;
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
