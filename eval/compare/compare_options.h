#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "eval/report/figure_files.h"

namespace alidade {

/// How a comparison runs and what it writes.
struct CompareOptions {
  std::string output;
  int jobs = 1;  ///< runs at a time; results do not depend on it, but their times do
  /// Keep the cells that are complete and were made from the same input and configuration.
  bool resume = false;
  FigureFormats figures;  ///< for papers, into figures/
  std::string command;    ///< command line that repeats it, for the report
  const std::atomic<bool>* stop = nullptr;
  std::function<void(const std::string& line)> progress;  ///< called by one thread at a time
};

}  // namespace alidade
