#include "eval/metrics/association.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/format.h"
#include "eval/metrics/tool_association.h"
#include "eval/trajectory/trajectory_interpolation.h"

namespace alidade {
namespace {

/// Below this no alignment has a unique answer.
constexpr std::size_t kMinimumPairs = 3;
/// Longest tolerance accepted [s]: 30 years; keeps its nanoseconds far from overflow.
constexpr double kMaximumTolerance = 1e9;

/// A truth row and an estimate row that may become a pair.
struct Candidate {
  TimeNs distance_ns = 0;
  std::size_t truth = 0;
  std::size_t estimate = 0;
};

std::string Seconds(double value) {
  return Format("%.6g", value);
}

TimeNs Distance(TimeNs a, TimeNs b) {
  return a < b ? b - a : a - b;
}

/// Whether two stamps are within the tolerance. At Unix time doubles of seconds, which evo and the rpg tools
/// keep, have steps of 0.24 us: there stamps that differ by the tolerance exactly are decided as those tools
/// do.
bool IsWithin(TimeNs a, TimeNs b, double max_dt_s) {
  constexpr TimeNs kDoublesHoldNanoseconds = (TimeNs{1} << 22) * kSecondNs;
  if (std::max(a, b) < kDoublesHoldNanoseconds) {
    return Distance(a, b) <= SecondsToNs(max_dt_s);
  }
  return std::abs(ToDoubleSeconds(a) - ToDoubleSeconds(b)) <= max_dt_s;
}

/// One-to-one pairs, nearest first, sorted by time. An estimate competes only for the truth rows on either
/// side of it: one that loses both never takes a farther row, so that pairs never cross in time.
std::vector<Candidate> MatchNearest(const Trajectory& truth, const Trajectory& estimate, double max_dt_s) {
  std::vector<Candidate> candidates;
  candidates.reserve(2 * estimate.points.size());
  for (std::size_t e = 0; e < estimate.points.size(); ++e) {
    const TimeNs stamp = estimate.points[e].stamp_ns;
    const std::size_t after = FirstAtOrAfter(truth.points, stamp);
    for (std::size_t t = after == 0 ? 0 : after - 1; t <= after && t < truth.points.size(); ++t) {
      if (IsWithin(stamp, truth.points[t].stamp_ns, max_dt_s)) {
        candidates.push_back({Distance(stamp, truth.points[t].stamp_ns), t, e});
      }
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance_ns < b.distance_ns; });

  std::vector<bool> truth_taken(truth.points.size(), false);
  std::vector<bool> estimate_taken(estimate.points.size(), false);
  std::vector<Candidate> matches;
  for (const Candidate& candidate : candidates) {
    if (!truth_taken[candidate.truth] && !estimate_taken[candidate.estimate]) {
      truth_taken[candidate.truth] = true;
      estimate_taken[candidate.estimate] = true;
      matches.push_back(candidate);
    }
  }
  std::sort(matches.begin(), matches.end(),
            [](const Candidate& a, const Candidate& b) { return a.estimate < b.estimate; });
  return matches;
}

/// Every estimate that has a truth row at its stamp or lies between two rows at most `max_gap_ns` apart.
std::vector<StatePair> PairByInterpolation(const Trajectory& truth, const Trajectory& estimate,
                                           TimeNs max_gap_ns) {
  std::vector<StatePair> pairs;
  for (const TrajectoryPoint& point : estimate.points) {
    const std::size_t after = FirstAtOrAfter(truth.points, point.stamp_ns);
    if (after == truth.points.size()) {
      break;
    }
    const TrajectoryPoint& next = truth.points[after];
    if (next.stamp_ns == point.stamp_ns) {
      pairs.push_back({next, point});
    } else if (after > 0 && next.stamp_ns - truth.points[after - 1].stamp_ns <= max_gap_ns) {
      pairs.push_back({Interpolate(truth.points[after - 1], next, point.stamp_ns), point});
    }
  }
  return pairs;
}

std::vector<StatePair> PairByTool(const Trajectory& truth, const Trajectory& estimate,
                                  const AssociationOptions& options) {
  const auto match = options.method == EvaluationTool::kEvo ? MatchAsEvo : MatchAsRpg;
  std::vector<StatePair> pairs;
  for (const auto& [t, e] : match(truth, estimate, options.max_dt_s)) {
    pairs.push_back({truth.points[t], estimate.points[e]});
  }
  return pairs;
}

std::vector<StatePair> PairByNearest(const Trajectory& truth, const Trajectory& estimate, double max_dt_s) {
  std::vector<StatePair> pairs;
  for (const Candidate& match : MatchNearest(truth, estimate, max_dt_s)) {
    pairs.push_back({truth.points[match.truth], estimate.points[match.estimate]});
  }
  return pairs;
}

std::string DescribeRange(const std::string& name, const Trajectory& trajectory) {
  return name + " " + FormatSeconds(trajectory.points.front().stamp_ns) + " to " +
         FormatSeconds(trajectory.points.back().stamp_ns) + " s (" +
         std::to_string(trajectory.points.size()) + " rows)";
}

double Span(const Trajectory& trajectory) {
  return SecondsBetween(trajectory.points.front().stamp_ns, trajectory.points.back().stamp_ns);
}

/// Seconds between rows, on average.
double RowInterval(const Trajectory& trajectory) {
  return Span(trajectory) / static_cast<double>(trajectory.points.size() - 1);
}

/// A hint where one file's time unit is a power of a thousand off. Spans and row intervals are compared, not
/// stamps: a clock's origin does not reveal its unit, and a short piece of a log has its intervals. Empty
/// when units seem equal.
std::string UnitHint(const Trajectory& truth, const Trajectory& estimate) {
  if (Span(truth) <= 0 || Span(estimate) <= 0) {
    return {};
  }
  struct Unit {
    double factor;
    const char* names;
  };
  const double ratio = std::max(Span(truth) / Span(estimate), Span(estimate) / Span(truth));
  const double interval_ratio =
      std::max(RowInterval(truth) / RowInterval(estimate), RowInterval(estimate) / RowInterval(truth));
  for (const Unit& unit : {Unit{1e9, "nanoseconds and seconds"}, Unit{1e6, "microseconds and seconds"},
                           Unit{1e3, "milliseconds and seconds"}}) {
    // Wide for the interval: rates from 1 Hz to 200 Hz meet, a thousandth does not.
    const bool span_fits = ratio > unit.factor / 4 && ratio < unit.factor * 4;
    if (span_fits && interval_ratio > unit.factor / 30) {
      const char* longer = Span(truth) > Span(estimate) ? "truth" : "estimate";
      return std::string("the ") + longer + " lasts about " + Seconds(unit.factor) +
             " times as long as the other: " + unit.names + " mixed up?";
    }
  }
  return {};
}

/// By how much the clocks differ when the ranges do not meet. Empty when they do.
std::string OffsetHint(const Trajectory& truth, const Trajectory& estimate) {
  const bool apart = truth.points.front().stamp_ns > estimate.points.back().stamp_ns ||
                     truth.points.back().stamp_ns < estimate.points.front().stamp_ns;
  if (!apart) {
    return {};
  }
  const double offset = SecondsBetween(estimate.points.front().stamp_ns, truth.points.front().stamp_ns);
  return "the ranges do not overlap: the truth starts " + Seconds(std::abs(offset)) + " s " +
         (offset > 0 ? "after" : "before") +
         " the estimate; a constant offset between the two clocks (start of log, UTC against GPS time)?";
}

/// How far apart the truth rows around the estimate's stamps are. Precondition: the ranges overlap.
std::string GapHint(const Trajectory& truth, const Trajectory& estimate) {
  std::vector<TimeNs> gaps;
  for (const TrajectoryPoint& point : estimate.points) {
    const std::size_t after = FirstAtOrAfter(truth.points, point.stamp_ns);
    if (after > 0 && after < truth.points.size()) {
      gaps.push_back(truth.points[after].stamp_ns - truth.points[after - 1].stamp_ns);
    }
  }
  if (gaps.size() < kMinimumPairs) {
    return "only " + std::to_string(gaps.size()) + " estimate stamps are between truth rows";
  }
  std::sort(gaps.begin(), gaps.end());
  return "the truth rows around the estimate's stamps are " +
         Seconds(static_cast<double>(gaps[gaps.size() / 2]) * kNsToSeconds) +
         " s apart (median): a longer max_gap, or nearest rows instead of interpolation";
}

/// Which tolerance would have matched. Precondition: the ranges overlap.
std::string ToleranceHint(const Trajectory& truth, const Trajectory& estimate,
                          const AssociationOptions& options) {
  if (options.interpolate) {
    return GapHint(truth, estimate);
  }
  std::vector<Candidate> matches = MatchNearest(truth, estimate, kMaximumTolerance);
  if (matches.size() < kMinimumPairs) {
    return "no tolerance would match more than " + std::to_string(matches.size());
  }
  std::sort(matches.begin(), matches.end(),
            [](const Candidate& a, const Candidate& b) { return a.distance_ns < b.distance_ns; });
  // The median keeps rows far outside the overlap from inflating the advice.
  const std::size_t wanted = std::max(matches.size() / 2, kMinimumPairs - 1);
  const double needed = static_cast<double>(matches[wanted].distance_ns) * kNsToSeconds;
  return "a max_dt of " + Seconds(needed * 1.001) + " s would match at least " + std::to_string(wanted + 1) +
         "; or interpolate the truth";
}

Status TooFewPairs(const Trajectory& truth, const Trajectory& estimate, const AssociationOptions& options,
                   std::size_t count) {
  const std::string tolerance = options.interpolate
                                    ? "interpolating over at most " + Seconds(options.max_gap_s)
                                    : "within a max_dt of " + Seconds(options.max_dt_s);
  std::string message = "only " + std::to_string(count) + " pairs of truth and estimate " + tolerance +
                        " s, expected at least " + std::to_string(kMinimumPairs) + ": " +
                        DescribeRange("truth", truth) + ", " + DescribeRange("estimate", estimate);
  std::string hint = UnitHint(truth, estimate);
  if (hint.empty()) {
    hint = OffsetHint(truth, estimate);
  }
  if (hint.empty()) {
    hint = ToleranceHint(truth, estimate, options);
  }
  return Status::Input(message + "; " + hint);
}

/// A tolerance [s] must be finite, not negative and no longer than the longest log.
Status CheckTolerance(const char* name, double value) {
  if (value >= 0 && value <= kMaximumTolerance) {
    return Status::Ok();
  }
  return Status::Usage(std::string(name) + ": found " + Seconds(value) + ", expected 0 to " +
                       Seconds(kMaximumTolerance) + " s");
}

Status CheckOptions(const AssociationOptions& options) {
  ALIDADE_RETURN_IF_ERROR(CheckTolerance("max_dt", options.max_dt_s));
  ALIDADE_RETURN_IF_ERROR(CheckTolerance("max_gap", options.max_gap_s));
  ALIDADE_RETURN_IF_ERROR(CheckTolerance("time_offset", std::abs(options.time_offset_s)));
  if (options.interpolate && options.method != EvaluationTool::kAlidade) {
    return Status::Usage("interpolate: " + std::string(ToString(options.method)) +
                         " pairs rows; only association alidade interpolates the truth");
  }
  return Status::Ok();
}

Trajectory Shifted(Trajectory trajectory, double offset_s) {
  for (TrajectoryPoint& point : trajectory.points) {
    point.stamp_ns += SecondsToNs(offset_s);
  }
  return trajectory;
}

std::vector<StatePair> Pair(const Trajectory& truth, const Trajectory& estimate,
                            const AssociationOptions& options) {
  if (options.method != EvaluationTool::kAlidade) {
    return PairByTool(truth, estimate, options);
  }
  return options.interpolate ? PairByInterpolation(truth, estimate, SecondsToNs(options.max_gap_s))
                             : PairByNearest(truth, estimate, options.max_dt_s);
}

}  // namespace

Result<std::vector<StatePair>> Associate(const Trajectory& truth, const Trajectory& estimate,
                                         const AssociationOptions& options) {
  ALIDADE_RETURN_IF_ERROR(CheckOptions(options));
  if (options.time_offset_s != 0) {
    AssociationOptions shifted = options;
    shifted.time_offset_s = 0;
    return Associate(truth, Shifted(estimate, options.time_offset_s), shifted);
  }
  for (const Trajectory* trajectory : {&truth, &estimate}) {
    if (trajectory->points.size() < kMinimumPairs) {
      return Status::Input(std::string(trajectory == &truth ? "the truth" : "the estimate") + " has " +
                           std::to_string(trajectory->points.size()) + " rows, expected at least " +
                           std::to_string(kMinimumPairs));
    }
  }
  std::vector<StatePair> pairs = Pair(truth, estimate, options);
  if (pairs.size() < kMinimumPairs) {
    return TooFewPairs(truth, estimate, options, pairs.size());
  }
  return pairs;
}

}  // namespace alidade
