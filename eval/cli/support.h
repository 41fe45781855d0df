#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <string>

#include "core/estimator_config.h"
#include "core/status.h"
#include "eval/bag/dataset_source.h"

namespace alidade::cli {

/// Prints "alidade: <message>" on standard error and gives the exit code of the status.
int Report(const Status& status);

/// kUsage when a flag that this use of a command needs was left out.
Status RequireFlag(const std::string& command, const std::string& flag, const std::string& value);

/// kOutput: the output folder is the dataset or lies in it, whose files it might replace. An empty dataset:
/// none.
Status RequireOutputBesideDataset(const std::string& output, const std::string& dataset);

/// Refuses an output folder that is the root of the file system, one that is not empty unless `allowed`, and
/// one that cannot be made or written to (kOutput). Makes nothing: what takes long, or may find a fault in
/// the input, can come between this and PrepareOutputFolder.
Status CheckOutputFolder(const std::string& path, bool allowed);

/// CheckOutputFolder; makes the folder, and this process its only writer. kOutput: another process writes
/// there.
Status PrepareOutputFolder(const std::string& path, bool allowed);

/// kOutput: the output file exists, unless --overwrite.
Status CheckOutputFile(const std::string& path);

/// A line for people on standard error, unless --quiet.
void PrintNote(const std::string& line);
/// Likewise, whatever the flag: the result of a command.
void PrintResult(const std::string& line);

/// "label 120/600, about 2 min left": one line that rewrites itself on a terminal, every tenth as a plain
/// line otherwise; nothing with --quiet.
class ProgressLine {
 public:
  explicit ProgressLine(std::string label);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void Update(size_t done, size_t total);

 private:
  std::string label_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  bool terminal_ = false;
  bool open_ = false;
  size_t shown_ = 0;
};

/// The estimator's configuration of --config, or the defaults, with --set.
Result<EstimatorConfig> EstimatorConfigFromFlags();

/// The sequence that --dataset, --topics, --calibration and --camera name.
[[nodiscard]] DatasetSource SourceFromFlags();

/// Reads it; what was guessed or passed over goes to standard error.
Result<Dataset> ReadDatasetFromFlags(const DatasetStorage& storage = {});

/// From here on SIGINT and SIGTERM end the program at once with its exit code, for work that does not poll; a
/// file that is being written is completed first. InstallInterruptHandler replaces it.
void ExitOnInterrupt();

/// Set by SIGINT and SIGTERM once the handler is installed. A second signal ends the program at once.
[[nodiscard]] const std::atomic<bool>* InstallInterruptHandler();

}  // namespace alidade::cli
