#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "eval/report/figure_files.h"

namespace alidade {

/// Contiguous cells: the index-th of `parts` about equal parts, as one task of several does them.
struct CellPart {
  size_t index = 0;
  size_t parts = 1;

  [[nodiscard]] size_t First(size_t cells) const { return cells * index / parts; }
  [[nodiscard]] size_t End(size_t cells) const { return cells * (index + 1) / parts; }
};

/// Beyond these a cell is killed, its input and all that it starts included, and has failed.
struct CellLimits {
  double time_s = 0;      ///< wall time [s]; 0: none
  double memory_mib = 0;  ///< MemoryOfTree of its process [MiB]; 0: none
};

/// How a comparison runs and what it writes.
struct CompareOptions {
  std::string output;
  int jobs = 1;  ///< runs at a time; results do not depend on it, but their times do
  /// Keep the cells that are complete and were made from the same input and configuration.
  bool resume = false;
  FigureFormats figures;  ///< for papers, into figures/
  std::string command;    ///< command line that repeats it, for the report
  const std::atomic<bool>* stop = nullptr;
  /// Program and words that start a worker (CellWorker) of this comparison; empty: its cells run in this
  /// process, one after the other.
  std::vector<std::string> worker;
  CellLimits limits;          ///< of cells in worker processes
  bool slurm = false;         ///< cells run as jobs of Slurm, started with the words of `worker`
  std::string slurm_options;  ///< arguments of sbatch
  std::function<void(const std::string& line)> progress;

  [[nodiscard]] bool Stopped() const { return stop != nullptr && stop->load(); }
};

}  // namespace alidade
