#pragma once

#include <string>

#include "core/status.h"

namespace alidade {

/// How far the comparison that writes `output` is, as text for people: cells that are complete, failed (with
/// the reason) and running, and the time left by the mean time of a cell so far. From any machine that sees
/// the folder. Error (kInput): no comparison has begun there.
Result<std::string> DescribeComparison(const std::string& output);

/// Marks a cell as running in this process, for DescribeComparison, from construction to destruction.
class RunningMark {
 public:
  /// report_file: of the cell.
  explicit RunningMark(const std::string& report_file);
  ~RunningMark();
  RunningMark(const RunningMark&) = delete;
  RunningMark& operator=(const RunningMark&) = delete;

 private:
  std::string path_;
};

}  // namespace alidade
