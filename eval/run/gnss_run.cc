#include "eval/run/gnss_run.h"

#include <cmath>
#include <utility>

namespace alidade {
namespace {

void Add(const FrameStatistics& epoch, FrameStatistics* sum) {
  sum->satellites_used += epoch.satellites_used;
  sum->satellites_gated += epoch.satellites_gated;
  sum->gnss_nis += epoch.gnss_nis;
  sum->gnss_nis_dof += epoch.gnss_nis_dof;
  sum->clock_jump = sum->clock_jump || epoch.clock_jump;
  sum->propagate_ms += epoch.propagate_ms;
  sum->update_ms += epoch.update_ms;
}

}  // namespace

GnssRun::GnssRun(const EstimatorConfig& config, const MeasurementLog& log, Estimator* estimator,
                 RunResult* result)
    : log_(log),
      estimator_(*estimator),
      result_(*result),
      feed_(config.gnss, log),
      aligner_(config.gnss, log.rig.gnss),
      start_(config, log.rig) {}

void GnssRun::TakeEpoch() {
  const GnssEpoch& epoch = *feed_.Next();
  if (result_.global && estimator_.initialized()) {
    AddEpoch(epoch);
  } else if (result_.global) {
    ++result_.epochs_skipped;
  } else {
    aligner_.AddEpoch(epoch, feed_.approximate_E(), feed_.solution());
  }
  feed_.Pop();
}

void GnssRun::AddEpoch(const GnssEpoch& epoch) {
  Status status = estimator_.AddGnss(epoch);
  if (status.code() == StatusCode::kInput) {
    if (result_.epochs_skipped++ == 0 && result_.skip_report.empty()) {
      result_.skip_report = status.message();
    }
    return;
  }
  if (!status.ok()) {
    result_.status = std::move(status);
    return;
  }
  ++result_.epochs_used;
  Add(estimator_.last_statistics(), &epochs_);
  CollectResiduals();
}

void GnssRun::CollectResiduals() {
  const GnssResiduals* residuals = estimator_.last_gnss();
  const bool is_new =
      residuals != nullptr && !residuals->satellites.empty() &&
      (result_.gnss_residuals.empty() || result_.gnss_residuals.back().stamp_ns < residuals->stamp_ns);
  if (is_new) {
    result_.gnss_residuals.push_back(*residuals);
  }
}

void GnssRun::Align(TimeNs stamp_ns, const Eigen::Vector3d& gyro_radps) {
  if (result_.global || !estimator_.initialized()) {
    return;
  }
  const NavEstimate latest = estimator_.Latest();
  if (latest.stamp_ns != stamp_ns) {
    return;  // the frame was refused
  }
  aligner_.AddState(stamp_ns, latest.nav, latest.bias, gyro_radps, latest.covariance.block<3, 3>(6, 6));
  const std::optional<GnssAlignment> alignment = aligner_.TryAlign();
  result_.align_report = aligner_.report();
  if (!alignment) {
    return;
  }
  if (Status status = estimator_.Align(*alignment); !status.ok()) {
    result_.status = std::move(status);
    return;
  }
  alignment_ = alignment;
  feed_.ShiftTime(alignment->time_offset_s);
  result_.align_report = alignment->report;
  SetGlobal(*alignment, stamp_ns);
  // What was told in the local world is turned with it; the last record tells the state as it now stands.
  for (RunRecord& record : result_.records) {
    record.estimate = TurnIntoEnu(*alignment, record.estimate);
    record.status = "local";
  }
  if (!result_.records.empty()) {
    RunRecord& record = result_.records.back();
    record.estimate = estimator_.Latest();
    record.clock = estimator_.LatestClock();
    record.status = "ok";
  }
}

void GnssRun::Realign() {
  if (!alignment_) {
    return;
  }
  // The state stands in the ENU frame already, its uncertainty there included.
  GnssAlignment identity = *alignment_;
  identity.yaw_rad = 0;
  identity.p_NW.setZero();
  identity.covariance = 1e-12 * Eigen::Matrix4d::Identity();
  for (const RunRecord& record : result_.records) {
    if (record.clock) {
      identity.clock = record.clock->mean;
      identity.stamp_ns = record.estimate.stamp_ns;
    }
  }
  result_.status = estimator_.Align(identity);
}

std::optional<GnssInertialStart::Start> GnssRun::TryStart() {
  start_.AddEpoch(*feed_.Next(), feed_.solution());
  feed_.Pop();
  std::optional<GnssInertialStart::Start> start = start_.TryStart();
  result_.align_report = result_.init_report = start_.report();
  return start;
}

void GnssRun::AlignAtStart(const GnssInertialStart::Start& start) {
  result_.init_method = "gnss";
  result_.status = estimator_.Align(start.alignment);
  feed_.ShiftTime(start.alignment.time_offset_s);
  SetGlobal(start.alignment, start.estimate.stamp_ns);
  const Eigen::Matrix3d& R_WB = start.estimate.nav.R_WB;
  const Eigen::Matrix3d attitude = R_WB * start.estimate.covariance.topLeftCorner<3, 3>() * R_WB.transpose();
  result_.global->yaw_std_rad = std::sqrt(attitude(2, 2));
}

void GnssRun::SetGlobal(const GnssAlignment& alignment, TimeNs stamp_ns) {
  result_.global = {*alignment.enu,        log_.rig.gnss.p_BA, stamp_ns,
                    feed_.time_offset_s(), alignment.yaw_rad,  std::sqrt(alignment.covariance(0, 0))};
}

void GnssRun::Tell(FrameStatistics* statistics) {
  CollectResiduals();  // the smoother judges an epoch with the frame after it
  Add(epochs_, statistics);
  epochs_ = {};
}

}  // namespace alidade
