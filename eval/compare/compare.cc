#include "eval/compare/compare.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>

#include "core/format.h"
#include "core/numbers.h"
#include "eval/compare/cell_list.h"
#include "eval/compare/cell_runner.h"
#include "eval/compare/slurm_run.h"
#include "eval/compare/worker_pool.h"
#include "eval/comparison/large_comparison.h"
#include "eval/files/input_file.h"
#include "eval/files/time_left.h"
#include "eval/files/utc_day.h"
#include "eval/report/report.h"
#include "eval/report/tables.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

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
  Comparer(const Plan& plan, const CompareOptions& options) : plan_(plan), options_(options) {}

  Result<CompareOutcome> Execute() {
    ALIDADE_RETURN_IF_ERROR(MakeCells());
    ALIDADE_RETURN_IF_ERROR(RemoveEarlier());
    ALIDADE_RETURN_IF_ERROR(cells_.WriteTable(options_.output));
    ALIDADE_RETURN_IF_ERROR(RunAll());
    return Finish();
  }

  Result<CompareOutcome> Collect() {
    ALIDADE_RETURN_IF_ERROR(MakeCells());
    ALIDADE_RETURN_IF_ERROR(cells_.WriteTable(options_.output));
    for (size_t cell = 0; cell < cells_.size(); ++cell) {
      Take(cell, {});
    }
    return Finish();
  }

 private:
  Status MakeCells() {
    const Result<std::string> day = UtcDay();
    ALIDADE_RETURN_IF_ERROR(day.status());
    provenance_ = {ALIDADE_VERSION, *day, ReadMachine()};
    ALIDADE_RETURN_IF_ERROR(cells_.Make(plan_, options_));
    std::map<std::pair<const PlanEstimator*, const PlanSequence*>, size_t> groups;
    std::vector<size_t> group;
    for (size_t cell = 0; cell < cells_.size(); ++cell) {
      const auto of = std::pair(cells_.at(cell).estimator, cells_.at(cell).sequence);
      group.push_back(groups.try_emplace(of, groups.size()).first->second);
    }
    shown_ = ShownCells(group, groups.size());
    return Status::Ok();
  }

  /// Reports of an earlier comparison in this folder, and, unless its cells are to be kept, its tracks.
  Status RemoveEarlier() const {
    std::error_code error;
    fs::remove_all(options_.output + "/scores", error);
    if (!error && !options_.resume) {
      fs::remove_all(options_.output + "/logs", error);
    }
    return error ? Status::Output(options_.output + ": cannot be emptied: " + error.message()) : Status::Ok();
  }

  Status RunAll() {
    if (options_.slurm) {
      SlurmRun slurm(options_, cells_, [this](size_t cell, const std::string& fault) { End(cell, fault); });
      return slurm.Run();
    }
    if (!options_.worker.empty()) {
      std::vector<size_t> all(cells_.size());
      std::iota(all.begin(), all.end(), size_t{0});
      WorkerPool pool(options_, cells_, all, [this](size_t cell) { End(cell, {}); });
      return pool.Run();
    }
    CellRunner runner(plan_, options_, &cells_);
    for (size_t cell = 0; cell < cells_.size() && !options_.Stopped(); ++cell) {
      ALIDADE_RETURN_IF_ERROR(runner.Run(cell));
      if (!options_.Stopped()) {
        End(cell, {});
      }
    }
    return Status::Ok();
  }

  void End(size_t cell, const std::string& fault) {
    Take(cell, fault);
    const double elapsed_s = std::chrono::duration<double>(Clock::now() - begin_).count();
    ++cells_done_;
    Progress("[" + std::to_string(cells_done_) + "/" + std::to_string(cells_.size()) +
             TimeLeft(elapsed_s, cells_done_, cells_.size()) + "] " + OneLine(cells_.at(cell).result));
  }

  /// Reads what the cell has left; `fault`: why it left nothing.
  void Take(size_t index, const std::string& fault) {
    CompareCell& cell = cells_.at(index);
    Result<CellReport> report =
        fault.empty() ? ReadCellFile(cell.report_file) : Result<CellReport>(Status::Input(fault));
    if (report.ok() && report->digest != cell.digest) {
      report = Status::Input(cell.report_file +
                             ": of another plan or configuration, expected one of this plan; --stage=cells "
                             "runs the cell again");
    }
    if (!report.ok()) {
      cell.result.status = "failed";
      cell.result.message = report.message();
      return;
    }
    cell.result = std::move(report->result);
    shown_.Thin(index, &cell.result);
    cells_reused_ += report->reused ? 1 : 0;
    NoteInput(cell, *report);
  }

  /// Prints once an input the remarks on it and the figures of its front end, and keeps the latter for the
  /// tables.
  void NoteInput(const CompareCell& cell, const CellReport& report) {
    if (!noted_.insert(cell.input).second) {
      return;
    }
    for (const std::string& remark : report.remarks) {
      Progress(remark);
    }
    if (!report.frontend) {
      return;
    }
    const FrontendSummary& summary = *report.frontend;
    frontends_.emplace(cell.input, summary);
    Progress("front end of " + summary.sequence + ": " +
             Format("%d images, %.2f ms each, %.0f features, tracks of %.0f frames, %.2f %% rejected",
                    summary.images, summary.mean_ms, summary.features_per_frame, summary.mean_length,
                    100 * summary.rejected_share));
  }

  Result<CompareOutcome> Finish() {
    CompareOutcome outcome;
    outcome.interrupted = options_.Stopped();
    outcome.cells_reused = cells_reused_;
    Comparison& comparison = outcome.comparison;
    comparison.title = plan_.title;
    comparison.references = plan_.references;
    comparison.provenance = provenance_;
    comparison.command = options_.command;
    comparison.baseline = plan_.baseline;
    comparison.notes = NotesOfAbsent();
    comparison.shown_note = shown_.note();
    for (const PlanSequence& sequence : plan_.sequences) {
      if (!sequence.group.empty()) {
        comparison.groups[sequence.name] = sequence.group;
      }
    }
    for (const std::unique_ptr<CompareInput>& input : cells_.inputs()) {
      if (const auto found = frontends_.find(input.get()); found != frontends_.end()) {
        comparison.frontends.push_back(found->second);
      }
    }
    comparison.pair_figures = plan_.pair_figures;
    comparison.pair_across = plan_.pair_across;
    for (const PlanEstimator& estimator : plan_.estimators) {
      for (size_t i = 0; i < cells_.size(); ++i) {
        if (CompareCell& cell = cells_.at(i); cell.estimator == &estimator) {
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
    std::set<const PlanEstimator*> used;
    for (size_t cell = 0; cell < cells_.size(); ++cell) {
      used.insert(cells_.at(cell).estimator);
    }
    for (const PlanEstimator& estimator : plan_.estimators) {
      if (used.count(&estimator) == 0) {
        notes.push_back(estimator.name + ": all its sequences are missing");
      }
    }
    return notes;
  }

  void Progress(const std::string& line) const {
    if (options_.progress) {
      options_.progress(line);
    }
  }

  const Plan& plan_;
  const CompareOptions& options_;
  const Clock::time_point begin_ = Clock::now();
  Provenance provenance_;
  CellList cells_;
  ShownCells shown_;
  std::map<const CompareInput*, FrontendSummary> frontends_;
  std::set<const CompareInput*> noted_;
  size_t cells_done_ = 0;
  int cells_reused_ = 0;
};

}  // namespace

Result<CompareOutcome> Compare(const Plan& plan, const CompareOptions& options) {
  return Comparer(plan, options).Execute();
}

Result<CompareOutcome> CollectCells(const Plan& plan, const CompareOptions& options) {
  return Comparer(plan, options).Collect();
}

Status RunCells(const Plan& plan, const CompareOptions& options, const CellPart& part) {
  CellList cells;
  ALIDADE_RETURN_IF_ERROR(cells.Make(plan, options));
  ALIDADE_RETURN_IF_ERROR(cells.WriteTable(options.output));
  std::vector<size_t> wanted;
  for (size_t cell = part.First(cells.size()); cell < part.End(cells.size()); ++cell) {
    const CompareCell& candidate = cells.at(cell);
    const Result<CellReport> earlier = MayExist(candidate.report_file)
                                           ? ReadCellFile(candidate.report_file)
                                           : Result<CellReport>(Status::Input("none"));
    if (!earlier.ok() || earlier->digest != candidate.digest) {
      wanted.push_back(cell);
    }
  }
  WorkerPool pool(options, cells, wanted, [](size_t) {});
  return pool.Run();
}

Status TrackInputs(const Plan& plan, const CompareOptions& options, const CellPart& part) {
  CellList cells;
  ALIDADE_RETURN_IF_ERROR(cells.Make(plan, options));
  ALIDADE_RETURN_IF_ERROR(cells.WriteTable(options.output));
  CellRunner runner(plan, options, &cells);
  const CompareInput* prepared = nullptr;
  for (size_t cell = part.First(cells.size()); cell < part.End(cells.size()) && !options.Stopped(); ++cell) {
    if (cells.at(cell).input->may_track() && cells.at(cell).input != prepared) {
      prepared = cells.at(cell).input;
      // The signal ends this process; the cells of the input then track it within their own limits.
      ::alarm(static_cast<unsigned>(std::ceil(options.limits.time_s)));
      ALIDADE_RETURN_IF_ERROR(runner.Prepare(cell));
    }
  }
  ::alarm(0);
  return Status::Ok();
}

}  // namespace alidade
