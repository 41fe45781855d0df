#include "eval/dataset/dataset_findings.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/median.h"
#include "eval/dataset/log_tables.h"

namespace alidade {

void Findings::Fact(std::string text) {
  list_.push_back({DatasetFinding::Severity::kFact, std::move(text)});
}

void Findings::Warning(std::string text) {
  list_.push_back({DatasetFinding::Severity::kWarning, std::move(text)});
}

void Findings::Error(std::string text) {
  list_.push_back({DatasetFinding::Severity::kError, std::move(text)});
}

namespace {

/// Whether the IMU's own stamps are not comparable with those of others.
bool ImuIsInOtherUnit(const Dataset& dataset, const Table<ImuSample>& imu) {
  return OtherStampUnit(imu.front().stamp_ns, imu.back().stamp_ns, imu.size(), dataset.imu_rate_hz,
                        kImuRates) != nullptr;
}

}  // namespace

bool CheckStamps(const char* sensor, const std::vector<TimeNs>& stamps, double stated_rate_hz,
                 const RateRange& rates, Findings* findings) {
  if (stamps.size() < 2) {
    findings->Warning(Format("%s: %zu stamps", sensor, stamps.size()));
    return true;
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
          OtherStampUnit(stamps.front(), stamps.back(), stamps.size(), stated_rate_hz, rates)) {
    findings->Error(
        Format("%s: the stamps as nanoseconds give %.4g Hz, expected at most %.4g Hz: they seem to be in %s, "
               "which gives %.4g Hz%s; expected ns, multiply them by %lld",
               sensor, mean_rate, rates.most_hz, unit->name, mean_rate / static_cast<double>(unit->ns),
               DateText(stamps.front(), *unit).c_str(), static_cast<long long>(unit->ns)));
    return false;
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
  return true;
}

bool CheckSpan(const char* sensor, TimeNs first, TimeNs last, const Dataset& dataset, Findings* findings) {
  const Table<ImuSample> imu = TablesOf(dataset).imu;
  if (ImuIsInOtherUnit(dataset, imu)) {
    return false;
  }
  const TimeNs imu_first = imu.front().stamp_ns;
  const TimeNs imu_last = imu.back().stamp_ns;
  findings->Fact(Format("%s: starts %+.3f s and ends %+.3f s against imu0", sensor,
                        SecondsBetween(imu_first, first), SecondsBetween(imu_last, last)));
  if (last >= imu_first && first <= imu_last) {
    return true;
  }
  if (const StampUnit* unit = UnitByReference(first, imu_first)) {
    findings->Error(
        Format("%s: shares no time with imu0: its stamps seem to be in %s, expected ns, multiply "
               "them by %lld",
               sensor, unit->name, static_cast<long long>(unit->ns)));
    return false;
  }
  const double ratio = static_cast<double>(first) / static_cast<double>(imu_first);
  findings->Error(Format("%s: shares no time with imu0: %s", sensor,
                         ratio > 1e2 || ratio < 1e-2 ? "another unit of time?" : "another clock?"));
  return false;
}

}  // namespace alidade
