#include "eval/metrics/silent_failure.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>

#include "core/numbers.h"

namespace alidade {
namespace {

constexpr double kMaxStepS = 1;

/// NEES of a pose that a Gaussian of `sigmas` is as unlikely as.
double NeesOf(double sigmas) {
  const boost::math::chi_squared pose(6);
  return boost::math::quantile(boost::math::complement(pose, std::erfc(sigmas / std::numbers::sqrt2)));
}

}  // namespace

bool IsAlarm(const std::string& status) {
  return status == "degraded" || status == "suspect" || status == "lost";
}

SilentFailure ComputeSilentFailure(const std::vector<ReportedError>& instants) {
  const double failure = NeesOf(kFailureSigmas);
  const double sound = NeesOf(kSoundSigmas);
  SilentFailure result;
  double span_s = 0;
  int known = 0;
  int alarmed_inside = 0;
  const ReportedError* before = nullptr;  // of the span
  const auto end_span = [&] {
    result.silent_s += span_s > kLongestSilenceS ? span_s : 0;
    span_s = 0;
    before = nullptr;
  };
  for (const ReportedError& instant : instants) {
    known += std::isnan(instant.nees_pose) ? 0 : 1;
    alarmed_inside += instant.alarmed && instant.nees_pose <= sound ? 1 : 0;
    const bool silent = !instant.alarmed && instant.nees_pose > failure;
    const double step_s = before == nullptr ? 0 : SecondsBetween(before->stamp_ns, instant.stamp_ns);
    if (!silent || step_s > kMaxStepS) {
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
