#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/dataset_fix.h"

namespace alidade {
namespace {

/// What the covariances of one sensor's fixes say of its deviation along its least and most certain axis.
struct Deviations {
  double least_m = INFINITY;
  double largest_m = 0;
  double median_m = 0;  ///< of the root mean square over the axes
  bool all_equal = true;
};

Deviations DeviationsOf(const std::vector<const PositionFix*>& fixes) {
  Deviations deviations;
  std::vector<double> means;
  for (const PositionFix* fix : fixes) {
    const Eigen::Vector3d variances =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(fix->covariance, Eigen::EigenvaluesOnly).eigenvalues();
    deviations.least_m = std::min(deviations.least_m, std::sqrt(variances[0]));
    deviations.largest_m = std::max(deviations.largest_m, std::sqrt(variances[2]));
    deviations.all_equal = deviations.all_equal && fix->covariance == fixes.front()->covariance;
    means.push_back(std::sqrt(fix->covariance.trace() / 3));
  }
  std::nth_element(means.begin(), means.begin() + static_cast<std::ptrdiff_t>(means.size() / 2), means.end());
  deviations.median_m = means[means.size() / 2];
  return deviations;
}

void CheckDeviations(const char* name, const std::vector<const PositionFix*>& fixes, Findings* findings) {
  constexpr double kTooSureM = 1e-3;
  constexpr double kTooUnsureM = 100;
  const Deviations deviations = DeviationsOf(fixes);
  findings->Fact(Format("%s: deviation %.3f m in the median, from %.4f to %.3f m%s", name,
                        deviations.median_m, deviations.least_m, deviations.largest_m,
                        deviations.all_equal ? "; all covariances are equal" : ""));
  if (deviations.least_m < kTooSureM) {
    findings->Warning(
        Format("%s: a deviation of %.2g m; is the covariance in m^2?", name, deviations.least_m));
  }
  if (deviations.largest_m > kTooUnsureM) {
    findings->Warning(
        Format("%s: a deviation of %.3g m; is the covariance in m^2?", name, deviations.largest_m));
  }
}

/// Steps between neighbours that no vehicle makes and no deviation explains.
void CheckJumps(const char* name, const std::vector<const PositionFix*>& fixes, Findings* findings) {
  constexpr double kFastestMps = 150;
  constexpr double kDeviations = 6;
  int jumps = 0;
  TimeNs first_ns = 0;
  for (std::size_t i = 1; i < fixes.size(); ++i) {
    const PositionFix& before = *fixes[i - 1];
    const PositionFix& after = *fixes[i];
    const double reach = kFastestMps * SecondsBetween(before.stamp_ns, after.stamp_ns) +
                         kDeviations * std::sqrt(before.covariance.trace() + after.covariance.trace());
    if ((after.p_A - before.p_A).norm() > reach) {
      first_ns = jumps++ == 0 ? after.stamp_ns : first_ns;
    }
  }
  if (jumps > 0) {
    findings->Warning(Format("%s: %d steps faster than %.0f m/s, the first to %lld ns: wrong fixes?", name,
                             jumps, kFastestMps, static_cast<long long>(first_ns)));
  }
}

}  // namespace

void CheckFixes(const Dataset& dataset, Findings* findings) {
  int own_frames = 0;
  for (std::size_t sensor = 0; sensor < dataset.rig.fixes.size(); ++sensor) {
    const FixSensor& sheet = dataset.rig.fixes[sensor];
    const std::string name = "fix" + std::to_string(sensor);
    own_frames += sheet.anchor_llh_deg ? 0 : 1;
    std::vector<const PositionFix*> fixes;
    std::vector<TimeNs> stamps;
    for (const PositionFix& fix : dataset.fixes) {
      if (static_cast<std::size_t>(fix.sensor) == sensor) {
        fixes.push_back(&fix);
        stamps.push_back(fix.stamp_ns);
      }
    }
    CheckStamps(name.c_str(), stamps, 0, kAnyRates, findings);
    if (fixes.empty()) {
      continue;
    }
    const TimeNs offset_ns = SecondsToNs(sheet.time_offset_s);
    CheckSpan(name.c_str(), stamps.front() + offset_ns, stamps.back() + offset_ns, dataset, findings);
    CheckDeviations(name.c_str(), fixes, findings);
    CheckJumps(name.c_str(), fixes, findings);
  }
  if (own_frames > 0 && dataset.rig.fixes.size() > 1) {
    findings->Warning(
        "fix: more than one sensor, and not every sheet has an anchor_llh_deg: frames of their own are not "
        "related, "
        "only fixes in the frame of the first sensor are used");
  }
}

}  // namespace alidade
