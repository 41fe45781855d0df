#include <malloc.h>

#include <cstdio>

#include "core/format.h"
#include "eval/bag/frozen_images.h"
#include "eval/calibrate/camera_gyro_check.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/config/config_yaml.h"
#include "eval/dataset/dataset_check.h"
#include "eval/dataset/digest.h"
#include "eval/dataset/log_tables.h"
#include "eval/files/hash.h"
#include "eval/files/spool_file.h"
#include "eval/frontend_run/image_pipeline.h"
#include "eval/record/failure_diagnosis.h"
#include "eval/record/recorder.h"
#include "eval/record/run_health.h"
#include "eval/record/run_options.h"
#include "eval/record/runner.h"

namespace alidade::cli {
namespace {

Result<EstimatorConfig> LoadConfig() {
  std::vector<std::string> settings = SplitSettings(FLAGS_set);
  if (!FLAGS_backend.empty()) {
    if (FLAGS_backend != "filter" && FLAGS_backend != "smoother" && FLAGS_backend != "batch") {
      return Status::Usage("run: --backend: found '" + FLAGS_backend +
                           "', expected filter, smoother or batch");
    }
    settings.push_back("backend=" + FLAGS_backend);
  }
  Result<EstimatorConfig> config = LoadEstimatorConfig(FLAGS_config, settings);
  if (config.ok() && FLAGS_audit && config->backend != Backend::kFilter) {
    return Status::Usage("run: --audit: found backend " + std::string(ToString(config->backend)) +
                         ", expected filter: only a filter can be audited");
  }
  return config;
}

/// Where the long tables of the input and of the output go while the program runs: beside the output, which
/// has room for them.
std::string SpoolFolder() {
  return NearestFolder(FLAGS_output);
}

DatasetStorage StorageOf(const EstimatorConfig& config) {
  const bool starts_with_truth = config.init.method == InitMethod::kTruth;
  return {SpoolFolder(), starts_with_truth ? config.init.max_wait_s : 0};
}

Result<LogTables> TablesWithProgress(const Dataset& dataset, const FrontendConfig& frontend,
                                     const std::atomic<bool>* stop) {
  ProgressLine progress("images");
  PipelineOptions options;
  options.stop = stop;
  options.progress = [&progress](size_t done, size_t total) { progress.Update(done, total); };
  options.remark = PrintNote;
  return MakeTables(dataset, frontend, options, SpoolFolder());
}

/// The findings of `check` on the sequence: warnings go to standard error, errors end the run before it
/// begins.
Status CheckFirst(const Dataset& dataset, const LogTables& tables) {
  constexpr size_t kMostPairs = 60;
  Findings findings;
  CheckFrozenImages(dataset, &findings);
  if (!tables.frames.empty()) {
    CheckCameraAgainstGyro(dataset.rig, tables, kMostPairs, &findings);
  }
  std::vector<DatasetFinding> list = CheckDataset(dataset);
  for (DatasetFinding& finding : findings.Take()) {
    list.push_back(std::move(finding));
  }
  std::string errors;
  for (const DatasetFinding& finding : list) {
    if (finding.severity == DatasetFinding::Severity::kWarning) {
      PrintNote("warning: " + finding.text);
    } else if (finding.severity == DatasetFinding::Severity::kError) {
      errors += (errors.empty() ? "" : "; ") + finding.text;
    }
  }
  return errors.empty() ? Status::Ok() : Status::Input(dataset.path + ": " + errors);
}

/// Gives back what the checks alone needed and took.
void ReleaseChecked(Dataset* dataset) {
  dataset->truth_extent.reset();
  std::vector<TimeNs>().swap(dataset->camera_stamps);
  std::vector<ImageEntry>().swap(dataset->images);
  malloc_trim(0);
}

RunResult RunWithProgress(const EstimatorConfig& config, const MeasurementLog& log, const LogTables& tables,
                          const Dataset& dataset, const std::atomic<bool>* stop) {
  ProgressLine progress(config.name + ": frames");
  RunOptions options;
  options.truth = dataset.truth ? &*dataset.truth : nullptr;
  options.seed = FLAGS_seed;
  options.stop = stop;
  options.audit = FLAGS_audit;
  options.progress = [&progress](size_t done, size_t total) { progress.Update(done, total); };
  // An estimator that looks back holds all of the log, and all of its records.
  options.spool_folder = FLAGS_audit || config.backend == Backend::kBatch ? "" : SpoolFolder();
  return RunEstimator(config, log, tables, options);
}

/// Prints the summary of a run that was written; returns its exit code.
int Conclude(const EstimatorConfig& config, const Dataset& dataset, const LogTables& tables,
             const MeasurementLog& log, const RunResult& result, const std::atomic<bool>* stop) {
  const RunHealth health = HealthOf(config, result);
  PrintResult(DescribeRun(health, result));
  if (Failed(result)) {
    RunOptions options;
    options.stop = stop;
    options.progress = [](size_t choice, size_t choices) {
      PrintNote(Format("looking for the cause: signs of the accelerometer, %zu of %zu", choice, choices));
    };
    if (const std::optional<std::string> cause =
            DiagnoseAccelerometerSigns(config, log, tables, result, options)) {
      return Report(Status::Input(dataset.path + ": " + *cause));
    }
    if (stop->load()) {
      return kExitInterrupted;
    }
  }
  if (result.interrupted) {
    return kExitInterrupted;
  }
  return result.status.ok() && !health.impairments.empty() ? kExitImpaired : Report(result.status);
}

}  // namespace

int RunRun(const std::vector<std::string>&) {
  const Result<EstimatorConfig> config = LoadConfig();
  if (!config.ok()) {
    return Report(config.status());
  }
  if (const Status status = RequireOutputBesideDataset(FLAGS_output, FLAGS_dataset); !status.ok()) {
    return Report(status);
  }
  if (const Status status = CheckOutputFolder(FLAGS_output, FLAGS_overwrite); !status.ok()) {
    return Report(status);
  }
  Result<Dataset> dataset = ReadDatasetFromFlags(StorageOf(*config));
  if (!dataset.ok()) {
    return Report(dataset.status());
  }
  const Result<std::string> dataset_digest = DigestOf(SourceFromFlags());
  if (!dataset_digest.ok()) {
    return Report(dataset_digest.status());
  }
  if (const Status status = PrepareOutputFolder(FLAGS_output, FLAGS_overwrite); !status.ok()) {
    return Report(status);
  }
  const std::atomic<bool>* stop = InstallInterruptHandler();
  const Result<LogTables> tables = TablesWithProgress(*dataset, config->frontend, stop);
  if (!tables.ok()) {
    return stop->load() ? kExitInterrupted : Report(tables.status());
  }
  if (const Status status = CheckFirst(*dataset, *tables); !status.ok()) {
    return Report(status);
  }
  const MeasurementLog log = MeasurementsOf(*dataset);
  for (const std::string& sensor : MissingSensors(*config, log)) {
    PrintNote("warning: the sequence has no " + sensor + ", which the configuration enables");
  }
  const Result<std::string> input_digest = DigestOf(log, *tables);
  if (!input_digest.ok()) {
    return Report(input_digest.status());
  }
  const RunIdentity identity{*config,    dataset->name,      *dataset_digest,       *input_digest,
                             FLAGS_seed, tables->imu.size(), tables->frames.size(), FLAGS_audit};
  PrintNote(DescribeLog(log, *tables, identity.input_digest));
  ReleaseChecked(&dataset.value());
  const RunResult result = RunWithProgress(*config, log, *tables, *dataset, stop);
  if (const Status status = WriteRun(identity, result, FLAGS_output); !status.ok()) {
    return Report(status);
  }
  return Conclude(*config, *dataset, *tables, log, result, stop);
}

}  // namespace alidade::cli
