#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace alidade {

/// Remarks on the import of a bag: assumptions, skipped messages, missing items. Each begins with the path.
class BagRemarks {
 public:
  explicit BagRemarks(std::string path) : path_(std::move(path)) {}

  void Add(const std::string& text) { texts_.push_back(path_ + ": " + text); }
  /// A message of a topic was skipped; only the first of each topic is remarked on at once.
  void AddSkipped(const std::string& topic, const std::string& reason);
  /// `count` messages of a topic had the stamp of another one; nothing for none.
  void AddDropped(const std::string& topic, std::size_t count);
  /// Remarks how many messages were skipped, of topics with more than one.
  void AddTotals();

  [[nodiscard]] std::vector<std::string> Take() { return std::move(texts_); }

 private:
  std::string path_;
  std::vector<std::string> texts_;
  std::map<std::string, std::int64_t> skipped_;  ///< topic -> messages
};

}  // namespace alidade
