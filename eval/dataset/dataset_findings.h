#pragma once

#include <string>
#include <utility>
#include <vector>

#include "eval/dataset/dataset.h"
#include "eval/dataset/stamp_unit.h"

namespace alidade {

/// A finding of `check`: an error, a warning or a fact about a sequence.
struct DatasetFinding {
  enum class Severity { kFact, kWarning, kError } severity = Severity::kFact;
  std::string text;
};

/// What `check` has found so far.
class Findings {
 public:
  void Fact(std::string text);
  void Warning(std::string text);
  void Error(std::string text);
  [[nodiscard]] std::vector<DatasetFinding> Take() { return std::move(list_); }

 private:
  std::vector<DatasetFinding> list_;
};

/// Rate, span and gaps of one sensor. A gap is a step of more than three median steps. stated_rate_hz: 0 when
/// no sheet says one. rates: those of its kind; stamps in another unit than nanoseconds are an error, of
/// which nothing else is said. False: they are.
bool CheckStamps(const char* sensor, const std::vector<TimeNs>& stamps, double stated_rate_hz,
                 const RateRange& rates, Findings* findings);
/// Where a sensor starts and ends against the IMU. False: they share no time, or stamps in another unit,
/// which CheckStamps has told, leave nothing to compare.
bool CheckSpan(const char* sensor, TimeNs first, TimeNs last, const Dataset& dataset, Findings* findings);

}  // namespace alidade
