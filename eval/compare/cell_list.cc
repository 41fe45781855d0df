#include "eval/compare/cell_list.h"

#include <filesystem>

#include "core/format.h"
#include "eval/config/config_writer.h"
#include "eval/files/hash.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
#include "eval/record/recorder.h"
#include "eval/run/make_estimator.h"

namespace alidade {
namespace {

/// What the front end makes of an input is kept, and used again by whoever runs another cell of it: Compare
/// removes what is older.
FrontendCache CacheOf(const PlanSequence& sequence, unsigned seed, const std::string& output) {
  return {output + "/logs/" + sequence.name + "/" + std::to_string(seed), true};
}

std::string Line(const std::string& text) {
  return text + "\n";
}

/// However the plan was named and from wherever the stage runs.
std::string Absolute(const std::string& path) {
  std::error_code ignored;
  return path.empty() ? path : std::filesystem::absolute(path, ignored).lexically_normal().string();
}

std::string EstimatorText(const PlanEstimator& estimator, const PlanSequence& sequence,
                          const EstimatorConfig* config) {
  if (config != nullptr) {
    return Line(DigestOf(*config));
  }
  const auto trajectory = estimator.trajectories.find(sequence.name);
  return Line(estimator.command.text) + Line(Absolute(estimator.command.program)) +
         Line(estimator.command.result) +
         Line(trajectory == estimator.trajectories.end() ? "" : Absolute(trajectory->second)) +
         (estimator.camera_frame ? "camera " : "") + (estimator.smoothed ? "smoothed\n" : "\n");
}

/// `simulation`: its configuration in full; empty for a dataset.
std::string SequenceText(const PlanSequence& sequence, const std::string& simulation) {
  const DatasetSource& source = sequence.dataset;
  std::string text = Line(Absolute(source.path)) + Line(source.topics) + Line(source.camera) +
                     Line(Absolute(sequence.truth));
  for (const std::string& file : source.calibration) {
    text += Line(Absolute(file));
  }
  return text + Line(simulation);
}

std::string SimulationText(SimulatorConfig config) {
  for (std::string* path : {&config.trajectory_file, &config.hybrid_dataset, &config.gnss.navigation_file}) {
    *path = *path == kNoPath ? *path : Absolute(*path);
  }
  return ConfigToYaml([&config](ConfigVisitor& visitor) { config.Describe(visitor); }, false);
}

std::string MetricsText(const EvaluationOptions& metrics) {
  std::string text =
      Format("%d %.17g %d %.17g %.17g %d %.17g %d", static_cast<int>(metrics.alignment), metrics.align_share,
             static_cast<int>(metrics.association.method), metrics.association.max_dt_s,
             metrics.association.time_offset_s, metrics.association.interpolate ? 1 : 0,
             metrics.association.max_gap_s, metrics.anchor_at_first ? 1 : 0);
  for (const double distance_m : metrics.rpe_distances_m) {
    text += Format(" %.17g", distance_m);
  }
  return Line(text);
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

Status CellList::WriteTable(const std::string& output) const {
  std::string table = "estimator,sequence,seed\n";
  for (const CompareCell& cell : cells_) {
    table += cell.result.estimator + "," + cell.result.sequence + "," + std::to_string(cell.seed) + "\n";
  }
  const std::string file = output + "/cells.csv";
  const Result<std::string> earlier =
      MayExist(file) ? ReadWholeFile(file) : Result<std::string>(Status::Input("none"));
  return earlier.ok() && *earlier == table ? Status::Ok() : WriteFileAtomically(file, table);
}

Status CellList::AddDataset(const Plan& plan, const PlanSequence& sequence, const std::string& output) {
  FrontendConfig frontend;
  const bool tracks = MayExist(sequence.dataset.path + "/mav0/cam0/tracks.csv");
  if (!tracks) {
    ALIDADE_RETURN_IF_ERROR(configs_.CommonFrontend(sequence, &frontend));
  }
  inputs_.push_back(
      std::make_unique<CompareInput>(sequence, frontend, CacheOf(sequence, 0, output), !tracks));
  DigestCells(plan, sequence, "");
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
  DigestCells(plan, sequence, SimulationText(*config));
  for (const unsigned seed : sequence.seeds) {
    inputs_.push_back(
        std::make_unique<CompareInput>(sequence, *config, seed, frontend, CacheOf(sequence, seed, output)));
    AddCells(plan, sequence, seed, output);
  }
  return Status::Ok();
}

void CellList::DigestCells(const Plan& plan, const PlanSequence& sequence, const std::string& simulation) {
  digests_.clear();
  for (size_t i = 0; i < plan.estimators.size(); ++i) {
    const PlanEstimator& estimator = plan.estimators[i];
    const EstimatorConfig* config =
        estimator.external() || !estimator.RunsOn(sequence.name) ? nullptr : configs_.Of(sequence, i);
    digests_.push_back(
        Sha256Hex(EstimatorText(estimator, sequence, config) + SequenceText(sequence, simulation) +
                  MetricsText(plan.MetricsOf(estimator, sequence)) + (plan.audit ? "audit" : "")));
  }
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
    cell.digest = digests_[i];
    cell.result.estimator = estimator.name;
    cell.result.backend = estimator.external() ? "external" : std::string(ToString(config->backend));
    cell.result.smoothed = estimator.external() ? estimator.smoothed : config->backend == Backend::kBatch;
    cell.result.sequence = sequence.name;
    cell.result.seed = seed;
    cells_.push_back(std::move(cell));
  }
}

}  // namespace alidade
