#pragma once

#include <string>
#include <utility>
#include <vector>

#include "eval/dataset/dataset.h"

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
/// no sheet says one.
void CheckStamps(const char* sensor, const std::vector<TimeNs>& stamps, double stated_rate_hz,
                 Findings* findings);
/// Where a sensor starts and ends against the IMU.
void CheckSpan(const char* sensor, TimeNs first, TimeNs last, const Dataset& dataset, Findings* findings);
/// Warns when much of the sensor's time lies outside of the IMU's. Much is more than kMaxUnreadableShare of
/// its span, one of its `stamps` mean steps, and the second by which recorders begin and end apart.
void CheckTimeWithoutImu(const char* sensor, TimeNs first, TimeNs last, size_t stamps, const Dataset& dataset,
                         Findings* findings);
/// Warns likewise when much of the IMU's time lies outside of the sensor's, which bounds the drift.
void CheckTimeWithoutSensor(const char* sensor, TimeNs first, TimeNs last, size_t stamps,
                            const Dataset& dataset, Findings* findings);

}  // namespace alidade
