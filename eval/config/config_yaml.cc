#include "eval/config/config_yaml.h"

#include <cmath>
#include <filesystem>

#include "eval/config/config_keys.h"
#include "eval/files/csv.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
#include "eval/files/strict_yaml.h"
#include "eval/files/suggest.h"

namespace alidade {
namespace {

constexpr int kMaxBaseDepth = 8;

/// Every key of the file is in the schema, and groups are where groups belong.
Status CheckKnown(const YAML::Node& map, const std::string& prefix, const std::string& where,
                  const ConfigKeys& schema) {
  for (const auto& entry : map) {
    const YAML::Node& key = entry.first;
    const YAML::Node& value = entry.second;
    const std::string path = JoinKey(prefix, key.Scalar());
    if (prefix.empty() && path == "base") {
      continue;
    }
    if (schema.IsSection(path)) {
      if (!value.IsMap()) {
        return Status::Config(YamlPlace(where, key) + ": " + path + ": found " + YamlText(value) +
                              ", expected a group of keys");
      }
      ALIDADE_RETURN_IF_ERROR(CheckKnown(value, path, where, schema));
    } else if (!schema.IsKey(path)) {
      return Status::Config(YamlPlace(where, key) + ": " + path + ": unknown key" + schema.Hint(path));
    }
  }
  return Status::Ok();
}

/// Sets every described value whose key is in the tree; keeps the first fault.
class TreeReader final : public ConfigVisitor {
 public:
  TreeReader(const YAML::Node& root, std::string where) : node_(root), where_(std::move(where)) {}

  [[nodiscard]] const Status& status() const { return fault_; }

  void Section(std::string_view name, std::string_view, const std::function<void()>& keys) override {
    const YAML::Node inner = Find(name);
    if (!inner.IsDefined()) {
      return;
    }
    const YAML::Node outer = node_;
    const std::string outer_prefix = prefix_;
    node_.reset(inner);
    prefix_ = JoinKey(prefix_, name);
    keys();
    node_.reset(outer);
    prefix_ = outer_prefix;
  }

  void Real(const KeyDoc& doc, double* value, double min, double max) override {
    const YAML::Node node = Find(doc.name);
    double parsed = 0;
    if (!node.IsDefined() || !Accept(ParseYamlReal(node, &parsed), doc, node)) {
      return;
    }
    if (parsed < min || parsed > max) {
      Fail(doc, node, "a number in [" + ShortestDouble(min) + ", " + ShortestDouble(max) + "]" + Unit(doc));
      return;
    }
    *value = parsed;
  }

  void Integer(const KeyDoc& doc, int* value, int min, int max) override {
    const YAML::Node node = Find(doc.name);
    long long parsed = 0;
    if (!node.IsDefined() || !Accept(ParseYamlInteger(node, &parsed), doc, node)) {
      return;
    }
    if (parsed < min || parsed > max) {
      Fail(doc, node, "an integer in [" + std::to_string(min) + ", " + std::to_string(max) + "]" + Unit(doc));
      return;
    }
    *value = static_cast<int>(parsed);
  }

  void Boolean(const KeyDoc& doc, bool* value) override {
    const YAML::Node node = Find(doc.name);
    if (node.IsDefined()) {
      Accept(ParseYamlBoolean(node, value), doc, node);
    }
  }

  void Text(const KeyDoc& doc, std::string* value) override {
    const YAML::Node node = Find(doc.name);
    if (!node.IsDefined()) {
      return;
    }
    if (!node.IsScalar() || node.Scalar().empty()) {
      Fail(doc, node, "a text");
      return;
    }
    *value = node.Scalar();
  }

  void Vector3(const KeyDoc& doc, Eigen::Vector3d* value, double min, double max) override {
    const YAML::Node node = Find(doc.name);
    std::vector<double> parsed;
    if (!node.IsDefined() || !Accept(ParseYamlReals(node, 3, &parsed), doc, node)) {
      return;
    }
    for (const double entry : parsed) {
      if (entry < min || entry > max) {
        Fail(doc, node,
             "three numbers in [" + ShortestDouble(min) + ", " + ShortestDouble(max) + "]" + Unit(doc) +
                 ", one is " + ShortestDouble(entry));
        return;
      }
    }
    *value = Eigen::Vector3d(parsed[0], parsed[1], parsed[2]);
  }

  void Choice(const KeyDoc& doc, const std::vector<std::string_view>& options, int* index) override {
    const YAML::Node node = Find(doc.name);
    if (!node.IsDefined()) {
      return;
    }
    std::vector<std::string> names;
    std::string list;
    for (const std::string_view option : options) {
      if (node.IsScalar() && node.Scalar() == option) {
        *index = static_cast<int>(names.size());
        return;
      }
      names.emplace_back(option);
      list += (list.empty() ? "" : ", ") + std::string(option);
    }
    Fail(doc, node, "one of " + list + (node.IsScalar() ? Suggestion(node.Scalar(), names) : ""));
  }

 private:
  /// The child of that name; an undefined node when there is none. Const, so that a look never inserts.
  [[nodiscard]] YAML::Node Find(std::string_view name) const { return node_[std::string(name)]; }

  [[nodiscard]] static std::string Unit(const KeyDoc& doc) {
    return doc.unit == "-" ? std::string() : " " + std::string(doc.unit);
  }

  bool Accept(const Status& parsed, const KeyDoc& doc, const YAML::Node& node) {
    if (!parsed.ok()) {
      Fail(doc, node, parsed.message());
    }
    return parsed.ok();
  }

  void Fail(const KeyDoc& doc, const YAML::Node& node, const std::string& expected) {
    if (fault_.ok()) {
      fault_ = Status::Config(YamlPlace(where_, node) + ": " + JoinKey(prefix_, doc.name) + ": found " +
                              YamlText(node) + ", expected " + expected);
    }
  }

  YAML::Node node_;
  std::string where_;
  std::string prefix_;
  Status fault_;
};

Status ApplyTree(const YAML::Node& root, const std::string& where, const ConfigKeys& schema,
                 const std::function<void(ConfigVisitor&)>& describe) {
  ALIDADE_RETURN_IF_ERROR(CheckKnown(root, "", where, schema));
  TreeReader reader(root, where);
  describe(reader);
  return reader.status();
}

Status ReadConfigLayer(const std::string& path, int depth, const ConfigKeys& schema,
                       const std::function<void(ConfigVisitor&)>& describe) {
  const Result<YAML::Node> root = ParseYamlFile(path, StatusCode::kConfig);
  if (!root.ok()) {
    return root.status();
  }
  const YAML::Node& map = *root;
  if (const YAML::Node base = map["base"]; base.IsDefined()) {
    if (!base.IsScalar() || base.Scalar().empty()) {
      return Status::Config(YamlPlace(path, base) + ": base: found " + YamlText(base) +
                            ", expected a file name");
    }
    if (depth >= kMaxBaseDepth) {
      return Status::Config(YamlPlace(path, base) + ": base: " + Quoted(base.Scalar()) +
                            " is the ninth nested base file, expected no cycle");
    }
    const std::filesystem::path file = std::filesystem::path(path).parent_path() / base.Scalar();
    if (!MayExist(file.string())) {
      return Status::Config(YamlPlace(path, base) + ": base: no file " + file.lexically_normal().string() +
                            ", expected a path relative to this file");
    }
    ALIDADE_RETURN_IF_ERROR(ReadConfigLayer(file.lexically_normal().string(), depth + 1, schema, describe));
  }
  return ApplyTree(map, path, schema, describe);
}

/// "a.b=value" as a tree {a: {b: value}}. A value in brackets is a list; any other is one scalar, whatever
/// its letters.
Result<YAML::Node> SettingTree(const std::string& setting, const std::string& where, std::string* key) {
  const size_t equals = setting.find('=');
  if (equals == std::string::npos || equals == 0) {
    return Status::Config(where + ": expected KEY=VALUE, as in filter.window=20");
  }
  *key = setting.substr(0, equals);
  const std::string text = setting.substr(equals + 1);
  YAML::Node value(text);
  if (text.starts_with('[')) {
    const Result<YAML::Node> list = LoadYaml(text, "value", StatusCode::kConfig);
    if (!list.ok()) {
      return Status::Config(where + ": " + *key + ": is not a list: " + list.message());
    }
    value.reset(*list);
  }
  std::string path = *key;
  while (true) {
    const size_t dot = path.rfind('.');
    YAML::Node outer(YAML::NodeType::Map);
    outer[path.substr(dot == std::string::npos ? 0 : dot + 1)] = value;
    if (dot == std::string::npos) {
      return outer;
    }
    value.reset(outer);
    path.resize(dot);
  }
}

}  // namespace

Status ReadConfigFile(const std::string& path, const std::function<void(ConfigVisitor&)>& describe) {
  ConfigKeys schema;
  describe(schema);
  return ReadConfigLayer(path, 0, schema, describe);
}

Status ApplySettings(const std::vector<std::string>& settings,
                     const std::function<void(ConfigVisitor&)>& describe) {
  ConfigKeys schema;
  describe(schema);
  for (const std::string& setting : settings) {
    const std::string where = "setting " + Quoted(setting);
    std::string key;
    const Result<YAML::Node> tree = SettingTree(setting, where, &key);
    if (!tree.ok()) {
      return tree.status();
    }
    if (!schema.IsKey(key)) {
      return Status::Config(where + ": " + key +
                            (schema.IsSection(key) ? ": is a group of keys, expected one of them"
                                                   : ": unknown key" + schema.Hint(key)));
    }
    ALIDADE_RETURN_IF_ERROR(ApplyTree(*tree, where, schema, describe));
  }
  return Status::Ok();
}

Result<EstimatorConfig> LoadEstimatorConfig(const std::string& path,
                                            const std::vector<std::string>& settings) {
  EstimatorConfig config;
  const auto describe = [&config](ConfigVisitor& visitor) { config.Describe(visitor); };
  ALIDADE_RETURN_IF_ERROR(ReadConfigFile(path, describe));
  ALIDADE_RETURN_IF_ERROR(ApplySettings(settings, describe));
  if (const Status valid = config.Validate(); !valid.ok()) {
    return Status(valid.code(), path + ": " + valid.message());
  }
  return config;
}

}  // namespace alidade
