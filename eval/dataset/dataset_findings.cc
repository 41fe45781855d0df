#include "eval/dataset/dataset_findings.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/median.h"
#include "eval/dataset/log_tables.h"
#include "eval/dataset/stamp_unit.h"

namespace alidade {
namespace {

double Length(const TimeSpan& span) {
  return SecondsBetween(span.first_ns, span.last_ns);
}

std::string Text(const TimeSpan& span) {
  return "from " + FormatSeconds(span.first_ns) + " to " + FormatSeconds(span.last_ns) + " s";
}

/// Seconds of `span` outside of `other`; 0 when they are few.
double MuchOutside(const TimeSpan& span, const TimeSpan& other, double step_s) {
  constexpr double kRecordersApartS = 1;
  const double outside = std::max(0.0, SecondsBetween(span.first_ns, other.first_ns)) +
                         std::max(0.0, SecondsBetween(other.last_ns, span.last_ns));
  return outside > std::max({kMaxUnreadableShare * Length(span), step_s, kRecordersApartS}) ? outside : 0;
}

double MeanStep(const TimeSpan& span, size_t stamps) {
  return stamps < 2 ? 0 : Length(span) / static_cast<double>(stamps - 1);
}

/// What may explain that `span` shares no time with the IMU.
std::string Explanation(const TimeSpan& span, const TimeSpan& imu) {
  constexpr double kOtherMagnitude = 100;
  if (const StampUnit* unit = UnitByReference(span.first_ns, imu.first_ns)) {
    return Format("its stamps seem to be in %s, expected ns, multiply them by %lld", unit->name,
                  static_cast<long long>(unit->ns));
  }
  if (const std::optional<Meeting> meeting = ShiftOntoSpan(span, imu)) {
    return Format("another clock? %+.0f s (%s) added to its stamps would make the two overlap by %.0f %%",
                  SecondsBetween(0, meeting->shift.shift_ns), meeting->shift.name.c_str(),
                  100 * meeting->share);
  }
  const double ratio = static_cast<double>(span.first_ns) / static_cast<double>(imu.first_ns);
  return ratio > kOtherMagnitude || ratio < 1 / kOtherMagnitude ? "another clock, or another unit of time?"
                                                                : "another clock?";
}

}  // namespace

void Findings::Fact(std::string text) {
  list_.push_back({DatasetFinding::Severity::kFact, std::move(text)});
}

void Findings::Warning(std::string text) {
  list_.push_back({DatasetFinding::Severity::kWarning, std::move(text)});
}

void Findings::Error(std::string text) {
  list_.push_back({DatasetFinding::Severity::kError, std::move(text)});
}

void ReportUseless(const Dataset& dataset, std::string text, Findings* findings) {
  bool has_positions = dataset.gnss != nullptr;
  ForEachSensorEntry(
      [&](auto entry, Sensor) { has_positions = has_positions || !entry.Measurements(dataset).empty(); });
  if (has_positions) {
    findings->Warning(std::move(text));
  } else {
    findings->Error(std::move(text));
  }
}

std::optional<double> CheckStamps(const char* sensor, const std::vector<TimeNs>& stamps,
                                  double stated_rate_hz, const RateLimits& limits, Findings* findings) {
  if (stamps.size() < 2) {
    findings->Warning(Format("%s: %zu stamps", sensor, stamps.size()));
    return 0;
  }
  std::vector<double> steps;
  for (size_t i = 1; i < stamps.size(); ++i) {
    steps.push_back(SecondsBetween(stamps[i - 1], stamps[i]));
  }
  const double median = Median(steps);
  int gaps = 0;
  int short_steps = 0;
  size_t widest = 0;
  for (size_t i = 0; i < steps.size(); ++i) {
    gaps += steps[i] > 3 * median ? 1 : 0;
    short_steps += steps[i] < 0.1 * median ? 1 : 0;
    widest = steps[i] > steps[widest] ? i : widest;
  }
  const double span = SecondsBetween(stamps.front(), stamps.back());
  const double mean_rate = static_cast<double>(steps.size()) / span;
  findings->Fact(Format("%s: %zu stamps over %.3f s, from %s to %s; mean rate %.2f Hz, median step %.3f ms",
                        sensor, stamps.size(), span, FormatSeconds(stamps.front()).c_str(),
                        FormatSeconds(stamps.back()).c_str(), mean_rate, 1e3 * median));
  if (const StampUnit* unit =
          OtherStampUnit(stamps.front(), stamps.back(), stamps.size(), stated_rate_hz, limits)) {
    findings->Error(
        Format("%s: the stamps as nanoseconds give %.4g Hz, expected at most %.4g Hz: they seem to be in %s, "
               "which gives %.4g Hz%s; expected ns, multiply them by %lld",
               sensor, mean_rate, limits.high_hz, unit->name, mean_rate / static_cast<double>(unit->ns),
               DateText(stamps.front(), *unit).c_str(), static_cast<long long>(unit->ns)));
    return std::nullopt;
  }
  if (gaps > 0) {
    findings->Warning(
        Format("%s: %d gaps (steps above three median steps); the longest is %.3f s after %lld ns", sensor,
               gaps, steps[widest], static_cast<long long>(stamps[widest])));
  }
  if (short_steps > 0) {
    findings->Warning(
        Format("%s: %d steps shorter than a tenth of the median step; the rows between may be "
               "interpolated",
               sensor, short_steps));
  }
  if (stated_rate_hz > 0 && std::abs(mean_rate / stated_rate_hz - 1) > 0.1) {
    findings->Warning(
        Format("%s: sensor.yaml states %.2f Hz, the stamps give %.2f Hz", sensor, stated_rate_hz, mean_rate));
  }
  // Rows that are stamped on receipt arrive in packets, a few microseconds apart at a mean rate in order.
  return 1 / median > limits.high_hz ? std::min(1 / median, mean_rate) : 1 / median;
}

void CheckRate(const char* sensor, double rate_hz, const RateLimits& limits, Findings* findings) {
  if (rate_hz <= 0 || (rate_hz >= limits.low_hz && rate_hz <= limits.high_hz)) {
    return;
  }
  const std::string text = Format(
      "%s: a rate of %.6g Hz, expected %.6g to %.6g Hz: %s?", sensor, rate_hz, limits.low_hz, limits.high_hz,
      rate_hz < limits.low_hz ? "thinned out, or stamps in another unit" : "stamps in another unit than ns");
  if (rate_hz < limits.least_hz || rate_hz > limits.most_hz) {
    findings->Error(text);
  } else {
    findings->Warning(text);
  }
}

std::optional<TimeSpan> ImuSpan(const Dataset& dataset) {
  const Table<ImuSample> imu = TablesOf(dataset).imu;
  const TimeSpan span{imu.front().stamp_ns, imu.back().stamp_ns};
  return OtherStampUnit(span.first_ns, span.last_ns, imu.size(), dataset.imu_rate_hz, kImuRates) == nullptr
             ? std::optional(span)
             : std::nullopt;
}

bool CheckSpan(const char* sensor, TimeNs first, TimeNs last, const Dataset& dataset, Findings* findings) {
  const std::optional<TimeSpan> imu = ImuSpan(dataset);
  if (!imu) {
    return false;
  }
  const TimeSpan span{first, last};
  const double starts_s = SecondsBetween(imu->first_ns, first);
  const double ends_s = SecondsBetween(imu->last_ns, last);
  findings->Fact(Format("%s: starts %+.3f s and ends %+.3f s against imu0", sensor, starts_s, ends_s));
  if (last < imu->first_ns || first > imu->last_ns) {
    findings->Error(Format("%s: shares no time with imu0: ", sensor) + Explanation(span, *imu));
    return false;
  }
  if (const std::optional<ClockShift> shift = ShiftOfBothEnds(span, *imu)) {
    findings->Warning(Format(
        "%s: starts %+.3f s and ends %+.3f s against imu0, expected about 0: is it %+.0f s (%s), to be "
        "added to its stamps?",
        sensor, starts_s, ends_s, SecondsBetween(0, shift->shift_ns), shift->name.c_str()));
  }
  return true;
}

void CheckTimeWithoutImu(const char* sensor, TimeNs first, TimeNs last, size_t stamps, const Dataset& dataset,
                         Findings* findings) {
  const TimeSpan span{first, last};
  const std::optional<TimeSpan> imu = ImuSpan(dataset);
  if (const double seconds = imu ? MuchOutside(span, *imu, MeanStep(span, stamps)) : 0; seconds > 0) {
    findings->Warning(Format("%s: %s, imu0 %s: %.3f s of %s are without IMU, nothing of it is used there",
                             sensor, Text(span).c_str(), Text(*imu).c_str(), seconds, sensor));
  }
}

void CheckTimeWithoutSensor(const char* sensor, TimeNs first, TimeNs last, size_t stamps,
                            const Dataset& dataset, Findings* findings) {
  const TimeSpan span{first, last};
  const std::optional<TimeSpan> imu = ImuSpan(dataset);
  if (const double seconds = imu ? MuchOutside(*imu, span, MeanStep(span, stamps)) : 0; seconds > 0) {
    findings->Warning(Format("%s: %s, imu0 %s: %.3f s of the IMU's time are without %s", sensor,
                             Text(span).c_str(), Text(*imu).c_str(), seconds, sensor));
  }
}

}  // namespace alidade
