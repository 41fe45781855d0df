#include "eval/metrics/silent_failure.h"

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "eval/metrics/nees.h"

namespace alidade {
namespace {

constexpr int kPoseDof = 6;

}  // namespace

bool IsAlarm(const std::string& status) {
  return status == "degraded" || status == "suspect" || status == "lost";
}

SilentFailure ComputeSilentFailure(const std::vector<ReportedError>& instants) {
  const double failure = NeesOfSigmas(kFailureSigmas, kPoseDof);
  const double sound = NeesOfSigmas(kSoundSigmas, kPoseDof);
  SilentFailure result;
  double span_s = 0;
  int known = 0;
  int alarmed_inside = 0;
  const ReportedError* before = nullptr;  // of the span
  const auto end_span = [&] {
    if (span_s > kLongestSilenceS) {
      result.silent_s += span_s;
      result.longest_s = std::max(result.longest_s, span_s);
    }
    span_s = 0;
    before = nullptr;
  };
  for (const ReportedError& instant : instants) {
    known += std::isnan(instant.nees_pose) ? 0 : 1;
    alarmed_inside += instant.alarmed && instant.nees_pose <= sound ? 1 : 0;
    const bool silent = !instant.alarmed && instant.nees_pose > failure;
    const double step_s = before == nullptr ? 0 : SecondsBetween(before->stamp_ns, instant.stamp_ns);
    if (!silent || step_s > kLongestSpanStepS) {
      end_span();
    }
    if (silent) {
      span_s += before == nullptr ? 0 : step_s;
      before = &instant;
    }
  }
  end_span();
  result.alarm_inside_share = known > 0 ? static_cast<double>(alarmed_inside) / known : kNan;
  return result;
}

}  // namespace alidade
