#include "eval/run/degradation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/format.h"
#include "core/imu_gap.h"

namespace alidade {
namespace {

std::string Contradicts(const AbsoluteSource& source) {
  const auto& [sensor, index] = source;
  if (sensor == Sensor::kGnss) {
    return "GNSS contradicts";
  }
  return Format("%s (%s%d) contradict", PluralNameOf(sensor), std::string(ToString(sensor)).c_str(), index);
}

}  // namespace

void Degradation::OnImu(TimeNs stamp_ns, const std::string& doubt, std::optional<TimeNs> unit_changed_ns) {
  if (unit_changed_ns == stamp_ns) {
    unit_until_ns_ = stamp_ns + SecondsToNs(kSettlingS);
  }
  if (last_imu_ns_ != INT64_MIN && SecondsBetween(last_imu_ns_, stamp_ns) > imu_gap::kMinGapS) {
    silent_until_ns_ = stamp_ns;
    silence_s_ = SecondsBetween(last_imu_ns_, stamp_ns);
  }
  last_imu_ns_ = stamp_ns;
  if (!doubt.empty()) {
    doubtful_until_ns_ = stamp_ns + SecondsToNs(kSettlingS);
    doubt_ = doubt;
  }
}

bool Degradation::IsFrozen(const TrackFrame& frame) {
  size_t common = 0;
  bool moved = false;
  auto before = shown_.begin();
  for (const TrackObservation& now : frame.observations) {
    while (before != shown_.end() && before->track_id < now.track_id) {
      ++before;
    }
    if (before != shown_.end() && before->track_id == now.track_id) {
      ++common;
      moved = moved || before->pixel != now.pixel;
    }
  }
  shown_ = frame.observations;
  frozen_ = common >= kMinFrozen && !moved;
  return frozen_;
}

bool Degradation::TracksGoOn(TimeNs imu_ns) const {
  return sighted_ns_ == INT64_MIN || SecondsBetween(sighted_ns_, imu_ns) <= kMaxFrozenS;
}

void Degradation::OnAbsolute(Sensor sensor, const AbsoluteComparison& comparison) {
  absolute_.try_emplace({sensor, comparison.index});
  for (auto& [source, monitor] : absolute_) {
    if (source == AbsoluteSource(sensor, comparison.index)) {
      monitor.Add(comparison);
    } else {
      monitor.AddCorrection(comparison);
    }
  }
}

std::string Degradation::AgainstSensors(const char* by) const {
  for (const auto& [source, monitor] : absolute_) {
    if (const std::optional<Contradiction>& found = monitor.contradiction()) {
      return Format("%s %s: %.1f m (%.1f sigma) from the predicted position within %.0f s",
                    Contradicts(source).c_str(), by, found->distance_m, found->sigmas, found->window_s);
    }
  }
  return {};
}

std::string Degradation::AbsoluteHint() const {
  const auto found = std::find_if(absolute_.begin(), absolute_.end(),
                                  [](const auto& entry) { return entry.second.sigmas() > kHintSigmas; });
  return found == absolute_.end() ? std::string() : "; or " + Contradicts(found->first) + " vision and IMU";
}

std::optional<double> Degradation::LargeInnovations(TimeNs imu_ns, const FrameStatistics& statistics) {
  const double kept = dof_ > 0 ? std::exp(-SecondsBetween(weighed_ns_, imu_ns) / kInnovationsS) : 0;
  weighed_ns_ = imu_ns;
  nis_ = kept * nis_ + statistics.nis;
  dof_ = kept * dof_ + statistics.nis_dof;
  constexpr double kSigmas = 3;
  const double bound = kMaxInnovations + kSigmas * std::sqrt(2 / dof_);
  return dof_ > 0 && nis_ > bound * dof_ ? std::optional(nis_ / dof_) : std::nullopt;
}

Degradation::Verdict Degradation::Check(TimeNs imu_ns, const FrameStatistics& statistics,
                                        const CalibrationDoubt* doubt) {
  const std::optional<double> innovations = LargeInnovations(imu_ns, statistics);
  if (statistics.tracks_in > 0 || sighted_ns_ == INT64_MIN) {
    sighted_ns_ = imu_ns;
  }
  if (jump_until_ns_ == INT64_MAX) {
    jump_until_ns_ = imu_ns + SecondsToNs(kSettlingS);
  }
  if (std::string reason = FaultOfData(imu_ns); !reason.empty()) {
    return {std::move(reason), DegradationKind::kData};
  }
  return {DoubtOfModel(innovations, doubt), DegradationKind::kModel};
}

std::string Degradation::FaultOfData(TimeNs imu_ns) const {
  if (imu_ns < jump_until_ns_) {
    return Format("the %s's clock jumped by %.3f s, which is taken off its stamps", jumped_, jump_s_);
  }
  if (frozen_) {
    return "the image did not change at all";
  }
  const double blind_s = SecondsBetween(sighted_ns_, imu_ns);
  if (blind_s > kMaxBlindS) {
    return Format("no tracks for %.2f s", blind_s);
  }
  if (silent_until_ns_ != INT64_MIN && SecondsBetween(silent_until_ns_, imu_ns) < kSettlingS) {
    return Format("the IMU was silent for %.2f s", silence_s_);
  }
  if (imu_ns < doubtful_until_ns_) {
    return doubt_;
  }
  if (imu_ns < unit_until_ns_) {
    return "the gyroscope changed its unit and is converted to rad/s";
  }
  return AgainstSensors("vision and IMU");
}

std::string Degradation::DoubtOfModel(const std::optional<double>& innovations,
                                      const CalibrationDoubt* doubt) const {
  const bool doubted = doubt != nullptr && doubt->sigmas >= kMaxDoubtSigmas;
  if (doubted && doubt->pose_sigmas >= kMaxPoseSigmas) {
    return Format("%s is not as given: off by %.3g %s (%.1f sigma), which moves the pose by %.1f sigma",
                  doubt->parameter, doubt->error, doubt->unit, doubt->sigmas, doubt->pose_sigmas) +
           AbsoluteHint();
  }
  if (innovations) {
    const std::string cause =
        doubted            ? Format("%s is not as given (%.1f sigma)", doubt->parameter, doubt->sigmas)
        : doubt != nullptr ? "the camera fits, so the noise of pixels or IMU is larger than given"
                           : "noise, extrinsics, lens or time offset are not as given";
    return Format("innovations are %.2f times as large as predicted: ", std::sqrt(*innovations)) + cause;
  }
  return {};
}

}  // namespace alidade
