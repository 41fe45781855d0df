#include "eval/run/fix_run.h"

namespace alidade {

FixRun::FixRun(const EstimatorConfig& config, const RigCalibration& rig, bool with_gnss, Estimator* estimator)
    : estimator_(*estimator),
      feed_(rig, with_gnss),
      aligner_(config.fix, rig.fixes, feed_.enu()),
      with_gnss_(with_gnss) {}

Result<FixRun::Outcome> FixRun::Take() {
  const PositionFix fix = *feed_.Next();
  feed_.Pop();
  if (!aligned_) {
    if (!with_gnss_) {
      aligner_.AddFix(fix);
    }
    return Outcome::kAligning;
  }
  const Status status = estimator_.AddFix(fix);
  if (status.code() == StatusCode::kInput) {
    return Outcome::kRefused;
  }
  return status.ok() ? Result<Outcome>(Outcome::kTaken) : status;
}

Result<std::optional<GnssAlignment>> FixRun::Align(const NavEstimate& estimate) {
  std::optional<GnssAlignment> alignment;
  if (aligned_ || with_gnss_) {
    return alignment;
  }
  aligner_.AddState(estimate);
  alignment = aligner_.TryAlign();
  if (alignment) {
    ALIDADE_RETURN_IF_ERROR(estimator_.Align(*alignment));
    aligned_ = true;
    alignment_ = alignment;
  }
  return alignment;
}

void FixRun::AlignedByGnss(const EnuFrame& enu) {
  feed_.SetFrame(enu);
  aligned_ = true;
}

Status FixRun::Realign() {
  if (!alignment_) {
    return Status::Ok();
  }
  GnssAlignment identity = *alignment_;
  identity.stamp_ns = estimator_.Latest().stamp_ns;
  identity.yaw_rad = 0;
  identity.p_NW.setZero();
  identity.covariance = 1e-12 * Eigen::Matrix4d::Identity();
  return estimator_.Align(identity);
}

}  // namespace alidade
