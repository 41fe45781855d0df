#pragma once

#include <functional>
#include <list>
#include <optional>
#include <string>

#include "eval/compare/cell_list.h"
#include "eval/compare/cell_queue.h"
#include "eval/compare/worker_process.h"

namespace alidade {

/// Runs the cells of a comparison in options.jobs processes. One that dies, for whatever reason, costs the
/// cell it was at, and another takes its place.
class WorkerPool {
 public:
  /// `ended(cell, fault)` is told of each cell: its report is written, or there is none and `fault` says why.
  /// All must outlive the object.
  WorkerPool(const CompareOptions& options, const CellList& cells,
             std::function<void(size_t cell, const std::string& fault)> ended);

  /// Returns when all cells have ended, or soon after options.stop is set. Error (kOutput): a worker cannot
  /// be started, or ends before it takes a cell.
  Status Run();

 private:
  struct Worker {
    WorkerProcess process;
    bool ready = false;
    std::optional<size_t> cell;  ///< that it is at
    std::optional<size_t> last;  ///< that it was at
  };
  Status Fill();
  void Feed();
  /// Waits for a line of any worker, and takes it.
  Status Listen();
  Status Hear(Worker* worker);
  Status Bury(std::list<Worker>::iterator worker);

  const CompareOptions& options_;
  CellQueue queue_;
  std::function<void(size_t cell, const std::string& fault)> ended_;
  std::list<Worker> workers_;
};

}  // namespace alidade
