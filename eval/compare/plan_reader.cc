#include "eval/compare/plan_reader.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "eval/bag/dataset_source.h"
#include "eval/files/suggest.h"

namespace alidade {
namespace {

constexpr size_t kMaxSeeds = 1000;
constexpr long long kMaxSeed = 4294967295;
constexpr std::string_view kDataVariable = "${data}";

/// "a..b" with a <= b.
bool ParseRange(std::string_view text, long long* first, long long* last) {
  const size_t dots = text.find("..");
  if (dots == std::string_view::npos) {
    return false;
  }
  const auto parse = [](std::string_view digits, long long* value) {
    const char* end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, *value);
    return error == std::errc() && stop == end;
  };
  return parse(text.substr(0, dots), first) && parse(text.substr(dots + 2), last) && *first >= 0 &&
         *first <= *last && *last <= kMaxSeed;
}

bool IsFolderCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
         c == '-' || c == '+';
}

bool IsFolderName(const std::string& name) {
  return !name.empty() && name.front() != '.' && std::all_of(name.begin(), name.end(), IsFolderCharacter);
}

}  // namespace

PlanReader::PlanReader(std::string path, std::string data_root)
    : path_(std::move(path)), data_root_(std::move(data_root)) {}

Status PlanReader::Fault(const YAML::Node& node, const std::string& name, const std::string& expected) const {
  return Status::Config(YamlPlace(path_, node) + ": " + name + ": found " + YamlText(node) + ", expected " +
                        expected);
}

Status PlanReader::Map(const YAML::Node& node, const std::string& name, const std::vector<Key>& keys) const {
  if (!node.IsMap()) {
    return Fault(node, name, "keys and values");
  }
  std::vector<std::string> known;
  known.reserve(keys.size());
  for (const Key& key : keys) {
    known.push_back(key.name);
  }
  for (const auto& entry : node) {
    const std::string& found = entry.first.Scalar();
    const auto key = std::find_if(keys.begin(), keys.end(), [&](const Key& k) { return k.name == found; });
    if (key == keys.end()) {
      return Status::Config(YamlPlace(path_, entry.first) + ": " + found + ": unknown key in " + name +
                            Suggestion(found, known));
    }
    ALIDADE_RETURN_IF_ERROR(key->read(entry.second));
  }
  for (const Key& key : keys) {
    if (key.required && !node[key.name].IsDefined()) {
      return Status::Config(YamlPlace(path_, node) + ": " + key.name + ": missing in " + name);
    }
  }
  return Status::Ok();
}

Status PlanReader::Each(const YAML::Node& node, const std::string& name,
                        const std::function<Status(const YAML::Node&)>& read) const {
  if (!node.IsSequence() || node.size() == 0) {
    return Fault(node, name, "a list with at least one entry");
  }
  for (const YAML::Node& entry : node) {
    ALIDADE_RETURN_IF_ERROR(read(entry));
  }
  return Status::Ok();
}

Status PlanReader::Text(const YAML::Node& node, const std::string& name, std::string* value) const {
  if (!node.IsScalar() || node.Scalar().empty()) {
    return Fault(node, name, "text");
  }
  *value = node.Scalar();
  return Status::Ok();
}

Status PlanReader::FolderName(const YAML::Node& node, const std::string& name, std::string* value) const {
  ALIDADE_RETURN_IF_ERROR(Text(node, name, value));
  if (!IsFolderName(*value)) {
    return Fault(node, name, "letters, digits, '.', '_', '-' and '+' only: it names a folder of the output");
  }
  return Status::Ok();
}

Status PlanReader::CheckFolderName(const YAML::Node& node, const std::string& name,
                                   const std::string& derived) const {
  if (IsFolderName(derived)) {
    return Status::Ok();
  }
  return Fault(node, name,
               "a `name` beside it: '" + derived +
                   "', which follows from the path, is no name of a folder of the output (letters, digits, "
                   "'.', '_', '-' and '+', not starting with '.')");
}

Status PlanReader::SubstituteData(const YAML::Node& node, const std::string& name, std::string* text) const {
  const size_t variable = text->find(kDataVariable);
  if (variable != std::string::npos) {
    if (data_root_.empty()) {
      return Fault(node, name, "--data=FOLDER on the command line, which ${data} stands for");
    }
    text->replace(variable, kDataVariable.size(), data_root_);
  }
  return Status::Ok();
}

Status PlanReader::Path(const YAML::Node& node, const std::string& name, std::string* value) const {
  std::string text;
  ALIDADE_RETURN_IF_ERROR(Text(node, name, &text));
  ALIDADE_RETURN_IF_ERROR(SubstituteData(node, name, &text));
  // An absolute `text` replaces the folder.
  *value = (std::filesystem::path(path_).parent_path() / text).lexically_normal().string();
  return Status::Ok();
}

Status PlanReader::ExistingPath(const YAML::Node& node, const std::string& name, bool folder,
                                std::string* value) const {
  std::string resolved;
  ALIDADE_RETURN_IF_ERROR(Path(node, name, &resolved));
  std::error_code ignored;
  if (folder ? !IsDataset(resolved) : !std::filesystem::is_regular_file(resolved, ignored)) {
    return Fault(node, name,
                 std::string(folder ? "a folder" : "a file") + " that exists; " + resolved + " does not");
  }
  *value = resolved;
  return Status::Ok();
}

Status PlanReader::Real(const YAML::Node& node, const std::string& name, double min, double max,
                        double* value) const {
  if (const Status status = ParseYamlReal(node, value); !status.ok()) {
    return Fault(node, name, status.message());
  }
  if (*value < min || *value > max) {
    return Fault(node, name, "a number from " + std::to_string(min) + " to " + std::to_string(max));
  }
  return Status::Ok();
}

Status PlanReader::Boolean(const YAML::Node& node, const std::string& name, bool* value) const {
  const Status status = ParseYamlBoolean(node, value);
  return status.ok() ? status : Fault(node, name, status.message());
}

Status PlanReader::Either(const YAML::Node& node, const std::string& name, const std::string& first,
                          const std::string& second, bool* value) const {
  if (!node.IsScalar() || (node.Scalar() != first && node.Scalar() != second)) {
    return Fault(node, name, first + " or " + second);
  }
  *value = node.Scalar() == second;
  return Status::Ok();
}

Status PlanReader::AddSeed(const YAML::Node& node, const std::string& name,
                           std::vector<unsigned>* seeds) const {
  long long seed = 0;
  if (const Status status = ParseYamlInteger(node, &seed); !status.ok() || seed < 0 || seed > kMaxSeed) {
    return Fault(node, name, "a whole number from 0 to 4294967295");
  }
  if (std::find(seeds->begin(), seeds->end(), static_cast<unsigned>(seed)) != seeds->end()) {
    return Fault(node, name, "every seed once");
  }
  seeds->push_back(static_cast<unsigned>(seed));
  return Status::Ok();
}

Status PlanReader::Seeds(const YAML::Node& node, const std::string& name,
                         std::vector<unsigned>* seeds) const {
  seeds->clear();
  long long first = 0, last = 0;
  if (node.IsSequence()) {
    ALIDADE_RETURN_IF_ERROR(
        Each(node, name, [&](const YAML::Node& entry) { return AddSeed(entry, name, seeds); }));
  } else if (node.IsScalar() && ParseRange(node.Scalar(), &first, &last)) {
    for (long long seed = first; seed <= last && seeds->size() <= kMaxSeeds; ++seed) {
      seeds->push_back(static_cast<unsigned>(seed));
    }
  } else if (node.IsScalar() && node.Scalar().find("..") != std::string::npos) {
    return Fault(node, name, "a range FIRST..LAST of whole numbers, FIRST <= LAST");
  } else {
    ALIDADE_RETURN_IF_ERROR(AddSeed(node, name, seeds));
  }
  if (seeds->size() > kMaxSeeds) {
    return Fault(node, name, "at most " + std::to_string(kMaxSeeds) + " seeds");
  }
  return Status::Ok();
}

Status PlanReader::Settings(const YAML::Node& node, const std::string& name,
                            std::vector<std::string>* settings) const {
  if (!node.IsMap()) {
    return Fault(node, name, "keys and values, such as {filter.window: 10}");
  }
  for (const auto& entry : node) {
    const std::string& key = entry.first.Scalar();
    const YAML::Node& value = entry.second;
    if (value.IsScalar()) {
      std::string text = value.Scalar();
      ALIDADE_RETURN_IF_ERROR(SubstituteData(value, name + "." + key, &text));
      settings->push_back(key + "=" + text);
      continue;
    }
    std::vector<double> numbers;
    if (!ParseYamlReals(value, 0, &numbers).ok()) {
      return Fault(value, name + "." + key, "one value or a list of numbers");
    }
    std::string text;
    for (const YAML::Node& number : value) {
      text += (text.empty() ? "" : ", ") + number.Scalar();
    }
    settings->push_back(key + "=[" + text + "]");
  }
  return Status::Ok();
}

}  // namespace alidade
