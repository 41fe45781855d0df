#include "eval/compare/plan_check.h"

#include <algorithm>

#include "eval/bag/dataset_source.h"
#include "eval/files/suggest.h"

namespace alidade {
namespace {

std::vector<std::string> SequenceNames(const Plan& plan) {
  std::vector<std::string> names;
  for (const PlanSequence& sequence : plan.sequences) {
    names.push_back(sequence.name);
  }
  for (const auto& [name, path] : plan.absent) {
    names.push_back(name);
  }
  return names;
}

Status CheckAnyThere(const Plan& plan) {
  if (plan.estimators.empty()) {
    return Status::Input(plan.path + ": none of its " + std::to_string(plan.absent_programs.size()) +
                         " estimators can be run; the program of the first, " +
                         plan.absent_programs.front().first + ", was expected as " +
                         plan.absent_programs.front().second);
  }
  return !plan.sequences.empty()
             ? Status::Ok()
             : Status::Input(plan.path + ": none of its " + std::to_string(plan.absent.size()) +
                             " sequences is present; the first, " + plan.absent.front().first +
                             ", was expected as the folder " + plan.absent.front().second);
}

Status CheckBaseline(const Plan& plan, const YAML::Node& root) {
  const std::vector<std::string> names = SequenceNames(plan);
  const bool known = std::find(names.begin(), names.end(), plan.baseline) != names.end();
  return plan.baseline.empty() || known
             ? Status::Ok()
             : Status::Config(YamlPlace(plan.path, root["baseline"]) + ": baseline: " + plan.baseline +
                              ": no such sequence" + Suggestion(plan.baseline, names));
}

/// A name that no sequence has would be left out silently.
Status CheckSequenceNames(const Plan& plan, const YAML::Node& root) {
  const std::vector<std::string> names = SequenceNames(plan);
  for (const PlanEstimator& estimator : plan.estimators) {
    std::vector<std::pair<std::string, std::string>> used;
    for (const auto& [sequence, path] : estimator.trajectories) {
      used.emplace_back("trajectories", sequence);
    }
    for (const std::string& sequence : estimator.sequences) {
      used.emplace_back("sequences", sequence);
    }
    for (const auto& [key, sequence] : used) {
      if (std::find(names.begin(), names.end(), sequence) == names.end()) {
        return Status::Config(YamlPlace(plan.path, root["estimators"]) + ": " + estimator.name + "." + key +
                              "." + sequence + ": no such sequence" + Suggestion(sequence, names));
      }
    }
  }
  return Status::Ok();
}

}  // namespace

Status CheckPlan(const Plan& plan, const YAML::Node& root) {
  ALIDADE_RETURN_IF_ERROR(CheckSequenceNames(plan, root));
  ALIDADE_RETURN_IF_ERROR(CheckBaseline(plan, root));
  return CheckAnyThere(plan);
}

Status CheckSequenceKeys(const PlanReader& reader, const YAML::Node& node, const PlanSequence& sequence) {
  const bool is_dataset = !sequence.dataset.path.empty();
  if (is_dataset == !sequence.config.empty()) {
    return reader.Fault(node, "sequences", "either `path` of a dataset or `config` of a simulation");
  }
  if (is_dataset && !sequence.settings.empty()) {
    return reader.Fault(node, "sequences", "`set` only with `config`: a dataset has no settings");
  }
  if (!is_dataset && !sequence.truth.empty()) {
    return reader.Fault(node, "sequences", "`truth` only with `path`: a simulation has its own");
  }
  const DatasetFormat* const format = is_dataset ? &FormatOf(sequence.dataset.path) : nullptr;
  if ((node["topics"] || node["calibration"] || node["camera"]) &&
      !(format != nullptr && format->takes_topics)) {
    return reader.Fault(node, "sequences",
                        "`topics`, `calibration` and `camera` only with the `path` of " +
                            FormatsWith(&DatasetFormat::takes_topics));
  }
  if (sequence.dataset.follow_links && !(format != nullptr && format->is_asl)) {
    return reader.Fault(node, "sequences",
                        "`follow_links` only with the `path` of " + FormatsWith(&DatasetFormat::is_asl));
  }
  return Status::Ok();
}

}  // namespace alidade
