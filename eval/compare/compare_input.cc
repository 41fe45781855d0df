#include "eval/compare/compare_input.h"

#include "eval/config/config_writer.h"
#include "eval/dataset/digest.h"
#include "eval/files/hash.h"
#include "eval/render/rendered_sequence.h"
#include "eval/simulation/simulator.h"
#include "eval/trajectory/trajectory_reader.h"

namespace alidade {

const Result<CompareInput::Data>& CompareInput::Acquire(const PipelineOptions& options) {
  if (!data_) {
    data_.emplace(Load(options));
  }
  return *data_;
}

Result<CompareInput::Data> CompareInput::Load(const PipelineOptions& options) const {
  return simulation_ ? RunSimulation(options) : LoadDataset(options);
}

Result<CompareInput::Data> CompareInput::LoadDataset(const PipelineOptions& options) const {
  Result<Dataset> dataset = ReadDataset(sequence_.dataset);
  if (!dataset.ok()) {
    return dataset.status();
  }
  Result<std::string> dataset_digest = DigestOf(sequence_.dataset);
  if (!dataset_digest.ok()) {
    return dataset_digest.status();
  }
  if (!sequence_.truth.empty()) {
    Result<Trajectory> truth = ReadTrajectory(sequence_.truth);
    if (!truth.ok()) {
      return truth.status();
    }
    dataset->truth = std::move(*truth);
  }
  std::vector<std::string> remarks = dataset->remarks;
  std::optional<FrontendSummary> frontend;
  if (dataset->frames.empty() && !dataset->images.empty()) {
    PipelineOptions telling = options;
    telling.remark = [&remarks](const std::string& text) { remarks.push_back(text); };
    Result<FrontendRun> run =
        RunFrontend(*dataset_digest, telling, [&](const PipelineOptions& with_statistics) {
          return TrackImages(*dataset, frontend_, with_statistics);
        });
    ALIDADE_RETURN_IF_ERROR(run.status());
    frontend = SummarizeFrontend(run->frames, run->statistics);
    dataset->frames = std::move(run->frames);
  }
  Result<MeasurementLog> log = MakeLog(*dataset, frontend_, options);
  if (!log.ok()) {
    return log.status();
  }
  std::string input_digest = DigestOf(*log);
  return Data{std::move(*log),         std::move(dataset->truth), std::move(*dataset_digest),
              std::move(input_digest), std::move(frontend),       std::nullopt,
              std::move(remarks)};
}

Result<FrontendRun> CompareInput::RunFrontend(
    const std::string& source, const PipelineOptions& options,
    const std::function<Result<std::vector<TrackFrame>>(const PipelineOptions&)>& make) const {
  FrontendConfig frontend = frontend_;
  const std::string whole =
      std::string(ALIDADE_VERSION) + "\n" +
      ConfigToYaml([&frontend](ConfigVisitor& visitor) { frontend.Describe(visitor); }, false) + source;
  if (cache_.reuse) {
    if (std::optional<FrontendRun> kept = ReadFrontendRun(whole, cache_.folder)) {
      return std::move(*kept);
    }
  }
  FrontendRun run;
  PipelineOptions with_statistics = options;
  with_statistics.statistics = &run.statistics;
  Result<std::vector<TrackFrame>> frames = make(with_statistics);
  ALIDADE_RETURN_IF_ERROR(frames.status());
  run.frames = std::move(*frames);
  if (!cache_.folder.empty()) {
    ALIDADE_RETURN_IF_ERROR(WriteFrontendRun(run, whole, cache_.folder));
  }
  return run;
}

Result<CompareInput::Data> CompareInput::RunSimulation(const PipelineOptions& options) const {
  Result<Simulation> simulation = SimulateWithMotion(*simulation_, seed_);
  ALIDADE_RETURN_IF_ERROR(simulation.status());
  Dataset* const dataset = &simulation->dataset;
  std::optional<FrontendSummary> frontend;
  if (simulation_->render.enabled) {
    Result<RenderedSequence> images = RenderedSequence::Create(*simulation_, *simulation, seed_);
    ALIDADE_RETURN_IF_ERROR(images.status());
    Result<FrontendRun> run =
        RunFrontend(images->Fingerprint(), options, [&](const PipelineOptions& with_statistics) {
          return TrackRenderedImages(*images, *dataset, frontend_, with_statistics);
        });
    ALIDADE_RETURN_IF_ERROR(run.status());
    frontend = SummarizeFrontend(run->frames, run->statistics);
    dataset->frames = std::move(run->frames);
  }
  Data data;
  data.frontend = std::move(frontend);
  data.truth = std::move(dataset->truth);
  data.true_rig = dataset->true_rig;
  data.log = MeasurementsOf(std::move(*dataset));
  SimulatorConfig config = *simulation_;
  data.dataset_digest =
      Sha256Hex(ConfigToYaml([&config](ConfigVisitor& visitor) { config.Describe(visitor); }, false) +
                "seed: " + std::to_string(seed_) + "\n");
  data.input_digest = DigestOf(data.log);
  return data;
}

}  // namespace alidade
