#include "eval/compare/plan_parser.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "eval/bag/dataset_source.h"
#include "eval/compare/plan_check.h"
#include "eval/compare/plan_metrics.h"
#include "eval/compare/plan_reader.h"
#include "eval/comparison/paired.h"
#include "eval/files/suggest.h"

namespace alidade {
namespace {

constexpr double kMaxTimeoutS = 1e6;
constexpr double kMaxFigure = 1e12;

std::string Stem(const std::string& path) {
  return std::filesystem::path(path).stem().string();
}

/// The name of the folder that `path` leads to, also from "..".
std::string FolderOf(const std::string& path) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(path, error).lexically_normal();
  return (absolute.has_filename() ? absolute : absolute.parent_path()).filename().string();
}

/// Fills one Plan from its file, section by section.
class PlanParser {
 public:
  PlanParser(const std::string& path, const std::string& data_root) : reader_(path, data_root) {
    plan_.path = path;
  }

  Result<Plan> Parse(const YAML::Node& root) {
    // Before the sequences, wherever it stands.
    if (root.IsMap() && root["skip_missing"].IsDefined()) {
      ALIDADE_RETURN_IF_ERROR(reader_.Boolean(root["skip_missing"], "skip_missing", &plan_.skip_missing));
    }
    ALIDADE_RETURN_IF_ERROR(reader_.Map(
        root, "a plan",
        {{"title", [&](const YAML::Node& n) { return reader_.Text(n, "title", &plan_.title); }},
         {"estimators",
          [&](const YAML::Node& n) {
            return reader_.Each(n, "estimators", [&](const YAML::Node& e) { return AddEstimator(e); });
          },
          true},
         {"set", [&](const YAML::Node& n) { return reader_.Settings(n, "set", &plan_.settings); }},
         {"skip_missing", [](const YAML::Node&) { return Status::Ok(); }},
         {"sequences",
          [&](const YAML::Node& n) {
            return reader_.Each(n, "sequences", [&](const YAML::Node& e) { return AddSequence(e); });
          },
          true},
         {"metrics", [&](const YAML::Node& n) { return ReadMetrics(reader_, n, &plan_); }},
         {"pairs", [&](const YAML::Node& n) { return ReadPairs(n); }},
         {"baseline", [&](const YAML::Node& n) { return reader_.Text(n, "baseline", &plan_.baseline); }},
         {"audit", [&](const YAML::Node& n) { return reader_.Boolean(n, "audit", &plan_.audit); }},
         {"reference", [&](const YAML::Node& n) {
            return reader_.Each(n, "reference", [&](const YAML::Node& e) { return AddReference(e); });
          }}}));
    ALIDADE_RETURN_IF_ERROR(CheckPlan(plan_, root));
    if (plan_.title.empty()) {
      plan_.title = Stem(plan_.path);
    }
    return plan_;
  }

 private:
  using Node = YAML::Node;

  Status ReadEstimatorFields(const Node& node, PlanEstimator* estimator) {
    return reader_.Map(
        node, "estimators",
        {{"name", [&](const Node& n) { return reader_.FolderName(n, "name", &estimator->name); }},
         {"config",
          [&](const Node& n) { return reader_.ExistingPath(n, "config", false, &estimator->config); }},
         {"set", [&](const Node& n) { return reader_.Settings(n, "set", &estimator->settings); }},
         {"trajectories", [&](const Node& n) { return ReadTrajectories(n, &estimator->trajectories); }},
         {"command", [&](const Node& n) { return reader_.Text(n, "command", &estimator->command.text); }},
         {"program", [&](const Node& n) { return reader_.Path(n, "program", &estimator->command.program); }},
         {"result", [&](const Node& n) { return reader_.Text(n, "result", &estimator->command.result); }},
         {"timeout",
          [&](const Node& n) {
            return reader_.Real(n, "timeout", 1, kMaxTimeoutS, &estimator->command.timeout_s);
          }},
         {"frame",
          [&](const Node& n) {
            return reader_.Either(n, "frame", "body", "camera", &estimator->camera_frame);
          }},
         {"mode",
          [&](const Node& n) {
            return reader_.Either(n, "mode", "causal", "smoothed", &estimator->smoothed);
          }},
         {"sequences", [&](const Node& n) { return ReadNames(n, &estimator->sequences); }},
         {"align", [&](const Node& n) { return ReadAlignment(reader_, n, &estimator->alignment.emplace()); }},
         {"align_share",
          [&](const Node& n) { return ReadAlignShare(reader_, n, &estimator->align_share.emplace()); }}});
  }

  /// One source of estimates, and no entry that it does not take.
  [[nodiscard]] Status CheckEstimator(const Node& node, const PlanEstimator& estimator) const {
    const int sources = (estimator.config.empty() ? 0 : 1) + (estimator.trajectories.empty() ? 0 : 1) +
                        (estimator.command.text.empty() ? 0 : 1);
    if (sources != 1) {
      return reader_.Fault(node, "estimators", "one of `config`, `trajectories` and `command`");
    }
    if (estimator.external() && (estimator.name.empty() || !estimator.settings.empty())) {
      return reader_.Fault(node, "estimators", "`trajectories` or `command` with a `name` and without `set`");
    }
    if (!estimator.external() && node.IsMap() && node["mode"]) {
      return reader_.Fault(
          node["mode"], "mode",
          "`trajectories` or `command` beside it: the mode of a `config` follows from its back end");
    }
    if (estimator.command.text.empty() && !estimator.command.program.empty()) {
      return reader_.Fault(node, "estimators", "`program` only with `command`");
    }
    return Status::Ok();
  }

  Status AddEstimator(const Node& node) {
    PlanEstimator estimator;
    if (node.IsScalar()) {
      ALIDADE_RETURN_IF_ERROR(reader_.ExistingPath(node, "estimators", false, &estimator.config));
    } else {
      ALIDADE_RETURN_IF_ERROR(ReadEstimatorFields(node, &estimator));
    }
    ALIDADE_RETURN_IF_ERROR(CheckEstimator(node, estimator));
    if (estimator.name.empty()) {
      estimator.name = Stem(estimator.config);
      ALIDADE_RETURN_IF_ERROR(reader_.CheckFolderName(node, "estimators", estimator.name));
    }
    std::error_code ignored;
    if (!estimator.command.program.empty() &&
        !std::filesystem::is_regular_file(estimator.command.program, ignored)) {
      plan_.absent_programs.emplace_back(estimator.name, estimator.command.program);
      return Status::Ok();
    }
    return Add(node, "estimators", std::move(estimator), &plan_.estimators);
  }

  Status ReadTrajectories(const Node& node, std::map<std::string, std::string>* trajectories) {
    if (!node.IsMap()) {
      return reader_.Fault(node, "trajectories", "a mapping of sequence names to files");
    }
    for (const auto& entry : node) {
      const std::string& sequence = entry.first.Scalar();
      ALIDADE_RETURN_IF_ERROR(
          reader_.ExistingPath(entry.second, "trajectories." + sequence, false, &(*trajectories)[sequence]));
    }
    return Status::Ok();
  }

  Status ReadDatasetPath(const Node& node, std::string* path) {
    return plan_.skip_missing ? reader_.Path(node, "path", path)
                              : reader_.ExistingPath(node, "path", true, path);
  }

  Status ReadCalibration(const Node& node, std::vector<std::string>* files) {
    return reader_.Each(node, "calibration", [&](const Node& entry) {
      files->emplace_back();
      return reader_.Path(entry, "calibration", &files->back());
    });
  }

  Status ReadNames(const Node& node, std::vector<std::string>* names) {
    return reader_.Each(node, "sequences", [&](const Node& entry) {
      names->emplace_back();
      return reader_.Text(entry, "sequences", &names->back());
    });
  }

  Status AddSequence(const Node& node) {
    PlanSequence sequence;
    ALIDADE_RETURN_IF_ERROR(reader_.Map(
        node, "sequences",
        {{"name", [&](const Node& n) { return reader_.FolderName(n, "name", &sequence.name); }},
         {"path", [&](const Node& n) { return ReadDatasetPath(n, &sequence.dataset.path); }},
         {"topics", [&](const Node& n) { return reader_.Text(n, "topics", &sequence.dataset.topics); }},
         {"calibration", [&](const Node& n) { return ReadCalibration(n, &sequence.dataset.calibration); }},
         {"camera", [&](const Node& n) { return reader_.Text(n, "camera", &sequence.dataset.camera); }},
         {"follow_links",
          [&](const Node& n) { return reader_.Boolean(n, "follow_links", &sequence.dataset.follow_links); }},
         {"truth", [&](const Node& n) { return reader_.ExistingPath(n, "truth", false, &sequence.truth); }},
         {"config",
          [&](const Node& n) { return reader_.ExistingPath(n, "config", false, &sequence.config); }},
         {"seeds", [&](const Node& n) { return reader_.Seeds(n, "seeds", &sequence.seeds); }},
         {"group", [&](const Node& n) { return reader_.Text(n, "group", &sequence.group); }},
         {"anchor_at_first",
          [&](const Node& n) {
            return reader_.Boolean(n, "anchor_at_first", &sequence.anchor_at_first.emplace());
          }},
         {"set", [&](const Node& n) { return reader_.Settings(n, "set", &sequence.settings); }},
         {"estimator_set", [&](const Node& n) {
            return reader_.Settings(n, "estimator_set", &sequence.estimator_settings);
          }}}));
    ALIDADE_RETURN_IF_ERROR(CheckSequenceKeys(reader_, node, sequence));
    const std::string& path = sequence.dataset.path;
    if (sequence.name.empty()) {
      sequence.name = path.empty()               ? Stem(sequence.config)
                      : FormatOf(path).is_file() ? Stem(path)
                                                 : FolderOf(path);
      ALIDADE_RETURN_IF_ERROR(reader_.CheckFolderName(node, "sequences", sequence.name));
    }
    if (!path.empty() && !IsDataset(path)) {
      plan_.absent.emplace_back(sequence.name, sequence.dataset.path);
      return Status::Ok();
    }
    return Add(node, "sequences", std::move(sequence), &plan_.sequences);
  }

  Status ReadPairs(const Node& node) {
    return reader_.Map(
        node, "pairs",
        {{"figures",
          [&](const Node& n) {
            plan_.pair_figures.clear();
            return reader_.Each(n, "figures", [&](const Node& entry) { return AddPairFigure(entry); });
          }},
         {"across_sequences",
          [&](const Node& n) { return reader_.Boolean(n, "across_sequences", &plan_.pair_across); }}});
  }

  Status AddPairFigure(const Node& node) {
    std::string key;
    ALIDADE_RETURN_IF_ERROR(reader_.Text(node, "figures", &key));
    std::vector<std::string> known;
    for (const Figure& figure : ListFigures(Comparison())) {
      if (IsPaired(figure)) {
        known.push_back(figure.key);
      }
    }
    if (!key.starts_with("rpe_") && std::find(known.begin(), known.end(), key) == known.end()) {
      return reader_.Fault(node, "figures",
                           "a column of summary.csv that is not a time" + Suggestion(key, known));
    }
    plan_.pair_figures.push_back(key);
    return Status::Ok();
  }

  Status AddReference(const Node& node) {
    ReferenceFigure reference;
    ALIDADE_RETURN_IF_ERROR(reader_.Map(
        node, "reference",
        {{"source", [&](const Node& n) { return reader_.Text(n, "source", &reference.source); }, true},
         {"estimator", [&](const Node& n) { return reader_.Text(n, "estimator", &reference.estimator); },
          true},
         {"sequence", [&](const Node& n) { return reader_.Text(n, "sequence", &reference.sequence); }, true},
         {"figures", [&](const Node& n) { return ReadFigures(n, &reference.figures); }, true}}));
    plan_.references.push_back(std::move(reference));
    return Status::Ok();
  }

  Status ReadFigures(const Node& node, std::map<std::string, double>* figures) {
    if (!node.IsMap()) {
      return reader_.Fault(node, "figures", "a mapping of summary.csv columns to numbers");
    }
    for (const auto& entry : node) {
      const std::string& column = entry.first.Scalar();
      ALIDADE_RETURN_IF_ERROR(
          reader_.Real(entry.second, "figures." + column, -kMaxFigure, kMaxFigure, &(*figures)[column]));
    }
    return Status::Ok();
  }

  template <typename Entry>
  Status Add(const Node& node, const std::string& section, Entry entry, std::vector<Entry>* entries) {
    for (const Entry& other : *entries) {
      if (other.name == entry.name) {
        return reader_.Fault(node, section,
                             "a name that no other entry has; `name: " + entry.name + "` is taken");
      }
    }
    entries->push_back(std::move(entry));
    return Status::Ok();
  }

  PlanReader reader_;
  Plan plan_;
};

}  // namespace

Result<Plan> ReadPlan(const std::string& path, const std::string& data_root) {
  Result<YAML::Node> root = ParseYamlFile(path, StatusCode::kConfig);
  if (!root.ok()) {
    return root.status();
  }
  return PlanParser(path, data_root).Parse(*root);
}

}  // namespace alidade
