#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/status.h"
#include "eval/bag/bag_import_options.h"
#include "eval/bag/bag_remarks.h"
#include "eval/bag/bag_sheets.h"
#include "eval/bag/bag_topics.h"
#include "eval/dataset/dataset.h"
#include "eval/rosbag/rosbag_reader.h"

namespace alidade {

/// One bag on its way to a dataset.
struct BagContext {
  const std::string& path;
  const BagImportOptions& options;
  BagTopics topics;  ///< after Resolve
  BagSheets sheets;
  BagRemarks remarks;
  Dataset dataset;
};

/// Collects the messages of one sensor, or of the truth.
class BagCollector {
 public:
  BagCollector() = default;
  BagCollector(const BagCollector&) = delete;
  BagCollector& operator=(const BagCollector&) = delete;
  virtual ~BagCollector() = default;

  /// False: the message is not one of this sensor. A message that does not decode becomes a remark; an error
  /// ends the import.
  virtual Result<bool> Take(const BagMessage& message, BagContext* bag) = 0;

  /// After all messages: puts what was taken into the dataset. The sheets are complete.
  virtual Status Assemble(BagContext* bag) = 0;
};

/// Appends a decoded message, or remarks that it does not decode.
template <typename Entry>
void KeepDecoded(std::optional<Entry> entry, const std::string& topic, std::vector<Entry>* entries,
                 BagRemarks* remarks) {
  if (entry) {
    entries->push_back(std::move(*entry));
  } else {
    remarks->AddSkipped(topic, "does not decode");
  }
}

/// Sorts by stamp and drops all but the first of equal stamps; how many were dropped.
template <typename Entry>
std::size_t SortByStamp(std::vector<Entry>* entries) {
  const auto before = [](const Entry& a, const Entry& b) { return a.stamp_ns < b.stamp_ns; };
  const auto same = [](const Entry& a, const Entry& b) { return a.stamp_ns == b.stamp_ns; };
  std::stable_sort(entries->begin(), entries->end(), before);
  const std::size_t count = entries->size();
  entries->erase(std::unique(entries->begin(), entries->end(), same), entries->end());
  return count - entries->size();
}

}  // namespace alidade
