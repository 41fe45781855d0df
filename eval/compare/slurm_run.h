#pragma once

#include <functional>
#include <string>
#include <vector>

#include "eval/compare/cell_list.h"

namespace alidade {

/// Runs the cells of a comparison as jobs of the workload manager Slurm: an array that tracks images (where
/// there are any), an array that runs the cells once it has ended, and a job that writes the tables once that
/// has ended. Every task takes contiguous cells and passes over those whose report is there, so a task that
/// is requeued, because its node died, goes on where it was. Program, plan, data and output must have the
/// same paths on all nodes. Scripts and logs: slurm/ in the output folder.
class SlurmRun {
 public:
  /// `ended(cell, fault)`: as WorkerPool's. All must outlive the object.
  SlurmRun(const CompareOptions& options, const CellList& cells,
           std::function<void(size_t cell, const std::string& fault)> ended);

  /// Submits the jobs and waits for the last. When options.stop is set it returns, and the jobs go on. Errors
  /// (kOutput): sbatch is missing or refuses a job; the jobs are gone and have written no tables.
  Status Run();

 private:
  Status Submit();
  Result<std::string> SubmitJob(const std::string& name, size_t tasks, const std::string& stage,
                                const std::string& after);
  /// Reports the cells whose report has come since the last call.
  void Scan();
  [[nodiscard]] bool Exists() const;

  const CompareOptions& options_;
  const CellList& cells_;
  std::function<void(size_t cell, const std::string& fault)> ended_;
  std::string folder_;
  std::vector<std::string> jobs_;
  std::vector<size_t> open_;  ///< cells without a report
};

}  // namespace alidade
