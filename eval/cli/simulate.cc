#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/config/config_yaml.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/dataset/digest.h"
#include "eval/frontend_run/image_pipeline.h"
#include "eval/render/rendered_sequence.h"
#include "eval/simulation/simulation.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"

namespace alidade::cli {
namespace {

/// Draws the images below the output folder.
Status Draw(const SimulatorConfig& config, const Simulation& simulation) {
  const Result<RenderedSequence> sequence = RenderedSequence::Create(config, simulation, FLAGS_seed);
  ALIDADE_RETURN_IF_ERROR(sequence.status());
  ProgressLine progress("images");
  PipelineOptions options;
  options.jobs = FLAGS_jobs;
  options.stop = InstallInterruptHandler();
  options.progress = [&progress](size_t done, size_t total) { progress.Update(done, total); };
  return WriteRenderedImages(*sequence, FLAGS_output, options);
}

}  // namespace

int RunSimulate(const std::vector<std::string>&) {
  ExitOnInterrupt();
  Result<SimulatorConfig> config = LoadSimulatorConfig(FLAGS_config, SplitSettings(FLAGS_set));
  if (config.ok() && FLAGS_render) {
    config->render.enabled = true;
  }
  Status status = config.ok() ? config->Validate() : config.status();
  if (status.ok()) {
    status = PrepareOutputFolder(FLAGS_output, FLAGS_overwrite);
  }
  if (!status.ok()) {
    return Report(status);
  }
  const Result<Simulation> simulation = SimulateWithMotion(*config, FLAGS_seed);
  if (!simulation.ok()) {
    return Report(simulation.status());
  }
  const Dataset& dataset = simulation->dataset;
  status = WriteDataset(dataset, FLAGS_output);
  if (status.ok() && config->render.enabled) {
    status = Draw(*config, *simulation);
    if (status.code() == StatusCode::kDiverged) {
      return kExitInterrupted;
    }
    PrintNote(FLAGS_output + ": " + std::to_string(dataset.imu.size()) + " IMU samples, " +
              std::to_string(dataset.camera_stamps.size()) + " images");
  } else if (status.ok()) {
    const MeasurementLog log{dataset.rig, dataset.imu, dataset.frames, dataset.extra_cameras};
    PrintNote(FLAGS_output + ": " + DescribeLog(log, DigestOf(log)));
  }
  return Report(status);
}

}  // namespace alidade::cli
