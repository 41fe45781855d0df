#include "eval/run/sensor_runs.h"

namespace alidade {

SensorRuns::SensorRuns(const EstimatorConfig& config, const RigCalibration& rig,
                       const SessionOptions& options, Estimator* estimator,
                       std::vector<SessionEvent>* events) {
  if (config.gnss.enabled && options.gnss) {
    gnss_.emplace(config, rig, *options.gnss, options.lateness.gnss_s, estimator, events);
    all_.push_back(&*gnss_);
  }
  measurements_ = MakeMeasurementRuns(config, rig, options, gnss_.has_value(), estimator, events);
  for (const std::unique_ptr<MeasurementRun>& run : measurements_) {
    all_.push_back(run.get());
  }
}

MeasurementRun* SensorRuns::measurements(Sensor sensor) {
  for (const std::unique_ptr<MeasurementRun>& run : measurements_) {
    if (run->sensor() == sensor) {
      return run.get();
    }
  }
  return nullptr;
}

Result<std::optional<GnssAlignment>> SensorRuns::Align(TimeNs stamp_ns, const Eigen::Vector3d& gyro_radps) {
  if (gnss_) {
    Result<std::optional<GnssAlignment>> alignment = gnss_->Align(stamp_ns, gyro_radps);
    if (alignment.ok() && *alignment) {
      PassAlignment(gnss_->enu(), nullptr);
    }
    return alignment;
  }
  for (const std::unique_ptr<MeasurementRun>& run : measurements_) {
    Result<std::optional<GnssAlignment>> alignment = run->Align(stamp_ns);
    if (!alignment.ok()) {
      return alignment;
    }
    if (*alignment) {
      PassAlignment((*alignment)->enu, run.get());
      return alignment;
    }
  }
  return std::optional<GnssAlignment>();
}

Status SensorRuns::AlignAtStart(const GnssInertialStart::Start& start) {
  Status status = gnss_->AlignAtStart(start);
  if (status.ok()) {
    PassAlignment(gnss_->enu(), nullptr);
  }
  return status;
}

Status SensorRuns::Realign() {
  Status status = gnss_ ? gnss_->Realign() : Status::Ok();
  for (size_t i = 0; i < measurements_.size() && status.ok(); ++i) {
    status = measurements_[i]->Realign();
  }
  return status;
}

void SensorRuns::PassAlignment(const std::optional<EnuFrame>& enu, const MeasurementRun* by) {
  for (const std::unique_ptr<MeasurementRun>& run : measurements_) {
    if (run.get() != by) {
      run->AlignedByAnother(enu);
    }
  }
}

}  // namespace alidade
