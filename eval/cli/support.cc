#include "eval/cli/support.h"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/split_words.h"
#include "eval/config/config_yaml.h"
#include "eval/dataset/dataset.h"
#include "eval/files/folder_lock.h"
#include "eval/files/lies_in.h"
#include "eval/files/output_file.h"
#include "eval/files/time_left.h"

namespace alidade::cli {
namespace {

constexpr size_t kPlainSteps = 10;

// A signal handler reaches nothing but statics.
std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void OnSignal(int signal) {
  if (interrupted.exchange(true)) {
    _exit(128 + signal);
  }
}

}  // namespace

Result<EstimatorConfig> EstimatorConfigFromFlags() {
  if (!FLAGS_config.empty()) {
    return LoadEstimatorConfig(FLAGS_config, SplitSettings(FLAGS_set));
  }
  EstimatorConfig config;
  ALIDADE_RETURN_IF_ERROR(ApplySettings(SplitSettings(FLAGS_set),
                                        [&config](ConfigVisitor& visitor) { config.Describe(visitor); }));
  return config;
}

DatasetSource SourceFromFlags() {
  return {FLAGS_dataset, FLAGS_topics, SplitWords(FLAGS_calibration), FLAGS_camera, FLAGS_follow_links};
}

Result<Dataset> ReadDatasetFromFlags(const DatasetStorage& storage) {
  Result<Dataset> dataset = ReadDataset(SourceFromFlags(), storage);
  if (dataset.ok()) {
    for (const std::string& remark : dataset->remarks) {
      PrintNote(remark);
    }
  }
  return dataset;
}

int Report(const Status& status) {
  if (status.ok()) {
    return kExitDone;
  }
  std::fprintf(stderr, "alidade: %s\n", status.message().c_str());
  switch (status.code()) {
    case StatusCode::kUsage:
      return kExitUsage;
    case StatusCode::kConfig:
      return kExitConfig;
    case StatusCode::kInput:
      return kExitInput;
    case StatusCode::kDiverged:
      return kExitDiverged;
    case StatusCode::kOutput:
    case StatusCode::kOk:
      break;
  }
  return kExitOutput;
}

Status RequireFlag(const std::string& command, const std::string& flag, const std::string& value) {
  return value.empty() ? Status::Usage(command + ": --" + flag + " is missing") : Status::Ok();
}

Status RequireOutputBesideDataset(const std::string& output, const std::string& dataset) {
  return !dataset.empty() && LiesIn(output, dataset)
             ? Status::Output(output + ": lies in the dataset " + dataset +
                              ", expected a folder outside of it for the output")
             : Status::Ok();
}

Status CheckOutputFolder(const std::string& path, bool allowed) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (path.empty()) {
    return Status::Usage("--output: found an empty path, expected a folder");
  }
  if (const fs::path whole = fs::weakly_canonical(fs::absolute(path), error); whole == whole.root_path()) {
    return Status::Output(path + ": is the root of the file system, expected a folder for the output alone");
  }
  if (fs::exists(path, error) && !fs::is_directory(path, error)) {
    return Status::Output(path + ": exists and is not a folder, expected a folder for the output");
  }
  if (!allowed && fs::exists(path, error) && !fs::is_empty(path, error)) {
    return Status::Output(path + ": exists and is not empty, expected a new folder or --overwrite");
  }
  fs::path above = fs::absolute(path, error);
  while (above.has_relative_path() && !fs::exists(above, error)) {
    above = above.parent_path();
  }
  if (!fs::is_directory(above, error)) {
    return Status::Output(path + ": cannot be made: " + above.string() + " is not a folder");
  }
  if (access(above.c_str(), W_OK | X_OK) != 0) {
    const std::string reason = std::strerror(errno);
    return Status::Output(path + ": cannot be written to: " + above.string() + ": " + reason);
  }
  return Status::Ok();
}

Status PrepareOutputFolder(const std::string& path, bool allowed) {
  ALIDADE_RETURN_IF_ERROR(CheckOutputFolder(path, allowed));
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) {
    return Status::Output(path + ": cannot be made: " + error.message());
  }
  ALIDADE_RETURN_IF_ERROR(LockFolder(path));
  RemoveTemporaryFiles(path);
  return Status::Ok();
}

Status CheckOutputFile(const std::string& path) {
  std::error_code ignored;
  return !FLAGS_overwrite && std::filesystem::exists(path, ignored)
             ? Status::Output(path + ": exists, expected a new file or --overwrite")
             : Status::Ok();
}

void PrintNote(const std::string& line) {
  if (!FLAGS_quiet) {
    PrintResult(line);
  }
}

void PrintResult(const std::string& line) {
  std::fflush(stdout);  // a log of both streams keeps their order
  std::fprintf(stderr, "%s\n", line.c_str());
}

ProgressLine::ProgressLine(std::string label)
    : label_(std::move(label)), terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() {
  if (open_) {
    std::fputc('\n', stderr);
  }
}

void ProgressLine::Update(size_t done, size_t total) {
  const size_t steps = terminal_ ? 100 : kPlainSteps;
  const size_t step = total == 0 ? steps : done * steps / total;
  if (FLAGS_quiet || step == shown_) {
    return;
  }
  shown_ = step;
  open_ = terminal_;
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  const std::string line =
      label_ + " " + std::to_string(done) + "/" + std::to_string(total) + TimeLeft(elapsed_s, done, total);
  std::fprintf(stderr, "%s%s%s", terminal_ ? "\r" : "", line.c_str(), terminal_ ? "\033[K" : "\n");
}

void ExitOnInterrupt() {
  const auto leave = [](int) { _exit(kExitInterrupted); };
  std::signal(SIGINT, leave);
  std::signal(SIGTERM, leave);
}

const std::atomic<bool>* InstallInterruptHandler() {
  std::signal(SIGINT, OnSignal);
  std::signal(SIGTERM, OnSignal);
  return &interrupted;
}

}  // namespace alidade::cli
