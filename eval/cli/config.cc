#include <cstdio>
#include <nlohmann/json.hpp>

#include "eval/cli/commands.h"
#include "eval/cli/flags.h"
#include "eval/cli/shipped_configs.h"
#include "eval/cli/support.h"
#include "eval/compare/plan_parser.h"
#include "eval/config/config_json.h"
#include "eval/config/config_writer.h"
#include "eval/config/config_yaml.h"
#include "eval/simulation/simulator_config.h"

namespace alidade::cli {
namespace {

using Describe = std::function<void(ConfigVisitor&)>;

/// A configuration of either kind, read and valid; hands its keys to `use`.
Status WithConfig(const std::string& path, const std::function<void(const Describe&)>& use) {
  if (FLAGS_kind == "simulator") {
    Result<SimulatorConfig> config = LoadSimulatorConfig(path, SplitSettings(FLAGS_set));
    if (config.ok()) {
      use([&config](ConfigVisitor& visitor) { config->Describe(visitor); });
    }
    return config.status();
  }
  Result<EstimatorConfig> config = LoadEstimatorConfig(path, SplitSettings(FLAGS_set));
  if (config.ok()) {
    use([&config](ConfigVisitor& visitor) { config->Describe(visitor); });
  }
  return config.status();
}

Status Show(const std::string& path) {
  return WithConfig(
      path, [](const Describe& describe) { std::fputs(ConfigToYaml(describe, true).c_str(), stdout); });
}

Status List(ConfigKind kind) {
  const Result<std::vector<std::string>> names = ShippedConfigs(kind);
  ALIDADE_RETURN_IF_ERROR(names.status());
  for (const std::string& name : *names) {
    std::printf("%s\n", name.c_str());
  }
  return Status::Ok();
}

Status Check(const std::string& path) {
  if (FLAGS_kind == "plan") {
    return ReadPlan(path, FLAGS_data).status();
  }
  return WithConfig(path, [](const Describe&) {});
}

/// "key: a -> b" for every key in which the resolved configurations differ.
Status Diff(const std::string& path, const std::string& other_path) {
  nlohmann::ordered_json first, second;
  ALIDADE_RETURN_IF_ERROR(
      WithConfig(path, [&first](const Describe& d) { first = ConfigToJson(d).flatten(); }));
  ALIDADE_RETURN_IF_ERROR(
      WithConfig(other_path, [&second](const Describe& d) { second = ConfigToJson(d).flatten(); }));
  for (const auto& [pointer, value] : first.items()) {
    const nlohmann::ordered_json& other = second[pointer];
    if (value != other) {
      std::string key = pointer.substr(1);
      std::replace(key.begin(), key.end(), '/', '.');
      std::printf("%s: %s -> %s\n", key.c_str(), value.dump().c_str(), other.dump().c_str());
    }
  }
  return Status::Ok();
}

}  // namespace

int RunConfig(const std::vector<std::string>& words) {
  const size_t wanted = FLAGS_list ? 0 : FLAGS_diff ? 2 : 1;
  const int actions = static_cast<int>(FLAGS_show) + static_cast<int>(FLAGS_check) +
                      static_cast<int>(FLAGS_diff) + static_cast<int>(FLAGS_list);
  if (actions != 1 || words.size() != wanted) {
    return Report(Status::Usage(
        "config: expected --show FILE, --check FILE, --diff FILE FILE2 or --list without a file"));
  }
  const std::optional<ConfigKind> kind = ParseConfigKind(FLAGS_kind);
  const bool plan_is_fine = FLAGS_check || FLAGS_list;
  if (!kind || (*kind == ConfigKind::kPlan && !plan_is_fine)) {
    return Report(Status::Usage("config: --kind: found '" + FLAGS_kind + "', expected estimator, simulator" +
                                (plan_is_fine ? " or plan" : "; a plan supports only --check and --list")));
  }
  if (FLAGS_list) {
    return Report(List(*kind));
  }
  std::vector<std::string> files;
  for (const std::string& word : words) {
    const Result<std::string> file = LocateConfig(*kind, word);
    if (!file.ok()) {
      return Report(file.status());
    }
    files.push_back(*file);
  }
  const Status status = FLAGS_show    ? Show(files[0])
                        : FLAGS_check ? Check(files[0])
                                      : Diff(files[0], files[1]);
  if (status.ok() && FLAGS_check) {
    std::printf("%s: no faults\n", files[0].c_str());
  }
  return Report(status);
}

}  // namespace alidade::cli
