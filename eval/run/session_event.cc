#include "eval/run/session_event.h"

#include "core/format.h"

namespace alidade {
namespace {

std::string At(const char* what, TimeNs stamp_ns) {
  return std::string(what) + " at " + FormatSeconds(stamp_ns) + " s";
}

std::string Of(Sensor sensor, const char* what, TimeNs stamp_ns) {
  return std::string(ToString(sensor)) + " message of " + FormatSeconds(stamp_ns) + " s " + what;
}

struct Describer {
  std::string operator()(const StartedEvent& e) const {
    return At("started", e.estimate.stamp_ns) + " (" + e.method + "): " + e.report;
  }
  std::string operator()(const StateEvent& e) const {
    const Eigen::Vector3d& p = e.estimate.nav.p_WB;
    return At("state", e.estimate.stamp_ns) + Format(": p_WB %.3f %.3f %.3f m", p.x(), p.y(), p.z());
  }
  std::string operator()(const SuspectEvent& e) const { return At("suspect", e.stamp_ns) + ": " + e.reason; }
  std::string operator()(const DegradedEvent& e) const {
    return At("degraded", e.stamp_ns) + ": " + e.reason;
  }
  std::string operator()(const LostEvent& e) const { return At("lost", e.stamp_ns) + ": " + e.reason; }
  std::string operator()(const RestartedEvent& e) const {
    return At("restarted", e.estimate.stamp_ns) + " (" + e.method + "): " + e.report;
  }
  std::string operator()(const AlignedEvent& e) const {
    return At("aligned", e.global.stamp_ns) + ": " + e.alignment.report;
  }
  std::string operator()(const SatellitesEvent& e) const {
    return At("satellites", e.residuals.stamp_ns) + Format(": %zu gated", e.residuals.satellites.size());
  }
  std::string operator()(const WaitingEvent& e) const {
    const char* sought = e.sought == Sought::kAlignment ? "not aligned"
                         : e.sought == Sought::kRestart ? "not restarted"
                                                        : "not started";
    return At(sought, e.stamp_ns) + ": " + e.reason;
  }
  std::string operator()(const TooLateEvent& e) const {
    return Of(e.sensor, "is too late", e.stamp_ns) + Format(" by %.3f s", e.late_s);
  }
  std::string operator()(const SkippedEvent& e) const {
    return Of(e.sensor, "is skipped: ", e.stamp_ns) + e.reason;
  }
  std::string operator()(const FailedEvent& e) const {
    return At("failed", e.stamp_ns) + ": " + e.status.message();
  }
};

}  // namespace

std::string Describe(const SessionEvent& event) {
  return std::visit(Describer(), event);
}

FrameStatistics BetweenFrames(const FrameStatistics& all) {
  FrameStatistics epoch;
  epoch.satellites_used = all.satellites_used;
  epoch.satellites_gated = all.satellites_gated;
  epoch.gnss_nis = all.gnss_nis;
  epoch.gnss_nis_dof = all.gnss_nis_dof;
  epoch.clock_jump = all.clock_jump;
  epoch.sensors = all.sensors;
  epoch.propagate_ms = all.propagate_ms;
  epoch.update_ms = all.update_ms;
  return epoch;
}

}  // namespace alidade
