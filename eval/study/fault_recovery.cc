#include "eval/study/fault_recovery.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <unordered_map>

#include "eval/metrics/nees.h"
#include "eval/simulation/fault_span.h"

namespace alidade {
namespace {

using Rows = std::span<const RunInstant>;

bool ChangesAllLaterData(SimFaultKind fault) {
  return fault == SimFaultKind::kCameraClock || fault == SimFaultKind::kImuClock ||
         fault == SimFaultKind::kImuUnit;
}

/// When the estimate of a lost row was given up: later than its stamp.
TimeNs GivenUpAt(const RunResult& run, TimeNs stamp_ns) {
  const auto loss = std::find_if(run.restarts.begin(), run.restarts.end(),
                                 [=](const Restart& restart) { return restart.lost_ns >= stamp_ns; });
  return loss == run.restarts.end() ? stamp_ns : loss->lost_ns;
}

/// The rows over kRecoveryWindowS that begin with row `first`; empty: the run ends before, or is interrupted.
Rows WindowAt(const std::vector<RunInstant>& run, std::size_t first) {
  const TimeNs end_ns = run[first].reported.stamp_ns + SecondsToNs(kRecoveryWindowS);
  for (std::size_t i = first + 1; i < run.size(); ++i) {
    const TimeNs stamp_ns = run[i].reported.stamp_ns;
    if (SecondsBetween(run[i - 1].reported.stamp_ns, stamp_ns) > kLongestSpanStepS) {
      break;
    }
    if (stamp_ns >= end_ns) {
      return Rows(run).subspan(first, i + 1 - first);
    }
  }
  return {};
}

/// From `from_ns` to the first window that `accept` takes.
template <typename Accept>
double FirstWindowAfter(const std::vector<RunInstant>& run, TimeNs from_ns, const Accept& accept) {
  for (std::size_t i = 0; i < run.size(); ++i) {
    const TimeNs stamp_ns = run[i].reported.stamp_ns;
    if (stamp_ns < from_ns) {
      continue;
    }
    const Rows window = WindowAt(run, i);
    if (!window.empty() && accept(window)) {
      return SecondsBetween(from_ns, stamp_ns);
    }
  }
  return FaultFigures::kNever;
}

/// Over the rows of [from, to]; NaN without any, or where an error is unknown.
double Rmse(const std::vector<RunInstant>& run, TimeNs from_ns, TimeNs to_ns) {
  double sum = 0;
  int count = 0;
  const auto first = std::lower_bound(
      run.begin(), run.end(), from_ns,
      [](const RunInstant& row, TimeNs stamp_ns) { return row.reported.stamp_ns < stamp_ns; });
  for (auto row = first; row != run.end() && row->reported.stamp_ns <= to_ns; ++row) {
    sum += row->error_m * row->error_m;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : kNan;
}

double ReportedAfter(const std::vector<RunInstant>& run, TimeNs begin_ns) {
  const auto first = std::find_if(run.begin(), run.end(),
                                  [=](const RunInstant& row) { return !row.ok && row.known_ns >= begin_ns; });
  return first == run.end() ? FaultFigures::kNever : SecondsBetween(begin_ns, first->known_ns);
}

double OkAfter(const std::vector<RunInstant>& run, TimeNs end_ns) {
  double after_s = FaultFigures::kNever;
  for (const RunInstant& row : run) {
    if (!row.ok) {
      after_s = FaultFigures::kNever;
    } else if (row.reported.stamp_ns >= end_ns && std::isinf(after_s)) {
      after_s = SecondsBetween(end_ns, row.reported.stamp_ns);
    }
  }
  return after_s;
}

double CoveredAfter(const std::vector<RunInstant>& run, TimeNs end_ns) {
  const double limit = NeesOfSigmas(3, 6);
  return FirstWindowAfter(run, end_ns, [=](Rows window) {
    return std::all_of(window.begin(), window.end(),
                       [=](const RunInstant& row) { return row.reported.nees_pose < limit; });
  });
}

double AccurateAfter(const std::vector<RunInstant>& run, TimeNs end_ns,
                     const std::vector<RunInstant>* clean) {
  const double limit = NeesOfSigmas(3, 3);
  return FirstWindowAfter(run, end_ns, [&](Rows window) {
    if (clean == nullptr) {
      return std::all_of(window.begin(), window.end(),
                         [=](const RunInstant& row) { return row.nees_position < limit; });
    }
    const TimeNs from_ns = window.front().reported.stamp_ns;
    const TimeNs to_ns = window.back().reported.stamp_ns;
    return Rmse(run, from_ns, to_ns) < kRecoveredErrorRatio * Rmse(*clean, from_ns, to_ns);
  });
}

double LongestSilence(const std::vector<RunInstant>& run, TimeNs begin_ns) {
  std::vector<ReportedError> reported;
  bool known = false;
  for (const RunInstant& row : run) {
    if (row.reported.stamp_ns >= begin_ns) {
      reported.push_back(row.reported);
      known = known || !std::isnan(row.reported.nees_pose);
    }
  }
  return known ? ComputeSilentFailure(reported).longest_s : kNan;
}

}  // namespace

FaultTimes FaultTimesOf(const SimulatorConfig& config, TimeNs start_ns, TimeNs last_ns) {
  if (config.fault == SimFaultKind::kStaleEphemerides) {
    return {start_ns, std::nullopt};
  }
  const FaultSpan span(config, start_ns);
  const TimeNs end_ns = ChangesAllLaterData(config.fault) ? span.begin_ns : span.end_ns;
  const bool goes_on = SecondsBetween(end_ns, last_ns) >= kRecoveryWindowS;
  return {span.begin_ns, goes_on ? std::optional(end_ns) : std::nullopt};
}

std::vector<RunInstant> InstantsOf(const RunResult& run, const Trajectory& truth,
                                   const EvaluationOptions& options) {
  std::vector<RunInstant> rows;
  std::unordered_map<TimeNs, std::size_t> row_at;
  for (const RunRecord& record : run.records) {
    const TimeNs stamp_ns = record.estimate.stamp_ns;
    row_at[stamp_ns] = rows.size();
    RunInstant& row = rows.emplace_back();
    row.reported = {stamp_ns, kNan, IsAlarm(record.status)};
    row.ok = record.status == "ok" || record.status == "local";
    row.known_ns = record.status == "lost" ? GivenUpAt(run, stamp_ns) : stamp_ns;
  }
  if (rows.empty() || truth.points.empty()) {
    return rows;
  }
  const Result<Evaluation> evaluation = Evaluate(truth, TrajectoryOf(run), options);
  for (std::size_t i = 0; evaluation.ok() && i < evaluation->pairs.size(); ++i) {
    const StatePair& pair = evaluation->pairs[i];
    const auto found = row_at.find(evaluation->EstimateStamp(pair));
    if (found == row_at.end()) {
      continue;
    }
    RunInstant& row = rows[found->second];
    row.error_m = (pair.estimate.nav.p_WB - pair.truth.nav.p_WB).norm();
    row.reported.nees_pose = evaluation->nees ? evaluation->nees->pose[i] : kNan;
    row.nees_position = evaluation->nees ? evaluation->nees->position[i] : kNan;
  }
  return rows;
}

FaultFigures ScoreFault(const std::vector<RunInstant>& run, const FaultTimes& times,
                        const std::vector<RunInstant>* clean) {
  FaultFigures figures;
  figures.reported_after_s = ReportedAfter(run, times.begin_ns);
  figures.silent_s = LongestSilence(run, times.begin_ns);
  figures.beside_clean = clean != nullptr;
  if (times.end_ns) {
    figures.ok_after_s = OkAfter(run, *times.end_ns);
    figures.covered_after_s = CoveredAfter(run, *times.end_ns);
    figures.accurate_after_s = AccurateAfter(run, *times.end_ns, clean);
  }
  return figures;
}

}  // namespace alidade
