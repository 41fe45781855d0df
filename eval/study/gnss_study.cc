#include "eval/study/gnss_study.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/lever_arm.h"
#include "eval/metrics/nees.h"
#include "eval/metrics/state_pair.h"
#include "eval/metrics/trajectory_alignment.h"
#include "eval/run/gnss_feed.h"
#include "eval/trajectory/trajectory_interpolation.h"

namespace alidade {
namespace {

constexpr double kLaterS = 2;

struct PositionError {
  double time_s = 0;
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Truth and estimate from `from_ns` on, where there is truth.
std::vector<StatePair> PairsSince(const RunResult& run, const Trajectory& truth, TimeNs from_ns) {
  std::vector<StatePair> pairs;
  for (const TrajectoryPoint& point : TrajectoryOf(run).points) {
    const Result<TrajectoryPoint> there = InterpolateTruth(truth, point.stamp_ns);
    if (point.stamp_ns >= from_ns && there.ok()) {
      pairs.push_back({*there, point});
    }
  }
  return pairs;
}

std::vector<PositionError> ErrorsOf(const std::vector<StatePair>& pairs, TimeNs start_ns) {
  std::vector<PositionError> errors;
  errors.reserve(pairs.size());
  for (const StatePair& pair : pairs) {
    errors.push_back({SecondsBetween(start_ns, pair.estimate.stamp_ns),
                      pair.estimate.nav.p_WB - pair.truth.nav.p_WB,
                      pair.estimate.covariance.bottomRightCorner<3, 3>()});
  }
  return errors;
}

/// Over [from, to); NaN without any.
double Rmse(const std::vector<PositionError>& errors, double from_s, double to_s) {
  double sum = 0;
  int count = 0;
  for (const PositionError& e : errors) {
    if (e.time_s >= from_s && e.time_s < to_s) {
      sum += e.error.squaredNorm();
      ++count;
    }
  }
  return count > 0 ? std::sqrt(sum / count) : GnssRunFigures::kNone;
}

/// The last error before satellites return, while it is still that of an outage.
const PositionError* LastBefore(const std::vector<PositionError>& errors, const GnssScenario& scenario) {
  const PositionError* last = nullptr;
  for (const PositionError& e : errors) {
    last = e.time_s >= scenario.outage_start_s && e.time_s < scenario.outage_end_s ? &e : last;
  }
  return last;
}

void ScoreOutage(const std::vector<PositionError>& errors, const GnssScenario& scenario,
                 GnssRunFigures* figures) {
  figures->outage_rmse_m = Rmse(errors, scenario.outage_start_s, scenario.outage_end_s);
  const PositionError* last = LastBefore(errors, scenario);
  if (last == nullptr) {
    return;
  }
  figures->return_error_m = last->error.norm();
  const Eigen::Array3d deviations = last->covariance.diagonal().array().max(0).sqrt();
  figures->return_covered = (last->error.array().abs() <= 3 * deviations).all() ? 1 : 0;
  const auto later = std::find_if(errors.begin(), errors.end(), [&](const PositionError& e) {
    return e.time_s >= scenario.outage_end_s + kLaterS;
  });
  if (later != errors.end()) {
    figures->after_2_s_m = later->error.norm();
  }
}

double LargestStep(const std::vector<PositionError>& errors, double around_s) {
  double largest = GnssRunFigures::kNone;
  for (std::size_t i = 1; i < errors.size(); ++i) {
    if (std::abs(errors[i].time_s - around_s) <= 1) {
      const double step = (errors[i].error - errors[i - 1].error).norm();
      largest = std::isnan(largest) ? step : std::max(largest, step);
    }
  }
  return largest;
}

}  // namespace

GnssScenario ScenarioOf(const SimulatorConfig& config, double duration_s) {
  const SimGnssConfig& gnss = config.gnss;
  GnssScenario scenario;
  scenario.motion_start_s = config.rest_s;
  scenario.clock_jump_s = gnss.clock_jump_at_s;
  const bool has_receiver = gnss.rate_hz > 0;
  const double start_s = has_receiver ? gnss.outage_start_s : config.fix.outage_start_s;
  if (start_s >= 0) {
    scenario.outage_start_s = start_s;
    scenario.outage_end_s =
        std::min(start_s + (has_receiver ? gnss.outage_s : config.fix.outage_s), duration_s);
    scenario.outage_satellites = has_receiver ? gnss.outage_satellites : 0;
  }
  return scenario;
}

GnssRunFigures ScoreGlobalRun(const RunResult& run, const Trajectory& truth, TimeNs start_ns,
                              const GnssScenario& scenario) {
  GnssRunFigures figures;
  if (!run.global) {
    return figures;
  }
  const std::vector<StatePair> pairs = PairsSince(run, truth, run.global->stamp_ns);
  if (pairs.empty()) {
    return figures;
  }
  const double aligned_s = SecondsBetween(start_ns, run.global->stamp_ns);
  const std::vector<PositionError> errors = ErrorsOf(pairs, start_ns);
  const double end_s = errors.back().time_s;
  const double third_s = (end_s - aligned_s) / 3;
  figures.aligned_after_s = std::max(0.0, aligned_s - scenario.motion_start_s);
  figures.rmse_m = Rmse(errors, aligned_s, INFINITY);
  figures.early_m = Rmse(errors, aligned_s, aligned_s + third_s);
  figures.late_m = Rmse(errors, end_s - third_s, INFINITY);
  figures.nees_pos = ComputeNees(pairs).mean_position;
  if (scenario.HasOutage()) {
    ScoreOutage(errors, scenario, &figures);
  }
  if (scenario.clock_jump_s >= 0) {
    figures.jump_step_m = LargestStep(errors, scenario.clock_jump_s);
  }
  return figures;
}

GnssRunFigures ScoreOdometry(const RunResult& run, const Trajectory& truth, TimeNs start_ns,
                             const GnssScenario& scenario) {
  GnssRunFigures figures;
  const std::vector<StatePair> pairs =
      PairsSince(run, truth, start_ns + SecondsToNs(std::max(0.0, scenario.outage_start_s)));
  if (!scenario.HasOutage() || pairs.empty()) {
    return figures;
  }
  const std::vector<PositionError> errors = ErrorsOf(ApplyAlignment(pairs, AnchorAtFirst(pairs)), start_ns);
  figures.outage_rmse_m = Rmse(errors, scenario.outage_start_s, scenario.outage_end_s);
  const PositionError* last = LastBefore(errors, scenario);
  figures.return_error_m = last == nullptr ? GnssRunFigures::kNone : last->error.norm();
  return figures;
}

double SinglePointRmse(const GnssConfig& config, const MeasurementLog& log, const Trajectory& truth) {
  if (log.gnss == nullptr || !log.rig.gnss.anchor_E) {
    return GnssRunFigures::kNone;
  }
  const EnuFrame enu = EnuFrame::At(*log.rig.gnss.anchor_E);
  GnssFeed feed(config, SetupOf(*log.gnss), log.rig.gnss.time_offset_s);
  for (const ObservationEpoch& epoch : log.gnss->epochs) {
    feed.Add(std::shared_ptr<const ObservationEpoch>(log.gnss, &epoch));
  }
  std::vector<PositionError> errors;
  for (; const GnssEpoch* epoch = feed.Next(); feed.Pop()) {
    const Result<TrajectoryPoint> there = InterpolateTruth(truth, epoch->stamp_ns);
    if (!feed.solution() || !there.ok()) {
      continue;
    }
    const Eigen::Vector3d antenna_N = LeverArm{log.rig.gnss.p_BA}.Position(there->nav);
    PositionError& error = errors.emplace_back();
    error.error = enu.FromEcef(feed.solution()->position_E) - antenna_N;
  }
  return Rmse(errors, 0, INFINITY);
}

}  // namespace alidade
