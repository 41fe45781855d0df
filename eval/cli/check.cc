#include <cstdio>
#include <utility>

#include "core/format.h"
#include "eval/bag/dataset_images.h"
#include "eval/bag/dataset_source.h"
#include "eval/bag/frozen_images.h"
#include "eval/calibrate/camera_gyro_check.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_check.h"
#include "eval/frontend_run/image_pipeline.h"

namespace alidade::cli {
namespace {

const char* Word(DatasetFinding::Severity severity) {
  switch (severity) {
    case DatasetFinding::Severity::kError:
      return "error";
    case DatasetFinding::Severity::kWarning:
      return "warning";
    case DatasetFinding::Severity::kFact:
      break;
  }
  return "fact";
}

/// Decodes every image and names those that the front end would skip.
void CheckImages(const Dataset& dataset, Findings* findings) {
  DatasetImages images;
  ProgressLine progress("images");
  size_t unreadable = 0;
  for (size_t i = 0; i < dataset.images.size(); ++i) {
    if (const Result<GreyImage> image = images.ReadFor(dataset.rig.camera, dataset.images[i]); !image.ok()) {
      ++unreadable;
      findings->Warning("cam0: " + image.message());
    }
    progress.Update(i + 1, dataset.images.size());
  }
  if (static_cast<double>(unreadable) > kMaxUnreadableShare * static_cast<double>(dataset.images.size())) {
    findings->Error(Format("cam0: %zu of %zu images cannot be used, expected at most %.0f %%", unreadable,
                           dataset.images.size(), 100 * kMaxUnreadableShare));
  }
}

/// Tracks of the images, or those of the sequence, against the gyroscope.
void CheckCameraMotion(const Dataset& dataset, Findings* findings) {
  constexpr size_t kLeastSamples = 2;
  constexpr size_t kMostPairs = 200;
  if (dataset.imu.size() < kLeastSamples || (dataset.frames.empty() && dataset.images.empty())) {
    return;
  }
  PipelineOptions options;
  ProgressLine progress("tracks");
  options.progress = [&progress](size_t done, size_t total) { progress.Update(done, total); };
  const Result<MeasurementLog> log = MakeLog(dataset, FrontendConfig(), options);
  if (log.ok()) {  // otherwise CheckImages has reported why
    CheckCameraAgainstGyro(*log, kMostPairs, findings);
  }
}

}  // namespace

int RunCheck(const std::vector<std::string>&) {
  const Result<Dataset> dataset = ReadDataset(SourceFromFlags());
  if (!dataset.ok()) {
    return Report(dataset.status());
  }
  bool faulty = false;
  Findings findings;
  CheckImages(*dataset, &findings);
  CheckFrozenImages(*dataset, &findings);
  CheckCameraMotion(*dataset, &findings);
  std::vector<DatasetFinding> list = CheckDataset(*dataset);
  for (DatasetFinding& finding : findings.Take()) {
    list.push_back(std::move(finding));
  }
  for (const DatasetFinding& finding : list) {
    std::printf("%-8s %s\n", Word(finding.severity), finding.text.c_str());
    faulty = faulty || finding.severity == DatasetFinding::Severity::kError;
  }
  return faulty ? kExitInput : kExitDone;
}

}  // namespace alidade::cli
