#include "eval/study/start_study.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/dense_solvers.h"
#include "core/format.h"
#include "core/lie.h"
#include "core/numbers.h"
#include "core/random.h"
#include "eval/files/csv_text.h"
#include "eval/trajectory/trajectory_interpolation.h"
#include "frontend/initialization/initializer.h"

namespace alidade {
namespace {

constexpr double kGoodScale = 0.05;

double Nees(const NavEstimate& estimate, const Vector15d& error, Eigen::Index size) {
  return error.head(size).dot(
      SymmetricSolver(estimate.covariance.topLeftCorner(size, size)).Solve(error.head(size)).col(0));
}

double ScaleError(const InitializerWindow& window, const Trajectory& truth) {
  if (window.states.empty()) {
    return kNan;
  }
  const Result<TrajectoryPoint> newest = InterpolateTruth(truth, window.stamps_ns.back());
  double estimated = 0;
  double real = 0;
  for (size_t i = 0; newest.ok() && i + 1 < window.states.size(); ++i) {
    const Result<TrajectoryPoint> point = InterpolateTruth(truth, window.stamps_ns[i]);
    if (point.ok()) {
      estimated += (window.states[i].p_WB - window.states.back().p_WB).squaredNorm();
      real += (point->nav.p_WB - newest->nav.p_WB).squaredNorm();
    }
  }
  return real > 0 ? std::abs(std::sqrt(estimated / real) - 1) : kNan;
}

void CompareWithTruth(const Initializer& initializer, const NavEstimate& estimate, const Trajectory& truth,
                      StartOutcome* outcome) {
  outcome->scale_std = initializer.window().relative_scale_std;
  outcome->scale_error = ScaleError(initializer.window(), truth);
  const Result<TrajectoryPoint> point = InterpolateTruth(truth, estimate.stamp_ns);
  if (!point.ok()) {
    return;
  }
  const Vector15d error = GaugeFreeError(estimate, *point);
  outcome->tilt_error_rad = error.head<3>().norm();
  if (truth.has_velocity) {
    outcome->velocity_error_mps = error.segment<3>(6).norm();
    outcome->nees = Nees(estimate, error, 9);
    outcome->nees_all = truth.has_bias ? Nees(estimate, error, 15) : kNan;
  }
}

/// Mean of the finite values; NaN without any.
double Mean(const std::vector<double>& values) {
  double sum = 0;
  int count = 0;
  for (const double value : values) {
    sum += std::isfinite(value) ? value : 0;
    count += std::isfinite(value) ? 1 : 0;
  }
  return count > 0 ? sum / count : kNan;
}

std::string TableRow(const std::string& name, const std::vector<const StartOutcome*>& outcomes) {
  int found = 0;
  int dynamic = 0;
  int good = 0;
  std::vector<double> wait, scale, velocity, nees, nees_all;
  for (const StartOutcome* outcome : outcomes) {
    if (!outcome->found) {
      continue;
    }
    ++found;
    dynamic += outcome->method == "dynamic" ? 1 : 0;
    good += outcome->method == "static" || outcome->scale_error < kGoodScale ? 1 : 0;
    wait.push_back(outcome->waited_s);
    scale.push_back(100 * outcome->scale_error);
    velocity.push_back(outcome->velocity_error_mps);
    nees.push_back(outcome->nees);
    nees_all.push_back(outcome->nees_all);
  }
  return Format("%-14s %6zu %6d %8d %10d %8.2f %8.2f %9.3f %8.2f %8.2f\n", name.c_str(), outcomes.size(),
                found, dynamic, good, Mean(wait), Mean(scale), Mean(velocity), Mean(nees), Mean(nees_all));
}

}  // namespace

Vector15d GaugeFreeError(const NavEstimate& estimate, const TrajectoryPoint& truth) {
  const double yaw = so3::NearestYaw(truth.nav.R_WB * estimate.nav.R_WB.transpose());
  const Eigen::Matrix3d turn = so3::Exp(Eigen::Vector3d(0, 0, -yaw));
  Vector15d error;
  error << so3::Log(estimate.nav.R_WB.transpose() * turn * truth.nav.R_WB), Eigen::Vector3d::Zero(),
      turn * truth.nav.v_WB - estimate.nav.v_WB, truth.bias.gyro - estimate.bias.gyro,
      truth.bias.accel - estimate.bias.accel;
  return error;
}

StartOutcome StartAt(const EstimatorConfig& config, const MeasurementLog& log, const Trajectory& truth,
                     TimeNs start_ns, double limit_s) {
  Initializer initializer(config, log.rig);
  StartOutcome outcome;
  outcome.tilt_error_rad = outcome.velocity_error_mps = outcome.nees = outcome.nees_all = kNan;
  const TimeNs offset_ns = SecondsToNs(log.rig.camera_time_offset_s);
  auto sample = std::lower_bound(log.imu.begin(), log.imu.end(), start_ns + offset_ns,
                                 [](const ImuSample& s, TimeNs stamp) { return s.stamp_ns < stamp; });
  sample -= sample == log.imu.begin() ? 0 : 1;
  for (const TrackFrame& frame : log.frames) {
    if (frame.stamp_ns < start_ns) {
      continue;
    }
    outcome.start_ns = outcome.start_ns == 0 ? frame.stamp_ns : outcome.start_ns;
    if (SecondsBetween(outcome.start_ns, frame.stamp_ns) > limit_s) {
      break;
    }
    outcome.waited_s = SecondsBetween(outcome.start_ns, frame.stamp_ns);
    bool reached = false;
    for (; sample != log.imu.end() && !reached; ++sample) {
      initializer.AddImu(*sample);
      reached = sample->stamp_ns >= frame.stamp_ns + offset_ns;
    }
    const Result<NavEstimate> estimate = initializer.AddFrame(frame);
    outcome.found = estimate.ok();
    outcome.message = estimate.ok() ? initializer.report() : estimate.message();
    if (estimate.ok()) {
      outcome.method = initializer.method();
      CompareWithTruth(initializer, *estimate, truth, &outcome);
      break;
    }
  }
  return outcome;
}

std::vector<StartOutcome> StartOften(const EstimatorConfig& config, const MeasurementLog& log,
                                     const Trajectory& truth, const std::string& sequence, int count,
                                     double limit_s, unsigned seed) {
  std::vector<StartOutcome> outcomes;
  const TimeNs first = log.frames.front().stamp_ns;
  const double span_s = SecondsBetween(first, log.frames.back().stamp_ns) - limit_s;
  RandomStream random(seed, "starts/" + sequence);
  for (int i = 0; span_s > 0 && i < count; ++i) {
    const TimeNs start_ns = first + SecondsToNs(random.Uniform(0, span_s));
    outcomes.push_back(StartAt(config, log, truth, start_ns, limit_s));
    outcomes.back().sequence = sequence;
  }
  return outcomes;
}

std::string StartTable(const std::vector<StartOutcome>& outcomes) {
  std::string table = Format("%-14s %6s %6s %8s %10s %8s %8s %9s %8s %8s\n", "sequence", "starts", "found",
                             "dynamic", "scale<5%", "wait s", "scale %", "v m/s", "NEES 5", "NEES 11");
  std::vector<const StartOutcome*> all;
  for (size_t i = 0; i < outcomes.size();) {
    std::vector<const StartOutcome*> same;
    for (const std::string& name = outcomes[i].sequence; i < outcomes.size() && outcomes[i].sequence == name;
         ++i) {
      same.push_back(&outcomes[i]);
    }
    table += TableRow(same.front()->sequence, same);
    all.insert(all.end(), same.begin(), same.end());
  }
  return table + TableRow("all", all);
}

std::string StartCsv(const std::vector<StartOutcome>& outcomes) {
  std::string text =
      "sequence,start_ns,found,method,waited_s,scale_error,scale_std,tilt_error_rad,velocity_error_mps,nees,"
      "nees_all,message\n";
  for (const StartOutcome& outcome : outcomes) {
    text += outcome.sequence + "," + std::to_string(outcome.start_ns) + "," + (outcome.found ? "1," : "0,") +
            outcome.method;
    for (const double value :
         {outcome.waited_s, outcome.scale_error, outcome.scale_std, outcome.tilt_error_rad,
          outcome.velocity_error_mps, outcome.nees, outcome.nees_all}) {
      text += Format(",%.6g", value);
    }
    text += "," + CsvText(outcome.message) + "\n";
  }
  return text;
}

}  // namespace alidade
