#include "eval/compare/cell_worker.h"

#include <sys/prctl.h>

#include <charconv>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <string>

#include "eval/compare/cell_runner.h"

namespace alidade {
namespace {

Status Answer(const std::string& line) {
  if (std::printf("%s\n", line.c_str()) < 0 || std::fflush(stdout) != 0) {
    return Status::Output("the comparison that this worker belongs to has ended");
  }
  return Status::Ok();
}

}  // namespace

Status ServeCells(const Plan& plan, const CompareOptions& options) {
  // A key on a terminal reaches the whole group; the process that started this one passes it on.
  std::signal(SIGINT, SIG_IGN);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  // What a command leaves running stays below this process, and is ended with it.
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  CellList cells;
  ALIDADE_RETURN_IF_ERROR(cells.Make(plan, options));
  ALIDADE_RETURN_IF_ERROR(Answer("ready"));
  CellRunner runner(plan, options, &cells);
  for (std::string line; !options.Stopped() && std::getline(std::cin, line);) {
    size_t cell = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), cell);
    if (error != std::errc() || end != line.data() + line.size() || cell >= cells.size()) {
      return Status::Usage("found \"" + line + "\", expected the number of a cell below " +
                           std::to_string(cells.size()));
    }
    ALIDADE_RETURN_IF_ERROR(runner.Run(cell));
    if (!options.Stopped()) {
      ALIDADE_RETURN_IF_ERROR(Answer("done " + line));
    }
  }
  return Status::Ok();
}

}  // namespace alidade
