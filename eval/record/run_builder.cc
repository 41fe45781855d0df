#include "eval/record/run_builder.h"

#include <utility>

namespace alidade {
namespace {

void Add(const FrameStatistics& epoch, FrameStatistics* sum) {
  sum->satellites_used += epoch.satellites_used;
  sum->satellites_gated += epoch.satellites_gated;
  sum->gnss_nis += epoch.gnss_nis;
  sum->gnss_nis_dof += epoch.gnss_nis_dof;
  ForEachSensorEntry([&](auto, Sensor sensor) {
    const SensorStatistics& counts = epoch.sensors[sensor];
    SensorStatistics& total = sum->sensors[sensor];
    total.used += counts.used;
    total.gated += counts.gated;
    total.nis += counts.nis;
    total.nis_dof += counts.nis_dof;
  });
  sum->clock_jump = sum->clock_jump || epoch.clock_jump;
  sum->propagate_ms += epoch.propagate_ms;
  sum->update_ms += epoch.update_ms;
}

}  // namespace

RunBuilder::RunBuilder(bool camera, const std::string& spool_folder) : camera_(camera) {
  if (!spool_folder.empty()) {
    result_.spool = std::make_shared<RecordSpool>(spool_folder);
  }
}

void RunBuilder::Spool() {
  constexpr size_t kMany = 64;
  if (result_.spool == nullptr || result_.records.size() < kMany) {
    return;
  }
  for (size_t i = 0; i + 1 < result_.records.size(); ++i) {
    Keep(result_.spool->Add(result_.records[i]));
  }
  result_.records.erase(result_.records.begin(), result_.records.end() - 1);
}

void RunBuilder::Keep(Status status) {
  if (!status.ok() && result_.status.ok()) {
    result_.status = std::move(status);
  }
}

void RunBuilder::Take(const SessionEvent& event) {
  std::visit([this](const auto& e) { On(e); }, event);
}

std::string RunBuilder::LostMessage() const {
  const Restart& loss = result_.restarts.back();
  return "lost at " + FormatSeconds(loss.lost_ns) + " s (" + loss.reason +
         ") and not started again: " + refusal_;
}

void RunBuilder::On(const StartedEvent& event) {
  result_.init_stamp_ns = event.estimate.stamp_ns;
  result_.init_method = event.method;
  result_.init_report = event.report;
}

void RunBuilder::On(const StateEvent& event) {
  if (event.source == Sensor::kGnss) {
    ++result_.epochs_used;
  }
  if (event.source != Sensor::kCamera) {
    Add(event.statistics, &epochs_);
  }
  if (event.source != (camera_ ? Sensor::kCamera : Sensor::kGnss)) {
    return;
  }
  if (!result_.records.empty() && event.estimate.stamp_ns <= result_.records.back().estimate.stamp_ns) {
    return;  // an epoch that a later state will hold
  }
  Spool();
  RunRecord& record = result_.records.emplace_back();
  record.estimate = event.estimate;
  record.statistics = camera_ ? event.statistics : FrameStatistics();
  Add(std::exchange(epochs_, {}), &record.statistics);
  record.clock = event.clock;
  record.calibration = event.calibration;
  record.frontend_ms = event.frontend_ms;
  record.backend_ms = event.backend_ms;
  if (std::exchange(restarted_, false)) {
    record.status = "restarted";
    record.reason = result_.restarts.back().init_report;
  }
}

void RunBuilder::On(const SuspectEvent& event) {
  Mark("suspect", event.reason);
}

void RunBuilder::On(const DegradedEvent& event) {
  Mark("degraded", event.reason);
  result_.records.back().degradation = event.kind;
}

void RunBuilder::Mark(const char* status, const std::string& reason) {
  RunRecord& record = result_.records.back();
  if (record.status == "ok") {
    record.status = status;
    record.reason = reason;
  }
}

void RunBuilder::On(const LostEvent& event) {
  result_.restarts.push_back({event.stamp_ns, event.reason, 0, {}});
  if (!result_.records.empty()) {
    result_.records.back().status = "lost";
    result_.records.back().reason = event.reason;
  }
  lost_ = true;
  refusal_ = "there is no frame";
}

void RunBuilder::On(const RestartedEvent& event) {
  result_.restarts.back().restarted_ns = event.estimate.stamp_ns;
  result_.restarts.back().init_report = event.report;
  lost_ = false;
  restarted_ = true;
}

void RunBuilder::On(const AlignedEvent& event) {
  result_.global = event.global;
  result_.align_report = event.alignment.report;
  // Records in the local world are turned with it; the last record holds the state after the alignment.
  if (result_.spool != nullptr) {
    Keep(result_.spool->Turn(event.alignment));
  }
  for (RunRecord& record : result_.records) {
    record.estimate = TurnIntoEnu(event.alignment, record.estimate);
    record.status = "local";
  }
  if (!result_.records.empty()) {
    RunRecord& record = result_.records.back();
    record.estimate = event.estimate;
    record.clock = event.clock;
    record.status = "ok";
  }
}

void RunBuilder::On(const SatellitesEvent& event) {
  if (result_.spool != nullptr) {
    Keep(result_.spool->Add(event.residuals));
  } else {
    result_.gnss_residuals.push_back(event.residuals);
  }
}

void RunBuilder::On(const WaitingEvent& event) {
  switch (event.sought) {
    case Sought::kStart:
      result_.init_report = event.reason;
      result_.align_report = camera_ ? result_.align_report : event.reason;
      break;
    case Sought::kRestart:
      refusal_ = event.reason;
      break;
    case Sought::kAlignment:
      result_.align_report = event.reason;
      break;
  }
}

void RunBuilder::On(const TooLateEvent& event) {
  On(SkippedEvent{event.sensor, event.stamp_ns, Describe(event)});
}

void RunBuilder::On(const SkippedEvent& event) {
  switch (event.sensor) {
    case Sensor::kImu:
      ++result_.imu_rejected;
      break;
    case Sensor::kCamera:
      result_.skip_report = result_.frames_skipped++ == 0 ? event.reason : result_.skip_report;
      break;
    default:
      if (result_.skipped[event.sensor]++ == 0 && result_.skip_report.empty()) {
        result_.skip_report = event.reason;
      }
      break;
  }
}

void RunBuilder::On(const FailedEvent& event) {
  result_.status = event.status;
}

}  // namespace alidade
