#pragma once

#include <memory>
#include <string>
#include <vector>

#include "eval/compare/compare_cell.h"
#include "eval/compare/compare_configs.h"

namespace alidade {

/// The cells of a plan, in the order in which they run: those of one input stand together.
class CellList {
 public:
  CellList() = default;
  CellList(const CellList&) = delete;
  CellList& operator=(const CellList&) = delete;

  /// Resolves every configuration. Keeps pointers into `plan`. Errors: kConfig.
  Status Make(const Plan& plan, const CompareOptions& options);

  /// cells.csv of the output folder: every cell of the comparison. A file that is as it should be stays:
  /// several machines may take part.
  Status WriteTable(const std::string& output) const;

  [[nodiscard]] size_t size() const { return cells_.size(); }
  [[nodiscard]] CompareCell& at(size_t cell) { return cells_[cell]; }
  [[nodiscard]] const CompareCell& at(size_t cell) const { return cells_[cell]; }
  [[nodiscard]] const std::vector<std::unique_ptr<CompareInput>>& inputs() const { return inputs_; }

 private:
  Status AddDataset(const Plan& plan, const PlanSequence& sequence, const std::string& output);
  Status AddSimulation(const Plan& plan, const PlanSequence& sequence, const std::string& output);
  void AddCells(const Plan& plan, const PlanSequence& sequence, unsigned seed, const std::string& output);
  void DigestCells(const Plan& plan, const PlanSequence& sequence, const std::string& simulation);

  CompareConfigs configs_;
  std::vector<std::unique_ptr<CompareInput>> inputs_;
  std::vector<CompareCell> cells_;
  std::vector<std::string> digests_;  ///< of the sequence that is being added, by estimator
};

}  // namespace alidade
