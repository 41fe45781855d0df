#include "eval/compare/slurm_run.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <numeric>
#include <thread>

#include "core/format.h"
#include "eval/compare/worker_process.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
#include "eval/files/shell_quote.h"

namespace alidade {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kMostTasks = 1000;  // Slurm's default MaxArraySize is 1001
constexpr size_t kFewTasks = 32;     // fewer would leave nodes idle
constexpr std::chrono::seconds kBetweenScans{1};
constexpr std::chrono::seconds kBetweenQueries{5};
constexpr int kMostFailedQueries = 6;  // the controller may be restarting

struct CommandOutput {
  std::string text;
  std::string ended;  ///< as WorkerProcess::Join
};

Result<CommandOutput> RunProgram(const std::vector<std::string>& words) {
  std::vector<std::string> found = {"/usr/bin/env"};
  found.insert(found.end(), words.begin(), words.end());
  Result<WorkerProcess> process = WorkerProcess::Start(found);
  ALIDADE_RETURN_IF_ERROR(process.status());
  CommandOutput output;
  while (process->Read()) {
    while (const std::optional<std::string> line = process->Line()) {
      output.text += *line + "\n";
    }
  }
  output.ended = process->Join();
  return output;
}

}  // namespace

SlurmRun::SlurmRun(const CompareOptions& options, const CellList& cells,
                   std::function<void(size_t cell, const std::string& fault)> ended)
    : options_(options),
      cells_(cells),
      ended_(std::move(ended)),
      folder_(std::filesystem::absolute(options.output).string() + "/slurm"),
      open_(cells.size()) {
  std::iota(open_.begin(), open_.end(), size_t{0});
}

Result<std::string> SlurmRun::SubmitJob(const std::string& name, size_t tasks, const std::string& stage,
                                        const std::string& after) {
  std::string script = "#!/bin/sh\n";
  for (const std::string& word : options_.worker) {
    script += ShellQuoted(word) + " ";
  }
  script += "--stage=" + stage;
  script += tasks > 0 ? " --part=\"$SLURM_ARRAY_TASK_ID/" + std::to_string(tasks) + "\"\n"
                      : "\necho $? > " + ShellQuoted(folder_ + "/ended") + "\n";
  const std::string path = folder_ + "/" + name + ".sh";
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(path, script));
  std::vector<std::string> words = {"sbatch", "--parsable", "--requeue", "--open-mode=append",
                                    "--job-name=alidade_" + name};
  words.push_back("--output=" + folder_ + "/" + name + (tasks > 0 ? "_%a.log" : ".log"));
  if (tasks > 0) {
    words.push_back("--array=0-" + std::to_string(tasks - 1) +
                    (options_.jobs > 1 ? "%" + std::to_string(options_.jobs) : ""));
  }
  if (!after.empty()) {
    words.push_back("--dependency=afterany:" + after);
  }
  std::string word;
  for (const char c : options_.slurm_options + " ") {
    if (c != ' ') {
      word += c;
    } else if (!word.empty()) {
      words.push_back(std::move(word));
      word.clear();
    }
  }
  words.push_back(path);
  const Result<CommandOutput> output = RunProgram(words);
  ALIDADE_RETURN_IF_ERROR(output.status());
  const std::string job = output->text.substr(0, output->text.find_first_of(";\n"));
  if (output->ended != "code 0" || job.empty()) {
    return Status::Output(
        "sbatch ended with " + output->ended +
        (output->ended == "code 127" ? ": is Slurm installed (Debian package slurm-client)?" : ""));
  }
  return job;
}

Status SlurmRun::Submit() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
  std::filesystem::create_directories(folder_, ignored);
  // A task an input, which is then loaded once, where there are enough of them.
  const size_t inputs = cells_.inputs().size();
  const size_t tasks = std::min(inputs < kFewTasks ? cells_.size() : inputs, kMostTasks);
  std::string after;
  const auto submit = [&](const std::string& name, size_t count, const std::string& stage) {
    const Result<std::string> job = SubmitJob(name, count, stage, after);
    if (job.ok()) {
      jobs_.push_back(*job);
      after = *job;
    }
    return job.status();
  };
  const bool track = std::any_of(cells_.inputs().begin(), cells_.inputs().end(),
                                 [](const auto& input) { return input->may_track(); });
  if (track) {
    ALIDADE_RETURN_IF_ERROR(submit("tracks", std::min(inputs, kMostTasks), "tracks"));
  }
  ALIDADE_RETURN_IF_ERROR(submit("cells", tasks, "cells"));
  return submit("tables", 0, "tables");
}

void SlurmRun::Scan() {
  const auto come = std::stable_partition(
      open_.begin(), open_.end(), [this](size_t cell) { return !MayExist(cells_.at(cell).report_file); });
  const std::vector<size_t> reported(come, open_.end());
  open_.erase(come, open_.end());
  for (const size_t cell : reported) {
    ended_(cell, {});
  }
}

bool SlurmRun::Exists() const {
  const Result<CommandOutput> output = RunProgram({"squeue", "--noheader", "--jobs=" + jobs_.back()});
  return output.ok() && output->ended == "code 0" && !output->text.empty();
}

Status SlurmRun::Run() {
  ALIDADE_RETURN_IF_ERROR(Submit());
  std::string names;
  for (const std::string& job : jobs_) {
    names += (names.empty() ? "" : " ") + job;
  }
  if (options_.progress) {
    options_.progress("jobs " + names + " of Slurm; `scancel " + names +
                      "` ends them, `alidade compare --status=" + options_.output +
                      "` prints their progress");
  }
  int failed_queries = 0;
  Clock::time_point next_query = Clock::now() + kBetweenQueries;
  while (!options_.Stopped() && !MayExist(folder_ + "/ended")) {
    std::this_thread::sleep_for(kBetweenScans);
    Scan();
    if (Clock::now() < next_query) {
      continue;
    }
    next_query = Clock::now() + kBetweenQueries;
    failed_queries = Exists() ? 0 : failed_queries + 1;
    if (failed_queries > kMostFailedQueries) {
      return Status::Output("the jobs " + names + " are gone and have written no tables; their logs are in " +
                            folder_);
    }
  }
  if (options_.Stopped()) {
    return Status::Ok();
  }
  Scan();
  for (const size_t cell : open_) {
    ended_(cell, "it left no report; the logs of its job are in " + folder_);
  }
  return Status::Ok();
}

}  // namespace alidade
