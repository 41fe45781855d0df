#include "gnss/positioning/time_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/format.h"
#include "gnss/base/gnss_time.h"
#include "gnss/positioning/single_point.h"
#include "gnss/positioning/single_point_options.h"
#include "gnss/positioning/single_point_solution.h"

namespace alidade {
namespace {

constexpr TimeNs kRolloverNs = 1024 * kWeekNs;
constexpr std::size_t kSampledEpochs = 8;

/// Up to kSampledEpochs epochs, evenly over the log.
std::vector<const ObservationEpoch*> Sample(const GnssLog& log) {
  const std::size_t step = std::max<std::size_t>(1, log.epochs.size() / kSampledEpochs);
  std::vector<const ObservationEpoch*> sampled;
  for (std::size_t i = 0; i < log.epochs.size() && sampled.size() < kSampledEpochs; i += step) {
    sampled.push_back(&log.epochs[i]);
  }
  return sampled;
}

ObservationEpoch Shifted(const ObservationEpoch& epoch, TimeNs offset_ns) {
  ObservationEpoch shifted = epoch;
  shifted.stamp_ns += offset_ns;
  return shifted;
}

MeasurementBuilder MakeBuilder(const GnssLog& log) {
  GnssCorrectionOptions options;
  options.ionosphere = IonosphereMode::kNone;
  return {log.catalog, options, log.glonass_channels};
}

/// From the stamp to the reference time of the nearest broadcast ephemeris, signed; 0 without any.
TimeNs ToNearestEphemeris(const NavigationData& navigation, TimeNs stamp_ns) {
  TimeNs nearest = 0;
  bool any = false;
  const auto consider = [&](const auto& by_satellite) {
    for (const auto& [satellite, ephemerides] : by_satellite) {
      for (const auto& ephemeris : ephemerides) {
        const TimeNs apart = ephemeris.toe_ns - stamp_ns;
        nearest = !any || std::abs(apart) < std::abs(nearest) ? apart : nearest;
        any = true;
      }
    }
  };
  consider(navigation.kepler);
  consider(navigation.glonass);
  return nearest;
}

bool AnyUsable(const MeasurementBuilder& builder, const std::vector<const ObservationEpoch*>& epochs,
               TimeNs offset_ns) {
  return std::any_of(epochs.begin(), epochs.end(), [&](const ObservationEpoch* epoch) {
    return !builder.Prepare(Shifted(*epoch, offset_ns)).satellites.empty();
  });
}

/// Median of the robust deviation of the single points' residuals with the tags shifted, in the deviations
/// that are expected; infinite where fewer than half of the epochs have a redundant solution.
double MedianScale(const GnssLog& log, const MeasurementBuilder& builder,
                   const std::vector<const ObservationEpoch*>& epochs, TimeNs offset_ns) {
  constexpr int kLeastRedundancy = 2;
  std::vector<double> scales;
  for (const ObservationEpoch* epoch : epochs) {
    // Anew each time: nothing is carried from one offset or epoch to the next.
    SinglePointSolver solver(builder, SinglePointOptions(), log.approximate_position_E);
    const Result<SinglePointSolution> solution = solver.Solve(Shifted(*epoch, offset_ns));
    const bool redundant =
        solution.ok() && static_cast<int>(solution->satellites.size()) >= 4 + kLeastRedundancy;
    scales.push_back(redundant ? solution->scale : std::numeric_limits<double>::infinity());
  }
  if (scales.empty()) {
    return std::numeric_limits<double>::infinity();
  }
  const auto middle = scales.begin() + static_cast<std::ptrdiff_t>(scales.size() / 2);
  std::nth_element(scales.begin(), middle, scales.end());
  return *middle;
}

Status RolloverFault(const GnssLog& log, std::int64_t periods) {
  return Status::Input(
      Format("the observations' dates need %+lld weeks: they begin at %s, no ephemeris covers them, and "
             "%+lld s later they do; expected GPST (a receiver whose week number rolled over)",
             1024 * static_cast<long long>(periods), FormatGpsTime(log.epochs.front().stamp_ns, 0).c_str(),
             static_cast<long long>(periods) * (kRolloverNs / kSecondNs)));
}

/// `scale`, `mended`: of single points without and with the offset.
Status SecondsFault(const GnssLog& log, int offset_s, double scale, double mended) {
  const int leap_seconds = LeapSeconds(log.epochs.front().stamp_ns);
  const char* reason = offset_s == leap_seconds    ? " (tags in UTC: the leap seconds are missing)"
                       : offset_s == -leap_seconds ? " (the leap seconds were added to GPST)"
                       : offset_s == 14            ? " (tags in BDT)"
                       : offset_s == -19           ? " (tags in TAI)"
                                                   : "";
  const std::string as_they_are =
      std::isfinite(scale) ? Format("leave %.3g expected deviations", scale) : "are not found";
  return Status::Input(Format("the observations' tags need %+d s: single points ", offset_s) + as_they_are +
                       Format(", with it they leave %.2g; expected GPST", mended) + reason);
}

}  // namespace

GnssCoverage CheckCoverage(const GnssLog& log) {
  const MeasurementBuilder builder = MakeBuilder(log);
  GnssCoverage coverage;
  coverage.nearest_s = std::numeric_limits<double>::infinity();
  for (const ObservationEpoch* epoch : Sample(log)) {
    const EpochMeasurements prepared = builder.Prepare(*epoch);
    ++coverage.epochs;
    coverage.usable_epochs += prepared.satellites.empty() ? 0 : 1;
    coverage.faults.Add(prepared.left_out);
    const TimeNs apart = ToNearestEphemeris(log.catalog->navigation(), epoch->stamp_ns);
    coverage.nearest_s = std::min(coverage.nearest_s, std::abs(SecondsBetween(0, apart)));
  }
  return coverage;
}

Status CheckTags(const GnssLog& log) {
  const std::vector<const ObservationEpoch*> epochs = Sample(log);
  const MeasurementBuilder builder = MakeBuilder(log);
  if (!AnyUsable(builder, epochs, 0)) {
    const TimeNs apart =
        epochs.empty() ? 0 : ToNearestEphemeris(log.catalog->navigation(), epochs.front()->stamp_ns);
    const auto periods = static_cast<std::int64_t>(
        std::llround(static_cast<double>(apart) / static_cast<double>(kRolloverNs)));
    return periods != 0 && AnyUsable(builder, epochs, periods * kRolloverNs) ? RolloverFault(log, periods)
                                                                             : Status::Ok();
  }
  // A second moves the satellites by kilometres against each other. Atmosphere, reflections and a stale
  // ephemeris stay well below the first threshold, and no shift of the tags mends them.
  constexpr double kSuspiciousScale = 100;
  constexpr double kMendedShare = 0.05;
  constexpr int kLargestOffsetS = 40;  // TAI - UTC is 37 s
  const double scale = MedianScale(log, builder, epochs, 0);
  if (scale < kSuspiciousScale) {
    return Status::Ok();
  }
  int best_s = 0;
  double best = scale;
  for (int offset_s = -kLargestOffsetS; offset_s <= kLargestOffsetS; ++offset_s) {
    const double shifted = MedianScale(log, builder, epochs, offset_s * kSecondNs);
    if (shifted < best) {
      best = shifted;
      best_s = offset_s;
    }
  }
  const bool found = best_s != 0 && best < kSuspiciousScale && !(best > kMendedShare * scale);
  return found ? SecondsFault(log, best_s, scale, best) : Status::Ok();
}

}  // namespace alidade
