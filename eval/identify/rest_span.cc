#include "eval/identify/rest_span.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/format.h"
#include "core/imu_statistics.h"

namespace alidade {
namespace {

constexpr double kWindow_s = 1;
constexpr std::size_t kLeastOfWindow = 10;
constexpr double kSpreadOverQuiet = 2;
constexpr double kStepOverQuiet = 8;

/// A second of the recording.
struct RestWindow {
  std::size_t first = 0;
  std::size_t count = 0;
  ImuStatistics statistics;
  double gyro_step = 0;  ///< of the mean since the window before
  double accel_step = 0;
  bool at_rest = false;
};

std::vector<RestWindow> SplitIntoWindows(const std::vector<ImuSample>& imu) {
  std::vector<RestWindow> windows;
  for (std::size_t first = 0; first < imu.size();) {
    std::size_t end = first;
    while (end < imu.size() && SecondsBetween(imu[first].stamp_ns, imu[end].stamp_ns) < kWindow_s) {
      ++end;
    }
    RestWindow window{first, end - first, MeasureImu(std::span(imu).subspan(first, end - first))};
    if (!windows.empty()) {
      const ImuStatistics& before = windows.back().statistics;
      window.gyro_step = (window.statistics.mean_gyro - before.mean_gyro).norm();
      window.accel_step = (window.statistics.mean_accel - before.mean_accel).norm();
    }
    windows.push_back(window);
    first = end;
  }
  return windows;
}

double LowerQuartile(const std::vector<RestWindow>& windows, double (*figure)(const RestWindow&)) {
  std::vector<double> values;
  for (const RestWindow& window : windows) {
    if (window.at_rest) {
      values.push_back(figure(window));
    }
  }
  if (values.empty()) {
    return 0;
  }
  const auto quartile = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
  std::nth_element(values.begin(), quartile, values.end());
  return *quartile;
}

/// Marks the windows at rest.
void MarkRest(const InitConfig& init, std::vector<RestWindow>* windows) {
  for (RestWindow& window : *windows) {
    window.at_rest = window.count >= kLeastOfWindow &&
                     window.statistics.gyro_std_radps < init.static_max_gyro_std_radps &&
                     window.statistics.accel_std_mps2 < init.static_max_accel_std_mps2;
  }
  constexpr std::array<std::pair<double (*)(const RestWindow&), double>, 4> kRules = {
      {{[](const RestWindow& w) { return w.statistics.gyro_std_radps; }, kSpreadOverQuiet},
       {[](const RestWindow& w) { return w.statistics.accel_std_mps2; }, kSpreadOverQuiet},
       {[](const RestWindow& w) { return w.gyro_step; }, kStepOverQuiet},
       {[](const RestWindow& w) { return w.accel_step; }, kStepOverQuiet}}};
  std::array<double, kRules.size()> limits{};
  for (std::size_t i = 0; i < kRules.size(); ++i) {
    limits[i] = kRules[i].second * LowerQuartile(*windows, kRules[i].first);
  }
  for (RestWindow& window : *windows) {
    for (std::size_t i = 0; i < kRules.size(); ++i) {
      window.at_rest = window.at_rest && kRules[i].first(window) <= limits[i];
    }
  }
}

TimeNs MedianStep(const std::vector<ImuSample>& imu) {
  std::vector<TimeNs> steps;
  for (std::size_t k = 1; k < imu.size(); ++k) {
    steps.push_back(imu[k].stamp_ns - imu[k - 1].stamp_ns);
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// Periods between two stamps; a step of up to one and a half is jitter.
std::size_t PeriodsBetween(TimeNs before, TimeNs after, TimeNs period_ns) {
  const double periods = static_cast<double>(after - before) / static_cast<double>(period_ns);
  return periods > 1.5 ? static_cast<std::size_t>(std::lround(periods)) : 1;
}

/// Samples [first, second) of the longest run of windows at rest without a long silence; `rest_s`: all runs.
std::pair<std::size_t, std::size_t> LongestRun(const std::vector<ImuSample>& imu,
                                               const std::vector<RestWindow>& windows, TimeNs period_ns,
                                               double* rest_s) {
  std::pair<std::size_t, std::size_t> longest{0, 0}, run{0, 0};
  const auto duration = [&](const std::pair<std::size_t, std::size_t>& range) {
    return range.second > range.first
               ? SecondsBetween(imu[range.first].stamp_ns, imu[range.second - 1].stamp_ns)
               : 0;
  };
  const auto close = [&](std::size_t next) {
    *rest_s += duration(run);
    longest = duration(run) > duration(longest) ? run : longest;
    run = {next, next};
  };
  for (const RestWindow& window : windows) {
    const std::size_t end = window.first + window.count;
    if (!window.at_rest) {
      close(end);
      continue;
    }
    for (std::size_t k = window.first; k < end; ++k) {
      if (k > run.first &&
          PeriodsBetween(imu[k - 1].stamp_ns, imu[k].stamp_ns, period_ns) > kLongestFilledGap + 1) {
        close(k);
      }
      run.second = k + 1;
    }
  }
  close(imu.size());
  return longest;
}

void AppendSample(const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel, RestSpan* span) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    span->axes[axis].push_back(gyro[static_cast<Eigen::Index>(axis)]);
    span->axes[axis + 3].push_back(accel[static_cast<Eigen::Index>(axis)]);
  }
}

/// Fills the span's axes with evenly spaced samples and measures period and jitter.
void Resample(std::span<const ImuSample> imu, TimeNs period_ns, RestSpan* span) {
  AppendSample(imu[0].gyro, imu[0].accel, span);
  for (std::size_t k = 1; k < imu.size(); ++k) {
    const std::size_t steps = PeriodsBetween(imu[k - 1].stamp_ns, imu[k].stamp_ns, period_ns);
    span->gaps += steps > 1 ? 1 : 0;
    span->filled += steps - 1;
    for (std::size_t step = 1; step <= steps; ++step) {
      const double share = static_cast<double>(step) / static_cast<double>(steps);
      AppendSample((1 - share) * imu[k - 1].gyro + share * imu[k].gyro,
                   (1 - share) * imu[k - 1].accel + share * imu[k].accel, span);
    }
  }
  span->start_ns = imu.front().stamp_ns;
  span->end_ns = imu.back().stamp_ns;
  span->period_s = SecondsBetween(span->start_ns, span->end_ns) / static_cast<double>(span->samples() - 1);
  double square = 0;
  for (std::size_t k = 1; k < imu.size(); ++k) {
    const double steps = static_cast<double>(PeriodsBetween(imu[k - 1].stamp_ns, imu[k].stamp_ns, period_ns));
    const double error = SecondsBetween(imu[k - 1].stamp_ns, imu[k].stamp_ns) - steps * span->period_s;
    square += error * error;
  }
  span->jitter_rms_s = std::sqrt(square / static_cast<double>(imu.size() - 1));
}

void Remark(RestSpan* span) {
  constexpr double kMuchFilled = 0.01, kMuchJitter = 0.3, kLongEnough_s = 600;
  const double filled = static_cast<double>(span->filled) / static_cast<double>(span->samples());
  if (span->duration_s() < 0.99 * span->recording_s) {
    span->remarks.push_back(
        Format("the recording of %.1f s is not at rest throughout (%.1f s in all): used is the "
               "longest span at rest, %.1f s",
               span->recording_s, span->rest_s, span->duration_s()));
  }
  if (filled > kMuchFilled) {
    span->remarks.push_back(
        Format("%.1f %% of the samples are missing: white noise is too small by about half of "
               "that share",
               100 * filled));
  }
  if (span->jitter_rms_s > kMuchJitter * span->period_s) {
    span->remarks.push_back(
        Format("the stamps jitter by %.0f %% of the period: missing samples cannot be distinguished from "
               "late ones",
               100 * span->jitter_rms_s / span->period_s));
  }
  if (span->duration_s() < kLongEnough_s) {
    span->remarks.push_back(
        Format("%.0f s at rest show white noise; bias instability and random walk need an hour "
               "or more",
               span->duration_s()));
  }
}

}  // namespace

Result<RestSpan> FindRestSpan(const std::vector<ImuSample>& imu, const InitConfig& init) {
  constexpr std::size_t kLeast = 100;
  if (imu.size() < kLeast) {
    return Status::Input(Format("imu0: holds %zu samples, expected at least %zu", imu.size(), kLeast));
  }
  const TimeNs period_ns = MedianStep(imu);
  std::vector<RestWindow> windows = SplitIntoWindows(imu);
  MarkRest(init, &windows);
  RestSpan span;
  span.recording_s = SecondsBetween(imu.front().stamp_ns, imu.back().stamp_ns);
  const auto [first, end] = LongestRun(imu, windows, period_ns, &span.rest_s);
  const double longest_s = end > first ? SecondsBetween(imu[first].stamp_ns, imu[end - 1].stamp_ns) : 0;
  if (longest_s < kShortestRest_s) {
    return Status::Input(
        Format("imu0: the longest span at rest of %.1f s is %.1f s, expected at least %.0f s; of a "
               "recording in motion the noise is identified by --motion",
               span.recording_s, longest_s, kShortestRest_s));
  }
  Resample(std::span(imu).subspan(first, end - first), period_ns, &span);
  Remark(&span);
  return span;
}

}  // namespace alidade
