#include "smoother/batch/batch_estimator.h"

#include <utility>

#include "core/stopwatch.h"
#include "smoother/batch/batch_solver.h"
#include "smoother/sliding/smoother.h"

namespace alidade {
namespace {

/// What became of the observations of each frame.
std::vector<FrameStatistics> CountFeatures(const BatchSequence& sequence) {
  std::vector<FrameStatistics> statistics(sequence.frames().size());
  for (const BatchTrack& track : sequence.tracks()) {
    size_t next = 0;
    const std::vector<WindowView>& used = track.used.views;
    for (const WindowView& view : track.views) {
      FrameStatistics& frame = statistics[static_cast<size_t>(view.frame->index)];
      const bool passed = next < used.size() && used[next].frame == view.frame;
      next += passed ? 1 : 0;
      if (track.views.size() < 2 || !track.used.has_landmark) {
        ++frame.features_waiting;
      } else {
        ++(track.selected && passed ? frame.features_used : frame.features_gated);
      }
    }
  }
  for (size_t i = 0; i < statistics.size(); ++i) {
    statistics[i].observations_invalid = sequence.invalid_observations(static_cast<int>(i));
    statistics[i].at_rest = sequence.frames()[i]->rest.has_value();
    sequence.gnss().Count(static_cast<int>(i), &statistics[i]);
  }
  for (const BatchMeasurement& measurement : sequence.measurements()) {
    SensorStatistics& counts = statistics[static_cast<size_t>(measurement.frame)]
                                   .sensors[SensorOf(measurement.attached.measurement)];
    ++(measurement.weight > 0 ? counts.used : counts.gated);
  }
  return statistics;
}

}  // namespace

std::unique_ptr<Estimator> MakeBatch(const EstimatorConfig& config, const RigCalibration& rig,
                                     std::unique_ptr<Estimator> initial) {
  return std::make_unique<BatchEstimator>(config, rig, std::move(initial));
}

BatchEstimator::BatchEstimator(const EstimatorConfig& config, const RigCalibration& rig,
                               std::unique_ptr<Estimator> initial)
    : config_(config),
      initial_(std::move(initial)),
      imu_(config.imu.max_gap_s),
      read_out_span_s_(ReadOutSpan(GivenCamera(rig, config.vision))),
      sequence_(config, rig) {}

Status BatchEstimator::Initialize(const NavEstimate& initial) {
  ALIDADE_RETURN_IF_ERROR(initial_->Initialize(initial));
  if (!sequence_.Start(initial)) {
    return Status::Input("batch: initial covariance is not positive semi-definite");
  }
  imu_.DropBefore(initial.stamp_ns);
  aligned_ = false;
  accepted_.clear();
  tracks_in_.clear();
  return Status::Ok();
}

Status BatchEstimator::AddImu(const ImuSample& sample) {
  ALIDADE_RETURN_IF_ERROR(initial_->AddImu(sample));
  return imu_.Add(sample);
}

Status BatchEstimator::AddFrame(const TrackFrame& frame) {
  ALIDADE_RETURN_IF_ERROR(initial_->AddFrame(frame));
  ALIDADE_RETURN_IF_ERROR(ReachFrame(initial_->Latest()));
  sequence_.AddTracks(initial_->Latest(), frame);
  accepted_.push_back(sequence_.frames().back()->index);
  tracks_in_.push_back(static_cast<int>(frame.observations.size()));
  return Status::Ok();
}

Status BatchEstimator::ReachFrame(const NavEstimate& estimate) {
  const TimeNs last_ns = sequence_.frames().back()->stamp_ns;
  if (estimate.stamp_ns == last_ns) {
    return Status::Ok();
  }
  std::vector<ImuSample> interval;
  if (const Status status = imu_.Interval(last_ns, estimate.stamp_ns, &interval); !status.ok()) {
    return Status::Diverged("batch: " + status.message());
  }
  sequence_.AddFrame(estimate, std::move(interval), imu_.samples());
  imu_.DropBefore(estimate.stamp_ns, read_out_span_s_);
  return Status::Ok();
}

Status BatchEstimator::Align(const GnssAlignment& alignment) {
  ALIDADE_RETURN_IF_ERROR(initial_->Align(alignment));
  if (!sequence_.Align(alignment)) {
    return Status::Diverged("batch: the aligned prior's covariance is not positive semi-definite");
  }
  aligned_ = true;
  return Status::Ok();
}

Result<std::vector<ImuSample>> BatchEstimator::ReachMeasurement(TimeNs stamp_ns, double max_interpolation_s) {
  const NavEstimate estimate = initial_->Latest();
  const TimeNs last_ns = sequence_.frames().back()->stamp_ns;
  if (estimate.stamp_ns == stamp_ns && SecondsBetween(last_ns, stamp_ns) > max_interpolation_s) {
    ALIDADE_RETURN_IF_ERROR(ReachFrame(estimate));
  }
  std::vector<ImuSample> link;
  const TimeNs frame_ns = sequence_.frames().back()->stamp_ns;
  if (stamp_ns > frame_ns) {
    if (const Status status = imu_.Interval(frame_ns, stamp_ns, &link); !status.ok()) {
      return Status::Diverged("batch: " + status.message());
    }
  }
  return link;
}

Status BatchEstimator::AddGnss(const GnssEpoch& epoch) {
  if (!aligned_) {
    return Status::Diverged("batch: not aligned");
  }
  ALIDADE_RETURN_IF_ERROR(initial_->AddGnss(epoch));
  Result<std::vector<ImuSample>> link = ReachMeasurement(epoch.stamp_ns, config_.gnss.max_interpolation_s);
  ALIDADE_RETURN_IF_ERROR(link.status());
  sequence_.AddGnss(epoch, *std::move(link));
  return Status::Ok();
}

Status BatchEstimator::AddMeasurement(const Measurement& measurement) {
  if (!aligned_) {
    return Status::Diverged("batch: not aligned");
  }
  ALIDADE_RETURN_IF_ERROR(initial_->AddMeasurement(measurement));
  const Sensor sensor = SensorOf(measurement);
  Result<std::vector<ImuSample>> link =
      ReachMeasurement(StampOf(measurement), MaxInterpolation(config_, sensor));
  ALIDADE_RETURN_IF_ERROR(link.status());
  return sequence_.AddMeasurement(measurement, initial_->last_statistics().sensors[sensor].used > 0,
                                  *std::move(link));
}

Result<std::vector<FinalizedFrame>> BatchEstimator::TakeFinalized(const std::atomic<bool>* stop) {
  std::vector<FinalizedFrame> finalized;
  if (sequence_.frames().size() < 2) {
    return finalized;  // the prior is all there is
  }
  const Stopwatch stopwatch;
  const Result<BatchReport> report = SolveBatch(config_, stop, &sequence_);
  if (!report.ok()) {
    return report.status();
  }
  if (report->stopped) {
    return finalized;
  }
  const std::vector<FrameStatistics> statistics = CountFeatures(sequence_);
  const double update_ms = stopwatch.ElapsedMs() / static_cast<double>(accepted_.size());
  for (size_t i = 0; i < accepted_.size(); ++i) {
    const size_t index = static_cast<size_t>(accepted_[i]);
    const WindowFrame& frame = *sequence_.frames()[index];
    FinalizedFrame result;
    result.estimate = {frame.stamp_ns, frame.nav_state(), frame.imu_bias(),
                       report->covariance.smoothed[index]};
    result.statistics = statistics[index];
    result.statistics.tracks_in = tracks_in_[i];
    result.statistics.iterations = report->iterations;
    result.statistics.update_ms = update_ms;
    if (!report->covariance.filtered.empty()) {
      result.filtering_covariance = report->covariance.filtered[index];
    }
    finalized.push_back(std::move(result));
  }
  return finalized;
}

}  // namespace alidade
