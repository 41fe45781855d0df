#pragma once

#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/config_schema.h"

namespace alidade {

/// "prefix.name", or the name alone at the top.
[[nodiscard]] std::string JoinKey(const std::string& prefix, std::string_view name);

/// Lists every key and section by its dotted path.
class ConfigKeys final : public ConfigVisitor {
 public:
  void Section(std::string_view name, std::string_view, const std::function<void()>& keys) override {
    const std::string outer = prefix_;
    prefix_ = JoinKey(prefix_, name);
    sections_.insert(prefix_);
    keys();
    prefix_ = outer;
  }
  void Real(const KeyDoc& doc, double*, double, double) override { Add(doc); }
  void Integer(const KeyDoc& doc, int*, int, int) override { Add(doc); }
  void Boolean(const KeyDoc& doc, bool*) override { Add(doc); }
  void Text(const KeyDoc& doc, std::string*) override { Add(doc); }
  void Vector3(const KeyDoc& doc, Eigen::Vector3d*, double, double) override { Add(doc); }
  void Choice(const KeyDoc& doc, const std::vector<std::string_view>&, int*) override { Add(doc); }

  [[nodiscard]] bool IsKey(const std::string& path) const { return keys_.count(path) > 0; }
  [[nodiscard]] bool IsSection(const std::string& path) const { return sections_.count(path) > 0; }

  /// A suggestion for an unknown path, as the end of a message; may be empty.
  [[nodiscard]] std::string Hint(const std::string& path) const;

 private:
  void Add(const KeyDoc& doc) { keys_.insert(JoinKey(prefix_, doc.name)); }

  std::string prefix_;
  std::set<std::string> keys_;
  std::set<std::string> sections_;
};

}  // namespace alidade
