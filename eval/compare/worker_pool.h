#pragma once

#include <chrono>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "eval/compare/cell_list.h"
#include "eval/compare/cell_queue.h"
#include "eval/compare/worker_process.h"

namespace alidade {

/// Runs cells of a comparison in options.jobs processes. One that dies, for whatever reason, or goes beyond
/// a limit of options.limits and is killed, costs the cell it was at, and another takes its place.
class WorkerPool {
 public:
  /// `wanted`: the cells to run, in order. `ended` is called for each of them when its report is written, be
  /// it by its worker or, for one that died, by this object. All must outlive the object.
  WorkerPool(const CompareOptions& options, const CellList& cells, const std::vector<size_t>& wanted,
             std::function<void(size_t cell)> ended);

  /// Returns when all cells have ended, or soon after options.stop is set. Error (kOutput): a worker cannot
  /// be started, or ends before it takes a cell; a report cannot be written.
  Status Run();

 private:
  struct Worker {
    WorkerProcess process;
    bool ready = false;
    std::optional<size_t> cell;                     ///< that it is at
    std::optional<size_t> last;                     ///< that it was at
    std::chrono::steady_clock::time_point begin{};  ///< of `cell`
  };
  Status Fill();
  void Feed();
  /// Waits for a line of any worker, and takes it.
  Status Listen();
  Status TakeLines(Worker* worker);
  /// One that ended. `fault`: why it was killed; empty: it ended by itself.
  Status Remove(std::list<Worker>::iterator worker, const std::string& fault);
  /// Kills the workers whose cells are beyond a limit.
  Status Watch();
  [[nodiscard]] std::string BeyondLimit(const Worker& worker) const;

  const CompareOptions& options_;
  const CellList& cells_;
  CellQueue queue_;
  std::function<void(size_t cell)> ended_;
  std::list<Worker> workers_;
};

}  // namespace alidade
