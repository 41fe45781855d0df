#include "eval/record/run_health.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include "core/format.h"

namespace alidade {
namespace {

constexpr const char* kUnsound[] = {"degraded", "suspect", "lost"};
constexpr const char* kGnssName = "GNSS";

/// Without those whose model is in doubt.
std::size_t Unsound(const RunHealth& health) {
  std::size_t count = 0;
  for (const char* status : kUnsound) {
    count += health.states.at(status);
  }
  return count - health.doubted;
}

std::string NotUsed(const std::string& sensor, const std::string& why) {
  return sensor + (sensor == kGnssName ? " was" : " were") + " not used: " + why;
}

/// Names of the sensors that the configuration enables.
std::vector<std::string> EnabledSensors(const EstimatorConfig& config) {
  std::vector<std::string> names;
  if (config.gnss.enabled) {
    names.emplace_back(kGnssName);
  }
  ForEachSensorEntry([&](auto entry, Sensor) {
    if (entry.Config(config).enabled) {
      names.emplace_back(entry.kPluralName);
    }
  });
  return names;
}

void CountStates(const RunResult& result, RunHealth* health) {
  for (const char* status : {"ok", "local", "degraded", "suspect", "lost", "restarted"}) {
    health->states[status] = 0;
  }
  std::optional<TimeNs> before_ns;
  // Whoever writes the records reports that they cannot be read.
  static_cast<void>(ForEachRecord(result, [&](const RunRecord& record) {
    ++health->states[record.status];
    const bool doubted = record.status == "degraded" && record.degradation == DegradationKind::kModel;
    health->doubted += doubted ? 1 : 0;
    const bool unsound =
        std::find(std::begin(kUnsound), std::end(kUnsound), record.status) != std::end(kUnsound);
    if (unsound && before_ns) {
      health->unsound_s += SecondsBetween(*before_ns, record.estimate.stamp_ns);
    }
    before_ns = record.estimate.stamp_ns;
    return Status::Ok();
  }));
}

/// Adds to the impairments of a run of `all` frames when the share of `count` of them exceeds `most`.
void LimitShare(std::size_t count, std::size_t all, double most, const char* text, RunHealth* health) {
  const double share = all == 0 ? 0 : static_cast<double>(count) / static_cast<double>(all);
  if (share > most) {
    health->impairments.push_back(
        Format("%zu of %zu frames (%.0f %%) %s %.0f %%", count, all, 100 * share, text, 100 * most));
  }
}

void LimitUnsound(const RunResult& result, RunHealth* health) {
  const auto skipped = static_cast<std::size_t>(result.frames_skipped);
  const std::size_t all = RecordCount(result) + skipped;
  LimitShare(Unsound(*health) + skipped, all, kMaxImpairedShare, "without a sound state, expected at most",
             health);
  LimitShare(health->doubted, all, kMaxDoubtedShare, "whose model is in doubt, expected at most", health);
}

/// ", 47 degraded, 2 suspect (4.90 s)"; empty when all states are sound.
std::string UnsoundText(const RunHealth& health) {
  std::string text;
  for (const char* status : kUnsound) {
    if (const std::size_t count = health.states.at(status); count > 0) {
      text += ", " + std::to_string(count) + " " + status;
    }
  }
  return text.empty() ? text : text + Format(" (%.2f s)", health.unsound_s);
}

}  // namespace

std::vector<std::string> MissingSensors(const EstimatorConfig& config, const MeasurementLog& log) {
  std::vector<std::string> names;
  if (config.gnss.enabled && log.gnss == nullptr) {
    names.emplace_back(kGnssName);
  }
  ForEachSensorEntry([&](auto entry, Sensor) {
    if (entry.Config(config).enabled && entry.Measurements(log).empty()) {
      names.emplace_back(entry.kPluralName);
    }
  });
  return names;
}

RunHealth HealthOf(const EstimatorConfig& config, const RunResult& result) {
  RunHealth health;
  CountStates(result, &health);
  LimitUnsound(result, &health);
  if (!result.restarts.empty()) {
    health.impairments.push_back(
        Format(result.restarts.size() == 1 ? "%zu restart" : "%zu restarts", result.restarts.size()));
  }
  for (const std::string& sensor : EnabledSensors(config)) {
    const auto& missing = result.missing_sensors;
    if (std::find(missing.begin(), missing.end(), sensor) != missing.end()) {
      health.impairments.push_back(NotUsed(sensor, "the sequence has no " + sensor));
    } else if (!result.global) {
      health.impairments.push_back(
          NotUsed(sensor, result.align_report.empty() ? "no alignment was tried" : result.align_report));
    }
  }
  return health;
}

std::string DescribeRun(const RunHealth& health, const RunResult& result) {
  const std::size_t frames = RecordCount(result);
  const std::string status = StatusWord(result);
  std::string text = (status == "ok" && !health.impairments.empty() ? "impaired" : status) + ": ";
  if (frames == 0) {
    text += "no frame was estimated";
  } else {
    text += std::to_string(frames) + " frames, " + std::to_string(result.frames_skipped) + " skipped";
    text += result.frames_skipped > 0 ? " (" + result.skip_report + ")" : "";
    text += UnsoundText(health) + ", start: " + result.init_method;
  }
  text += Format(", %.1f s wall, %.1f s CPU", result.wall_s, result.cpu_s);
  if (frames > 0) {
    text += Format(", %.2f ms CPU a frame", 1e3 * result.cpu_s / static_cast<double>(frames));
  }
  for (const std::string& impairment : health.impairments) {
    text += "; " + impairment;
  }
  return text;
}

}  // namespace alidade
