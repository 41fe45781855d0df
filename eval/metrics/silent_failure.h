#pragma once

#include <string>
#include <vector>

#include "core/time.h"

namespace alidade {

/// What a run reported of itself at one instant, and how far it was off.
struct ReportedError {
  TimeNs stamp_ns = 0;
  double nees_pose = 0;  ///< NaN: no regular covariance
  bool alarmed = false;  ///< the status was degraded, suspect or lost
};

/// Whether a run reports that its covariance does not hold. The pose error is beyond n sigma when its NEES
/// exceeds the chi-square quantile (6 degrees of freedom) of the share that a Gaussian has within n
/// sigma: 39.5 for n = 5, 20.1 for n = 3.
struct SilentFailure {
  /// Instants beyond kFailureSigmas without an alarm, where they last longer than kLongestSilenceS: first to
  /// last of each such span, in all [s].
  double silent_s = 0;
  double longest_s = 0;  ///< of these spans
  /// Share of the instants that have an alarm although the error is within kSoundSigmas. NaN without
  /// instants. On clean data these are false alarms. Where data are missing an alarm is right whatever the
  /// error.
  double alarm_inside_share = 0;
};

inline constexpr double kFailureSigmas = 5;
inline constexpr double kSoundSigmas = 3;
inline constexpr double kLongestSilenceS = 5;
inline constexpr double kLongestSpanStepS = 1;  ///< between instants of one span

/// `instants` ascend in time. Spans do not reach over gaps of more than kLongestSpanStepS.
[[nodiscard]] SilentFailure ComputeSilentFailure(const std::vector<ReportedError>& instants);

/// Whether a status of status.csv is an alarm.
[[nodiscard]] bool IsAlarm(const std::string& status);

}  // namespace alidade
