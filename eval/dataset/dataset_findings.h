#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "eval/dataset/clock_shift.h"
#include "eval/dataset/dataset.h"
#include "eval/dataset/sensor_rates.h"

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

/// A fault without which nothing can be estimated from the camera: an error, or a warning beside GNSS or
/// fixes, with which an estimator may do without it.
void ReportUseless(const Dataset& dataset, std::string text, Findings* findings);

/// Rate, span and gaps of one sensor. A gap is a step of more than three median steps. stated_rate_hz: 0 when
/// no sheet has one. Returns the rate of the median step [Hz], which gaps do not lower, or above
/// limits.high_hz the mean rate if that is less; 0 of fewer than two stamps. None: the stamps are in another
/// unit than nanoseconds, an error of which nothing else is to be said.
std::optional<double> CheckStamps(const char* sensor, const std::vector<TimeNs>& stamps,
                                  double stated_rate_hz, const RateLimits& limits, Findings* findings);
/// A rate that its kind of sensor does not have. rate_hz: 0 when none is known.
void CheckRate(const char* sensor, double rate_hz, const RateLimits& limits, Findings* findings);

/// The IMU's time. None: its stamps are in another unit than nanoseconds, which is an error of its own, and
/// no time can be compared with it. Precondition: two samples.
[[nodiscard]] std::optional<TimeSpan> ImuSpan(const Dataset& dataset);
/// Where a sensor starts and ends against the IMU, in IMU time. Without common time the unit is named that
/// would explain it, or else the known difference of clocks (eval/dataset/clock_shift.h), which is also named
/// when both ends are off by it. False: the two share no time, or ImuSpan has none; nothing else is to be
/// compared.
bool CheckSpan(const char* sensor, TimeNs first, TimeNs last, const Dataset& dataset, Findings* findings);
/// Warns when much of the sensor's time lies outside of the IMU's. Much is more than kMaxUnreadableShare of
/// its span, one of its `stamps` mean steps, and the second by which recorders begin and end apart.
/// Precondition of this and the next: common time (CheckSpan).
void CheckTimeWithoutImu(const char* sensor, TimeNs first, TimeNs last, size_t stamps, const Dataset& dataset,
                         Findings* findings);
/// Warns likewise when much of the IMU's time lies outside of the sensor's, which bounds the drift.
void CheckTimeWithoutSensor(const char* sensor, TimeNs first, TimeNs last, size_t stamps,
                            const Dataset& dataset, Findings* findings);

}  // namespace alidade
