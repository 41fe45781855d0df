#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/format.h"
#include "eval/dataset/dataset_check_rig.h"
#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/dataset_fix.h"

namespace alidade {
namespace {

/// The deviation by the covariances of one sensor's fixes, along its least and most certain axis.
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

/// Whether a position looks as if it were counted from the Earth's centre. The grids of maps have such
/// northings, but no such heights.
bool IsEarthCentred(const Eigen::Vector3d& position) {
  constexpr double kLeastRadiusM = 6.33e6, kMostRadiusM = 6.40e6, kHighestM = 1e4;
  return position.norm() > kLeastRadiusM && position.norm() < kMostRadiusM &&
         std::abs(position.z()) > kHighestM;
}

/// A position where nobody is likely to be.
struct OddPlace {
  const char* expected;
  bool impossible;
};

std::optional<OddPlace> OddPlaceOf(const Eigen::Vector3d& position, bool has_anchor) {
  constexpr double kFarM = 1e5;      // beyond what most recordings travel; aircraft and ships go further
  constexpr double kEarthM = 6.4e6;  // its radius
  // Eastings of grids that begin with the zone, as those of CGCS2000 and Gauss-Krueger, reach 6e7.
  constexpr double kGridM = 1e8;
  if (IsEarthCentred(position)) {
    return OddPlace{"ENU coordinates: is it ECEF?", true};
  }
  if (has_anchor && position.norm() > kFarM) {
    return OddPlace{"within 100 km of anchor_llh_deg: another anchor, or another unit?",
                    position.norm() > kEarthM};
  }
  if (position.norm() > kGridM) {
    return OddPlace{"a place on the Earth: another unit?", true};
  }
  return std::nullopt;
}

/// Positions where nobody was: an error when most are impossible.
void CheckPlaces(const char* name, bool has_anchor, const std::vector<const PositionFix*>& fixes,
                 Findings* findings) {
  constexpr std::size_t kManyFixes = 10;
  const PositionFix* first = nullptr;
  const char* expected = "";
  std::size_t absurd = 0;
  std::size_t impossible = 0;
  bool all_equal = true;
  for (const PositionFix* fix : fixes) {
    if (const std::optional<OddPlace> odd = OddPlaceOf(fix->p_A, has_anchor)) {
      if (absurd++ == 0) {
        first = fix;
        expected = odd->expected;
      }
      impossible += odd->impossible ? 1 : 0;
    }
    all_equal = all_equal && fix->p_A == fixes.front()->p_A;
  }
  if (first != nullptr) {
    const std::string text = Format(
        "%s: %zu of %zu positions are absurd, the first of %lld ns: found p_x, p_y, p_z [%.6g, %.6g, %.6g] "
        "m, expected %s",
        name, absurd, fixes.size(), static_cast<long long>(first->stamp_ns), first->p_A.x(), first->p_A.y(),
        first->p_A.z(), expected);
    if (2 * impossible > fixes.size()) {
      findings->Error(text);
    } else {
      findings->Warning(text);
    }
  }
  if (all_equal && fixes.size() >= kManyFixes) {
    findings->Warning(Format(
        "%s: all %zu fixes are at one place, expected at least noise: does the receiver repeat its last "
        "one?",
        name, fixes.size()));
  }
}

/// Steps between neighbours that no vehicle makes and no deviation explains; an error when most are beyond
/// any vehicle on or above the ground.
void CheckJumps(const char* name, const std::vector<const PositionFix*>& fixes, Findings* findings) {
  constexpr double kFastestMps = 150;
  constexpr double kImpossibleMps = 1000;
  constexpr double kDeviations = 6;
  int jumps = 0;
  std::size_t impossible = 0;
  TimeNs first_ns = 0;
  for (std::size_t i = 1; i < fixes.size(); ++i) {
    const PositionFix& before = *fixes[i - 1];
    const PositionFix& after = *fixes[i];
    const double step_s = SecondsBetween(before.stamp_ns, after.stamp_ns);
    const double beyond = (after.p_A - before.p_A).norm() -
                          kDeviations * std::sqrt(before.covariance.trace() + after.covariance.trace());
    impossible += beyond > kImpossibleMps * step_s ? 1 : 0;
    if (beyond > kFastestMps * step_s) {
      first_ns = jumps++ == 0 ? after.stamp_ns : first_ns;
    }
  }
  if (fixes.size() > 3 && 2 * impossible > fixes.size() - 1) {
    findings->Error(Format("%s: %zu of %zu steps are faster than %.0f m/s: positions in another unit than m?",
                           name, impossible, fixes.size() - 1, kImpossibleMps));
  } else if (jumps > 0) {
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
    CheckAntenna(dataset, name, sheet.p_BA, sheet.time_offset_s, findings);
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
    const TimeNs first_ns = stamps.front() + offset_ns;
    const TimeNs last_ns = stamps.back() + offset_ns;
    if (CheckSpan(name.c_str(), first_ns, last_ns, dataset, findings)) {
      CheckTimeWithoutImu(name.c_str(), first_ns, last_ns, stamps.size(), dataset, findings);
      CheckTimeWithoutSensor(name.c_str(), first_ns, last_ns, stamps.size(), dataset, findings);
    }
    CheckDeviations(name.c_str(), fixes, findings);
    CheckPlaces(name.c_str(), sheet.anchor_llh_deg.has_value(), fixes, findings);
    CheckJumps(name.c_str(), fixes, findings);
  }
  if (own_frames > 0 && dataset.rig.fixes.size() > 1) {
    findings->Warning(
        "fix: more than one sensor, and not every sheet has an anchor_llh_deg: frames of their own are not "
        "related, only fixes in the frame of the first sensor are used");
  }
}

}  // namespace alidade
