#include "eval/cli/command.h"
#include "eval/cli/command_line.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/config_yaml.h"
#include "eval/image_pipeline.h"
#include "eval/simulator.h"

namespace alidade::cli {

int RunSimulate(const std::vector<std::string>&) {
  const Result<SimulatorConfig> config = LoadSimulatorConfig(FLAGS_config, SplitSettings(FLAGS_set));
  Status status = config.ok() ? PrepareOutputFolder(FLAGS_output, FLAGS_overwrite) : config.status();
  if (!status.ok()) {
    return Report(status);
  }
  const Result<Dataset> dataset = Simulate(*config, FLAGS_seed);
  if (!dataset.ok()) {
    return Report(dataset.status());
  }
  status = WriteDataset(*dataset, FLAGS_output);
  if (status.ok()) {
    const MeasurementLog log{dataset->rig, dataset->imu, dataset->tracks, dataset->extra_cameras};
    Say(FLAGS_output + ": " + DescribeLog(log, DigestOf(log)));
  }
  return Report(status);
}

}  // namespace alidade::cli
