#include "eval/cli/command.h"
#include "eval/cli/command_line.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/config_yaml.h"
#include "eval/image_pipeline.h"
#include "eval/simulator.h"

namespace alidade::cli {

int RunSimulate(const std::vector<std::string>&) {
  SimulatorConfig config;
  const auto describe = [&config](ConfigVisitor& visitor) { config.Describe(visitor); };
  Status status = ReadConfigFile(FLAGS_config, describe);
  status = status.ok() ? ApplySettings(SplitSettings(FLAGS_set), describe) : status;
  status = status.ok() ? config.Validate() : status;
  status = status.ok() ? PrepareOutputFolder(FLAGS_output, FLAGS_overwrite) : status;
  if (!status.ok()) {
    return Report(status);
  }
  const Result<Dataset> dataset = Simulate(config, FLAGS_seed);
  if (!dataset.ok()) {
    return Report(dataset.status());
  }
  status = WriteDataset(*dataset, FLAGS_output);
  if (status.ok()) {
    const MeasurementLog log{dataset->rig, dataset->imu, dataset->tracks};
    Say(FLAGS_output + ": " + DescribeLog(log, DigestOf(log)));
  }
  return Report(status);
}

}  // namespace alidade::cli
