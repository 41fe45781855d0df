#include <cstdio>
#include <utility>

#include "core/format.h"
#include "core/numbers.h"
#include "eval/bag/dataset_source.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/config/config_yaml.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/files/output_file.h"
#include "eval/trajectory/trajectory_reader.h"
#include "eval/truth/refine_dataset.h"
#include "eval/truth/refinement_report.h"

namespace alidade::cli {
namespace {

Result<RefineOptions> RefineOptionsFromFlags() {
  RefineOptions options;
  if (!(FLAGS_truth_rate >= 0 && FLAGS_truth_rate <= 1e6)) {
    return Status::Usage(
        Format("refine_truth: --truth_rate: found %g, expected 0 to 1e6 Hz", FLAGS_truth_rate));
  }
  for (const auto& [name, value] :
       {std::pair("truth_std_deg", FLAGS_truth_std_deg), std::pair("truth_std_m", FLAGS_truth_std_m)}) {
    if (!(value >= 0 && value <= 180)) {
      return Status::Usage(Format("refine_truth: --%s: found %g, expected 0 to 180", name, value));
    }
  }
  options.truth_rate_hz = FLAGS_truth_rate;
  options.imu_scale = FLAGS_imu_scale;
  options.noise = {kRadiansPerDegree * FLAGS_truth_std_deg, FLAGS_truth_std_m};
  ALIDADE_RETURN_IF_ERROR(ApplySettings(SplitSettings(FLAGS_set), [&options](ConfigVisitor& visitor) {
    visitor.Section("imu", "inertial sensor", [&] { options.imu.Describe(visitor); });
  }));
  return options;
}

Result<Dataset> DatasetToRefine() {
  Result<Dataset> dataset = ReadDataset(FLAGS_dataset, {.follow_links = FLAGS_follow_links});
  if (dataset.ok() && !FLAGS_truth.empty()) {
    Result<Trajectory> truth = ReadTrajectory(FLAGS_truth);
    ALIDADE_RETURN_IF_ERROR(truth.status());
    dataset->truth = std::move(truth).value();
    dataset->truth_path = FLAGS_truth;
  }
  return dataset;
}

/// What is wrong with the places of input and output, before anything is read or made.
Status CheckFolders() {
  if (const DatasetFormat& format = FormatOf(FLAGS_dataset); !format.is_asl) {
    return Status::Usage("refine_truth: --dataset: found " + std::string(format.name) + ", expected " +
                         FormatsWith(&DatasetFormat::is_asl) + " (alidade convert makes one)");
  }
  // Whoever reads the dataset reports what is wrong with it.
  if (Status shared = CheckRefinedOutput(FLAGS_dataset, FLAGS_output); shared.code() == StatusCode::kUsage) {
    return shared;
  }
  return CheckOutputFolder(FLAGS_output, FLAGS_overwrite);
}

}  // namespace

int RunRefineTruth(const std::vector<std::string>&) {
  Result<RefineOptions> options = RefineOptionsFromFlags();
  if (!options.ok()) {
    return Report(options.status());
  }
  if (const Status status = CheckFolders(); !status.ok()) {
    return Report(status);
  }
  const Result<Dataset> dataset = DatasetToRefine();
  if (!dataset.ok()) {
    return Report(dataset.status());
  }
  if (const Status status = PrepareOutputFolder(FLAGS_output, FLAGS_overwrite); !status.ok()) {
    return Report(status);
  }
  options->stop = InstallInterruptHandler();
  const Result<RefinedTruth> refined = RefineDataset(*dataset, *options);
  if (options->stop->load()) {
    return kExitInterrupted;
  }
  if (!refined.ok()) {
    return Report(refined.status());
  }
  const std::string json = FormatRefinementJson(*refined, *dataset, *options);
  Status written = WriteRefined(*dataset, *refined, FLAGS_output);
  if (written.ok()) {
    written = WriteFileAtomically(FLAGS_output + "/refine_truth.json", json);
  }
  if (!written.ok()) {
    return Report(written);
  }
  std::fputs((FLAGS_json ? json : FormatRefinementText(*refined)).c_str(), stdout);
  return kExitDone;
}

}  // namespace alidade::cli
