#include <utility>

#include "eval/run/estimator_loop.h"

// The first state, and a new one after a loss.

namespace alidade {

Result<NavEstimate> EstimatorLoop::FindStart(const TrackFrame& frame) {
  if (initializer_ != nullptr) {
    return initializer_->AddFrame(frame);
  }
  const TimeNs imu_ns = ImuTime(frame.stamp_ns);
  const std::vector<ImuSample> before = imu_.DeliveredSince(imu_ns);
  if (before.empty() || imu_ns < before.front().stamp_ns) {
    return Status::Input("no IMU sample before the frame at " + FormatSeconds(frame.stamp_ns) + " s");
  }
  return options_.start_state
             ? options_.start_state(imu_ns)
             : Result<NavEstimate>(Status::Config(
                   "init.method: found truth, but no state was given; expected static, dynamic or auto"));
}

void EstimatorLoop::TryStart(const TrackFrame& frame) {
  const Result<NavEstimate> start = FindStart(frame);
  if (!start.ok()) {
    events_.emplace_back(WaitingEvent{Sought::kStart, frame.stamp_ns, start.message()});
    return;
  }
  if (Begin(*start)) {
    StartedEvent event{*start, "given", "a given state"};
    if (initializer_ != nullptr) {
      event.method = initializer_->method();
      event.report = initializer_->report();
      initializer_.reset();
    }
    events_.emplace_back(std::move(event));
  }
}

void EstimatorLoop::TryRestart(const TrackFrame& frame) {
  const Result<NavEstimate> start = recovery_.TryStart(frame);
  if (!start.ok()) {
    events_.emplace_back(WaitingEvent{Sought::kRestart, frame.stamp_ns, start.message()});
    return;
  }
  if (!Begin(*start)) {
    return;
  }
  events_.emplace_back(RestartedEvent{recovery_.lost_ns(), *start, recovery_.method(), recovery_.report()});
  recovery_.Started(*start);
  if (Status status = sensors_.Realign(); !status.ok()) {
    Fail(start->stamp_ns, std::move(status));
  }
}

void EstimatorLoop::StartWithEpoch() {
  const TimeNs tag_ns = gnss()->feed().Next()->measurements.tag_ns;
  const std::optional<GnssInertialStart::Start> start = gnss()->TryStart();
  if (!start) {
    events_.emplace_back(WaitingEvent{Sought::kStart, tag_ns, gnss()->start_report()});
    return;
  }
  if (!Begin(start->estimate)) {
    return;
  }
  events_.emplace_back(StartedEvent{start->estimate, "gnss", gnss()->start_report()});
  if (Status status = sensors_.AlignAtStart(*start); !status.ok()) {
    Fail(start->estimate.stamp_ns, std::move(status));
  } else {
    implied_.Forget();
  }
}

bool EstimatorLoop::Begin(const NavEstimate& start) {
  if (const Status status = estimator_.Initialize(start); !status.ok()) {
    Fail(start.stamp_ns, Status::Diverged("initial state refused: " + status.message()));
    return false;
  }
  phase_ = Phase::kRunning;
  degradation_.Reset();
  implied_.Forget();
  state_ns_ = start.stamp_ns;
  for (const ImuSample& sample : imu_.DeliveredSince(start.stamp_ns)) {
    AddImu(sample);
  }
  return true;
}

}  // namespace alidade
