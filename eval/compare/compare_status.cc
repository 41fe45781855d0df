#include "eval/compare/compare_status.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <sstream>

#include "core/format.h"
#include "eval/comparison/cell_file.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
#include "eval/files/time_left.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

std::string HostName() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::string MarkOf(const std::string& report_file) {
  return report_file + ".running";
}

/// "on node7, for 12 s", or that the process there has died; empty: not begun.
std::string Running(const std::string& report_file) {
  const Result<std::string> text = ReadWholeFile(MarkOf(report_file));
  if (!text.ok()) {
    return {};
  }
  std::istringstream words(*text);
  std::string host;
  pid_t process = 0;
  words >> host >> process;
  if (host == HostName() && ::kill(process, 0) != 0 && errno == ESRCH) {
    return "process " + std::to_string(process) + " on " + host + " has died";
  }
  std::error_code error;
  const auto since = fs::last_write_time(MarkOf(report_file), error);
  const double age_s = std::chrono::duration<double>(fs::file_time_type::clock::now() - since).count();
  return "running on " + host + (error ? "" : Format(" for %.0f s", age_s));
}

}  // namespace

RunningMark::RunningMark(const std::string& report_file) : path_(MarkOf(report_file)) {
  static_cast<void>(WriteFileAtomically(path_, HostName() + " " + std::to_string(::getpid()) + "\n"));
}

RunningMark::~RunningMark() {
  ::unlink(path_.c_str());
}

Result<std::string> DescribeComparison(const std::string& output) {
  const Result<std::string> table = ReadWholeFile(output + "/cells.csv");
  if (!table.ok()) {
    return Status::Input(output + ": no comparison has begun there (no cells.csv)");
  }
  size_t cells = 0, complete = 0, failed = 0, running = 0;
  fs::file_time_type first = fs::file_time_type::max(), last = fs::file_time_type::min();
  std::string failures, at_work;
  std::istringstream rows(*table);
  std::string row;
  std::getline(rows, row);
  while (std::getline(rows, row)) {
    ++cells;
    std::replace(row.begin(), row.end(), ',', '/');
    const std::string file = output + "/scores/" + row + ".cbor";
    if (!MayExist(file)) {
      if (const std::string mark = Running(file); !mark.empty()) {
        ++running;
        at_work += "  " + row + ": " + mark + "\n";
      }
      continue;
    }
    const Result<CellEnd> end = ReadCellEnd(file);
    ++complete;
    if (!end.ok() || end->status != "ok") {
      ++failed;
      failures += "  " + row + ": " + (end.ok() ? end->status + ", " + end->message : end.message()) + "\n";
    }
    std::error_code error;
    const auto time = fs::last_write_time(file, error);
    first = std::min(first, time);
    last = std::max(last, time);
  }
  // The first cell's own time is not known.
  const double elapsed_s = complete > 1 ? std::chrono::duration<double>(last - first).count() : 0;
  return std::to_string(complete) + " of " + std::to_string(cells) + " cells are complete, " +
         std::to_string(failed) + " of them failed, " + std::to_string(running) + " run" +
         (complete > 1 ? TimeLeft(elapsed_s, complete - 1, cells - 1) : "") + "\n" + at_work + failures;
}

}  // namespace alidade
