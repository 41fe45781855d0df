#include <cstdio>

#include "core/format.h"
#include "eval/calibrate/camera_gyro_check.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/config/config_yaml.h"
#include "eval/dataset/dataset_check.h"
#include "eval/dataset/digest.h"
#include "eval/files/hash.h"
#include "eval/frontend_run/image_pipeline.h"
#include "eval/record/failure_diagnosis.h"
#include "eval/record/recorder.h"
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

Result<MeasurementLog> LogWithProgress(const Dataset& dataset, const FrontendConfig& frontend,
                                       const std::atomic<bool>* stop) {
  ProgressLine progress("images");
  PipelineOptions options;
  options.stop = stop;
  options.progress = [&progress](size_t done, size_t total) { progress.Update(done, total); };
  options.remark = Say;
  return MakeLog(dataset, frontend, options);
}

/// What `check` says of the sequence: warnings go to standard error, errors end the run before it begins.
Status CheckFirst(const Dataset& dataset, const MeasurementLog& log) {
  constexpr size_t kMostPairs = 60;
  Findings findings;
  if (!log.frames.empty()) {
    CheckCameraAgainstGyro(log, kMostPairs, &findings);
  }
  std::vector<DatasetFinding> list = CheckDataset(dataset);
  for (DatasetFinding& finding : findings.Take()) {
    list.push_back(std::move(finding));
  }
  std::string errors;
  for (const DatasetFinding& finding : list) {
    if (finding.severity == DatasetFinding::Severity::kWarning) {
      Say("warning: " + finding.text);
    } else if (finding.severity == DatasetFinding::Severity::kError) {
      errors += (errors.empty() ? "" : "; ") + finding.text;
    }
  }
  return errors.empty() ? Status::Ok() : Status::Input(dataset.path + ": " + errors);
}

RunResult RunWithProgress(const EstimatorConfig& config, const MeasurementLog& log, const Dataset& dataset,
                          const std::atomic<bool>* stop) {
  ProgressLine progress(config.name + ": frames");
  RunOptions options;
  options.truth = dataset.truth ? &*dataset.truth : nullptr;
  options.seed = FLAGS_seed;
  options.stop = stop;
  options.audit = FLAGS_audit;
  options.progress = [&progress](size_t done, size_t total) { progress.Update(done, total); };
  return RunEstimator(config, log, options);
}

std::string Summary(const RunResult& result) {
  const std::string times = Format("%.1f s wall, %.1f s CPU", result.wall_s, result.cpu_s);
  if (result.records.empty()) {
    return StatusWord(result) + ": no frame was estimated, " + times;
  }
  const double frames = static_cast<double>(result.records.size());
  return StatusWord(result) + ": " + std::to_string(result.records.size()) + " frames, " +
         std::to_string(result.frames_skipped) + " skipped, start: " + result.init_method + ", " + times +
         Format(", %.2f ms CPU a frame", 1e3 * result.cpu_s / frames) +
         (result.restarts.empty() ? "" : Format(", %zu restarts", result.restarts.size()));
}

}  // namespace

int RunRun(const std::vector<std::string>&) {
  const Result<EstimatorConfig> config = LoadConfig();
  if (!config.ok()) {
    return Report(config.status());
  }
  const Result<Dataset> dataset = ReadDatasetFromFlags();
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
  const Result<MeasurementLog> log = LogWithProgress(*dataset, config->frontend, stop);
  if (!log.ok()) {
    return stop->load() ? kExitInterrupted : Report(log.status());
  }
  if (const Status status = CheckFirst(*dataset, *log); !status.ok()) {
    return Report(status);
  }
  const RunIdentity identity{*config,    dataset->name,   *dataset_digest,    DigestOf(*log),
                             FLAGS_seed, log->imu.size(), log->frames.size(), FLAGS_audit};
  Say(DescribeLog(*log, identity.input_digest));
  const RunResult result = RunWithProgress(*config, *log, *dataset, stop);
  if (const Status status = WriteRun(identity, result, FLAGS_output); !status.ok()) {
    return Report(status);
  }
  Say(Summary(result));
  const bool asked = config->gnss.enabled || config->fix.enabled;
  const bool given =
      (config->gnss.enabled && dataset->gnss != nullptr) || (config->fix.enabled && !dataset->fixes.empty());
  if (asked && !result.global) {
    Say(std::string(config->gnss.enabled ? "GNSS was" : "position fixes were") +
        " not used: " + result.align_report);
  }
  if (Failed(result)) {
    RunOptions options;
    options.stop = stop;
    if (const std::optional<std::string> cause = DiagnoseAccelerometerSigns(*config, *log, result, options)) {
      return Report(Status::Input(dataset->path + ": " + *cause));
    }
  }
  if (!result.interrupted && result.status.ok() && ((given && !result.global) || !result.restarts.empty())) {
    return kExitImpaired;
  }
  return result.interrupted ? kExitInterrupted : Report(result.status);
}

}  // namespace alidade::cli
