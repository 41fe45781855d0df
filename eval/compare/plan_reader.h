#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "eval/files/strict_yaml.h"

namespace alidade {

/// Reads the values of one plan file; every fault names file and position.
class PlanReader {
 public:
  /// Handler of the value of one key.
  struct Key {
    std::string name;
    std::function<Status(const YAML::Node&)> read;
    bool required = false;
  };

  PlanReader(std::string path, std::string data_root);

  [[nodiscard]] Status Fault(const YAML::Node& node, const std::string& name,
                             const std::string& expected) const;

  /// A mapping with these keys and no others.
  Status Map(const YAML::Node& node, const std::string& name, const std::vector<Key>& keys) const;
  /// A sequence with at least one entry.
  Status Each(const YAML::Node& node, const std::string& name,
              const std::function<Status(const YAML::Node&)>& read) const;
  Status Text(const YAML::Node& node, const std::string& name, std::string* value) const;
  /// A name that is valid as a folder name: letters, digits, '.', '_', '-', '+'; not starting with '.'.
  Status FolderName(const YAML::Node& node, const std::string& name, std::string* value) const;
  /// The same rule for a name that follows from the path of `node`.
  [[nodiscard]] Status CheckFolderName(const YAML::Node& node, const std::string& name,
                                       const std::string& derived) const;
  /// A path, resolved: ${data} replaced, relative to the plan's folder.
  Status Path(const YAML::Node& node, const std::string& name, std::string* value) const;
  /// A path of a file or of a dataset (`folder`) that exists, resolved.
  Status ExistingPath(const YAML::Node& node, const std::string& name, bool folder, std::string* value) const;
  Status Real(const YAML::Node& node, const std::string& name, double min, double max, double* value) const;
  Status Boolean(const YAML::Node& node, const std::string& name, bool* value) const;
  /// One of two words; `value`: it is the second.
  Status Either(const YAML::Node& node, const std::string& name, const std::string& first,
                const std::string& second, bool* value) const;
  /// A whole number, a sequence of them or a range "1..20"; no duplicates, 1 to 1000 of them.
  Status Seeds(const YAML::Node& node, const std::string& name, std::vector<unsigned>* seeds) const;
  /// A mapping of "a.b: value" to settings "a.b=value".
  Status Settings(const YAML::Node& node, const std::string& name, std::vector<std::string>* settings) const;

 private:
  /// Replaces ${data} in `text`; a fault when there is no data root.
  [[nodiscard]] Status SubstituteData(const YAML::Node& node, const std::string& name,
                                      std::string* text) const;

  Status AddSeed(const YAML::Node& node, const std::string& name, std::vector<unsigned>* seeds) const;

  std::string path_;
  std::string data_root_;
};

}  // namespace alidade
