#include "eval/compare/cell_list.h"

#include "eval/files/input_file.h"
#include "eval/run/make_estimator.h"

namespace alidade {
namespace {

/// What the front end makes of an input is kept, and used again by whoever runs another cell of it: Compare
/// removes what is older.
FrontendCache CacheOf(const PlanSequence& sequence, unsigned seed, const std::string& output) {
  return {output + "/logs/" + sequence.name + "/" + std::to_string(seed), true};
}

}  // namespace

Status CellList::Make(const Plan& plan, const CompareOptions& options) {
  ALIDADE_RETURN_IF_ERROR(configs_.Load(plan));
  for (const PlanSequence& sequence : plan.sequences) {
    ALIDADE_RETURN_IF_ERROR(sequence.dataset.path.empty() ? AddSimulation(plan, sequence, options.output)
                                                          : AddDataset(plan, sequence, options.output));
  }
  return Status::Ok();
}

Status CellList::AddDataset(const Plan& plan, const PlanSequence& sequence, const std::string& output) {
  FrontendConfig frontend;
  const bool tracks = MayExist(sequence.dataset.path + "/mav0/cam0/tracks.csv");
  if (!tracks) {
    ALIDADE_RETURN_IF_ERROR(configs_.CommonFrontend(sequence, &frontend));
  }
  inputs_.push_back(
      std::make_unique<CompareInput>(sequence, frontend, CacheOf(sequence, 0, output), !tracks));
  for (const unsigned seed : sequence.seeds) {
    AddCells(plan, sequence, seed, output);
  }
  return Status::Ok();
}

Status CellList::AddSimulation(const Plan& plan, const PlanSequence& sequence, const std::string& output) {
  const Result<SimulatorConfig> config = LoadSimulatorConfig(sequence.config, sequence.settings);
  if (!config.ok()) {
    return Status(config.code(), "sequence " + sequence.name + ": " + config.message());
  }
  FrontendConfig frontend;
  if (config->render.enabled) {
    ALIDADE_RETURN_IF_ERROR(configs_.CommonFrontend(sequence, &frontend));
  }
  for (const unsigned seed : sequence.seeds) {
    inputs_.push_back(
        std::make_unique<CompareInput>(sequence, *config, seed, frontend, CacheOf(sequence, seed, output)));
    AddCells(plan, sequence, seed, output);
  }
  return Status::Ok();
}

void CellList::AddCells(const Plan& plan, const PlanSequence& sequence, unsigned seed,
                        const std::string& output) {
  for (size_t i = 0; i < plan.estimators.size(); ++i) {
    const PlanEstimator& estimator = plan.estimators[i];
    if (!estimator.RunsOn(sequence.name)) {
      continue;
    }
    const EstimatorConfig* config = configs_.Of(sequence, i);
    CompareCell cell;
    cell.estimator = &estimator;
    cell.config = config;
    cell.sequence = &sequence;
    cell.input = inputs_.back().get();
    cell.seed = seed;
    const std::string place = estimator.name + "/" + sequence.name + "/" + std::to_string(seed);
    cell.folder = output + "/cells/" + place;
    cell.report_file = output + "/scores/" + place + ".cbor";
    cell.result.estimator = estimator.name;
    cell.result.backend = estimator.external() ? "external" : std::string(ToString(config->backend));
    cell.result.smoothed = estimator.external() ? estimator.smoothed : config->backend == Backend::kBatch;
    cell.result.sequence = sequence.name;
    cell.result.seed = seed;
    cells_.push_back(std::move(cell));
  }
}

}  // namespace alidade
