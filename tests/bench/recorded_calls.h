#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "core/estimator/estimator.h"
#include "eval/dataset/dataset.h"
#include "eval/record/run_options.h"
#include "eval/record/runner.h"
#include "eval/run/make_estimator.h"

namespace alidade::test {

using EstimatorCall = std::variant<ImuSample, TrackFrame, GnssAlignment, GnssEpoch>;

/// What one run called of its estimator, in order, after its start.
struct RecordedCalls {
  EstimatorConfig config;
  RigCalibration rig;
  NavEstimate initial;
  std::vector<EstimatorCall> calls;  ///< the last one is an epoch
  std::size_t steady = 0;            ///< call from which on the run counts as steady; a frame
};

/// Hands every call on to an estimator and keeps it.
class CallRecorder final : public Estimator {
 public:
  explicit CallRecorder(RecordedCalls* recorded)
      : recorded_(*recorded), estimator_(MakeEstimator(recorded->config, recorded->rig)) {}

  Status Initialize(const NavEstimate& initial) override {
    recorded_.initial = initial;
    recorded_.calls.clear();
    return estimator_->Initialize(initial);
  }
  Status AddImu(const ImuSample& sample) override {
    recorded_.calls.emplace_back(sample);
    return estimator_->AddImu(sample);
  }
  Status AddFrame(const TrackFrame& frame) override {
    recorded_.calls.emplace_back(frame);
    return estimator_->AddFrame(frame);
  }
  Status Align(const GnssAlignment& alignment) override {
    recorded_.calls.emplace_back(alignment);
    return estimator_->Align(alignment);
  }
  Status AddGnss(const GnssEpoch& epoch) override {
    recorded_.calls.emplace_back(epoch);
    return estimator_->AddGnss(epoch);
  }
  std::optional<ClockState> LatestClock() const override { return estimator_->LatestClock(); }
  const AbsoluteCorrection* last_correction() const override { return estimator_->last_correction(); }
  const GnssResiduals* last_gnss() const override { return estimator_->last_gnss(); }
  NavEstimate Latest() const override { return estimator_->Latest(); }
  bool initialized() const override { return estimator_->initialized(); }
  const FrameStatistics& last_statistics() const override { return estimator_->last_statistics(); }
  std::optional<CalibrationEstimate> LatestCalibration() const override {
    return estimator_->LatestCalibration();
  }

 private:
  RecordedCalls& recorded_;
  std::unique_ptr<Estimator> estimator_;
};

/// Runs an estimator over a simulated sequence with GNSS from its true start. `frames`: that pass after the
/// alignment before the run is steady. kInput: it did not align, or ended too early.
inline Result<RecordedCalls> RecordCalls(const EstimatorConfig& config, Dataset dataset, int frames) {
  RecordedCalls recorded{config, dataset.rig, {}, {}, 0};
  recorded.config.init.method = InitMethod::kTruth;
  recorded.config.recovery.enabled = false;
  const std::optional<Trajectory> truth = dataset.truth;
  RunOptions options;
  options.truth = truth ? &*truth : nullptr;
  CallRecorder recorder(&recorded);
  const RunResult run = RunEstimator(recorded.config, MeasurementsOf(std::move(dataset)), options, &recorder);
  ALIDADE_RETURN_IF_ERROR(run.status);
  std::vector<EstimatorCall>& calls = recorded.calls;
  while (!calls.empty() && !std::holds_alternative<GnssEpoch>(calls.back())) {
    calls.pop_back();
  }
  const auto aligned = std::find_if(calls.begin(), calls.end(), [](const EstimatorCall& call) {
    return std::holds_alternative<GnssAlignment>(call);
  });
  const auto steady = std::find_if(aligned, calls.end(), [&](const EstimatorCall& call) {
    return std::holds_alternative<TrackFrame>(call) && frames-- == 0;
  });
  if (steady == calls.end()) {
    return Status::Input("the run is too short after its alignment: " + run.align_report);
  }
  recorded.steady = static_cast<std::size_t>(steady - calls.begin());
  return recorded;
}

/// Makes the same calls of a new estimator.
class Replay {
 public:
  /// Begins at the steady part.
  explicit Replay(const RecordedCalls& recorded)
      : recorded_(recorded), estimator_(MakeEstimator(recorded.config, recorded.rig)) {
    status_ = estimator_->Initialize(recorded.initial);
    while (next_ < recorded.steady) {
      Step();
    }
  }

  [[nodiscard]] bool AtEnd() const { return next_ == recorded_.calls.size(); }
  template <typename Argument>
  [[nodiscard]] bool NextIs() const {
    return std::holds_alternative<Argument>(recorded_.calls[next_]);
  }
  /// Makes the next call.
  void Step() {
    const EstimatorCall& call = recorded_.calls[next_++];
    Status status;
    if (const auto* imu = std::get_if<ImuSample>(&call)) {
      status = estimator_->AddImu(*imu);
    } else if (const auto* frame = std::get_if<TrackFrame>(&call)) {
      status = estimator_->AddFrame(*frame);
    } else if (const auto* epoch = std::get_if<GnssEpoch>(&call)) {
      status = estimator_->AddGnss(*epoch);
    } else {
      status = estimator_->Align(std::get<GnssAlignment>(call));
    }
    if (status_.ok() && !status.ok()) {
      status_ = status;
    }
  }
  /// The first call that failed.
  [[nodiscard]] const Status& status() const { return status_; }
  [[nodiscard]] const FrameStatistics& statistics() const { return estimator_->last_statistics(); }

 private:
  const RecordedCalls& recorded_;
  std::unique_ptr<Estimator> estimator_;
  Status status_;
  std::size_t next_ = 0;
};

}  // namespace alidade::test
