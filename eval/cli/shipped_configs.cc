#include "eval/cli/shipped_configs.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "eval/files/suggest.h"

namespace alidade::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kConfigs = "configs";
constexpr std::string_view kSuffix = ".yaml";

bool IsFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

fs::path FolderOf(ConfigKind kind) {
  switch (kind) {
    case ConfigKind::kSimulator:
      return "datasets";
    case ConfigKind::kPlan:
      return "plans";
    case ConfigKind::kEstimator:
      break;
  }
  return "estimators";
}

/// Where the data folder may be, relative to the program's own.
std::vector<fs::path> DataFolders() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  return {(program / ALIDADE_DATA_FROM_PROGRAM).lexically_normal(), program.parent_path()};
}

}  // namespace

std::optional<ConfigKind> ParseConfigKind(std::string_view name) {
  for (const ConfigKind kind : {ConfigKind::kEstimator, ConfigKind::kSimulator, ConfigKind::kPlan}) {
    if (name == ToString(kind)) {
      return kind;
    }
  }
  return std::nullopt;
}

std::string_view ToString(ConfigKind kind) {
  switch (kind) {
    case ConfigKind::kSimulator:
      return "simulator";
    case ConfigKind::kPlan:
      return "plan";
    case ConfigKind::kEstimator:
      break;
  }
  return "estimator";
}

Result<std::string> ShippedConfigsFolder() {
  const char* named = std::getenv("ALIDADE_DATA_DIR");
  const bool is_named = named != nullptr && *named != '\0';
  const std::vector<fs::path> folders = is_named ? std::vector<fs::path>{named} : DataFolders();
  std::string tried;
  for (const fs::path& folder : folders) {
    if (IsFile(folder / kConfigs / "base.yaml")) {
      return (folder / kConfigs).string();
    }
    tried += (tried.empty() ? "" : " or ") + folder.string();
  }
  return Status::Config("no configs/base.yaml in " + tried + ", expected the shipped configurations there" +
                        (is_named ? " (ALIDADE_DATA_DIR)" : " or in ALIDADE_DATA_DIR"));
}

Result<std::vector<std::string>> ShippedConfigs(ConfigKind kind) {
  const Result<std::string> configs = ShippedConfigsFolder();
  ALIDADE_RETURN_IF_ERROR(configs.status());
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(*configs / FolderOf(kind), ignored)) {
    if (entry.path().extension() == kSuffix) {
      names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

Result<std::string> LocateConfig(ConfigKind kind, const std::string& text) {
  const fs::path path = text;
  std::error_code ignored;
  const bool is_there = fs::exists(path, ignored) && !fs::is_directory(path, ignored);
  if (text.empty() || path.is_absolute() || is_there) {
    return text;
  }
  const Result<std::string> configs = ShippedConfigsFolder();
  const bool is_path = path.has_parent_path();
  if (!configs.ok()) {
    return is_path ? Result<std::string>(text) : configs.status();
  }
  if (is_path) {
    const fs::path shipped = fs::path(*configs).parent_path() / path;
    return path.begin()->string() == kConfigs && IsFile(shipped) ? shipped.string() : text;
  }
  const std::string name = text.ends_with(kSuffix) ? path.stem().string() : text;
  const fs::path file = *configs / FolderOf(kind) / (name + std::string(kSuffix));
  if (IsFile(file)) {
    return file.string();
  }
  const Result<std::vector<std::string>> names = ShippedConfigs(kind);
  ALIDADE_RETURN_IF_ERROR(names.status());
  return Status::Config(text + ": found neither such a file nor a shipped " + std::string(ToString(kind)) +
                        " of that name" + Suggestion(name, *names) +
                        " (alidade config --list --kind=" + std::string(ToString(kind)) + " lists them)");
}

}  // namespace alidade::cli
