#include "eval/compare/compare.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "core/format.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/compare/cell_worker.h"
#include "eval/compare/compare_options.h"
#include "eval/compare/compare_status.h"
#include "eval/compare/plan_parser.h"
#include "eval/files/suggest.h"
#include "eval/report/tables_terminal.h"

namespace alidade::cli {
namespace {

/// "3/8" of --part.
Result<CellPart> ParsePart(const std::string& text) {
  CellPart part;
  const char* const end = text.data() + text.size();
  const auto [slash, bad_index] = std::from_chars(text.data(), end, part.index);
  if (bad_index == std::errc() && slash != end && *slash == '/') {
    const auto [rest, bad_count] = std::from_chars(slash + 1, end, part.parts);
    if (bad_count == std::errc() && rest == end && part.index < part.parts) {
      return part;
    }
  }
  return Status::Usage("compare: --part: found \"" + text + "\", expected K/N with K below N");
}

/// The words that start another process of this comparison, without its stage.
std::vector<std::string> WorkerWords() {
  std::error_code error;
  std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  std::vector<std::string> words = {error ? "/proc/self/exe" : program.string(),
                                    "compare",
                                    "--plan=" + FLAGS_plan,
                                    "--output=" + FLAGS_output,
                                    "--jobs=" + std::to_string(FLAGS_jobs),
                                    "--quiet"};
  if (!FLAGS_data.empty()) {
    words.push_back("--data=" + FLAGS_data);
  }
  if (!FLAGS_figures.empty()) {
    words.push_back("--figures=" + FLAGS_figures);
  }
  if (FLAGS_resume) {
    words.push_back("--resume");
  }
  if (FLAGS_cell_time_limit_s > 0) {
    words.push_back(Format("--cell_time_limit_s=%.17g", FLAGS_cell_time_limit_s));
  }
  if (FLAGS_cell_memory_limit_mib > 0) {
    words.push_back(Format("--cell_memory_limit_mib=%.17g", FLAGS_cell_memory_limit_mib));
  }
  return words;
}

int Conclude(const Result<CompareOutcome>& outcome) {
  if (!outcome.ok()) {
    return Report(outcome.status());
  }
  if (outcome->interrupted) {
    PrintNote(FLAGS_engine == "slurm" ? "interrupted: the jobs go on, and the last one writes the tables"
                                      : "interrupted: complete cells are kept, --resume continues");
    return kExitInterrupted;
  }
  std::fputs(FormatTable(outcome->comparison).c_str(), stdout);
  PrintNote(FLAGS_output + "/report.html");
  if (outcome->cells_failed > 0) {
    std::fprintf(stderr, "alidade: %d of %zu cells failed\n", outcome->cells_failed,
                 outcome->comparison.cells.size());
    return kExitCellsFailed;
  }
  return kExitDone;
}

/// One stage of a comparison that another process has begun.
int RunStage(const Plan& plan, CompareOptions options) {
  if (FLAGS_stage == "tables") {
    return Conclude(CollectCells(plan, options));
  }
  if (FLAGS_stage == "worker") {
    return Report(ServeCells(plan, options));
  }
  const Result<CellPart> part = ParsePart(FLAGS_part);
  if (!part.ok()) {
    return Report(part.status());
  }
  if (FLAGS_stage == "tracks") {
    const int code = Report(TrackInputs(plan, options, *part));
    return options.Stopped() ? kExitInterrupted : code;
  }
  options.worker = WorkerWords();
  options.worker.push_back("--stage=worker");
  if (std::getenv("SLURM_ARRAY_TASK_ID") != nullptr) {
    options.jobs = 1;  // --jobs is the number of tasks there
  }
  const int code = Report(RunCells(plan, options, *part));
  return options.Stopped() ? kExitInterrupted : code;
}

Status CheckWord(const char* flag, const std::string& word, const std::vector<std::string>& known) {
  return std::find(known.begin(), known.end(), word) != known.end()
             ? Status::Ok()
             : Status::Usage(std::string("compare: --") + flag + ": found \"" + word + "\"" +
                             Suggestion(word, known));
}

Status CheckFlags() {
  ALIDADE_RETURN_IF_ERROR(RequireFlag("compare", "plan", FLAGS_plan));
  ALIDADE_RETURN_IF_ERROR(RequireFlag("compare", "output", FLAGS_output));
  ALIDADE_RETURN_IF_ERROR(CheckWord("engine", FLAGS_engine, {"local", "slurm"}));
  ALIDADE_RETURN_IF_ERROR(CheckWord("stage", FLAGS_stage, {"all", "worker", "tracks", "cells", "tables"}));
  if (FLAGS_jobs < 1 || FLAGS_jobs > 1024) {
    return Status::Usage("compare: --jobs: found " + std::to_string(FLAGS_jobs) + ", expected 1 to 1024");
  }
  for (const auto& [flag, value] : {std::pair("cell_time_limit_s", FLAGS_cell_time_limit_s),
                                    std::pair("cell_memory_limit_mib", FLAGS_cell_memory_limit_mib)}) {
    if (!std::isfinite(value) || value < 0) {
      return Status::Usage(Format("compare: --%s: found %g, expected 0 (none) or more", flag, value));
    }
  }
  return Status::Ok();
}

}  // namespace

int RunCompare(const std::vector<std::string>&) {
  if (!FLAGS_status.empty()) {
    const Result<std::string> text = DescribeComparison(FLAGS_status);
    std::fputs(text.ok() ? text->c_str() : "", stdout);
    return Report(text.status());
  }
  if (const Status status = CheckFlags(); !status.ok()) {
    return Report(status);
  }
  const Result<FigureFormats> figures = ParseFigureFormats(FLAGS_figures);
  if (!figures.ok()) {
    return Report(Status(figures.code(), "compare: " + figures.message()));
  }
  const Result<Plan> plan = ReadPlan(FLAGS_plan, FLAGS_data);
  if (!plan.ok()) {
    return Report(plan.status());
  }
  CompareOptions options;
  options.output = FLAGS_output;
  options.jobs = FLAGS_jobs;
  options.resume = FLAGS_resume;
  options.figures = *figures;
  options.command = "alidade compare --plan=" + FLAGS_plan +
                    (FLAGS_data.empty() ? "" : " --data=" + FLAGS_data) + " --output=" + FLAGS_output +
                    (FLAGS_figures.empty() ? "" : " --figures=" + FLAGS_figures);
  options.progress = PrintNote;
  options.stop = InstallInterruptHandler();
  options.limits = {FLAGS_cell_time_limit_s, FLAGS_cell_memory_limit_mib};
  if (FLAGS_stage != "all") {
    return RunStage(*plan, std::move(options));
  }
  if (const Status status = PrepareOutputFolder(FLAGS_output, FLAGS_overwrite || FLAGS_resume);
      !status.ok()) {
    return Report(status);
  }
  options.slurm = FLAGS_engine == "slurm";
  options.slurm_options = FLAGS_slurm_options;
  options.worker = WorkerWords();
  if (!options.slurm) {
    options.worker.push_back("--stage=worker");
  }
  return Conclude(Compare(*plan, options));
}

}  // namespace alidade::cli
