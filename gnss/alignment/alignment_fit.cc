#include "gnss/alignment/alignment_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/calibration.h"
#include "core/dense_solvers.h"
#include "core/robust.h"
#include "core/yaw_shift.h"
#include "gnss/model/receiver_clock.h"
#include "gnss/positioning/robust_fit.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Columns of the unknowns; then clock and drift of each sample.
constexpr Index kYaw = 0;
constexpr Index kShift = 1;  // directly after the yaw, as in YawShift::ParameterJacobian
constexpr Index kOffset = 4;
constexpr Index kVelocity = 5;
constexpr Index kState = 8;  // the columns before act on the state
constexpr Index kBiases = 8;
constexpr Index kClocks = 12;

/// Of a difference nothing is known of.
constexpr double kFreeDriftStdMps = 1e4;

Index ClockColumn(std::size_t sample) {
  return kClocks + 2 * static_cast<Index>(sample);
}

}  // namespace

/// Normal equations of scalar rows.
class AlignmentFit::NormalEquations {
 public:
  using Row = std::vector<std::pair<Index, double>>;

  explicit NormalEquations(Index size)
      : hessian(MatrixXd::Zero(size, size)), gradient(VectorXd::Zero(size)) {}

  /// Adds weight (residual + row x)^2 / deviation^2; the row's columns may repeat none.
  void Add(const Row& row, double residual, double deviation, double weight = 1) {
    const double scale = weight / (deviation * deviation);
    for (const auto& [i, a] : row) {
      gradient[i] += scale * a * residual;
      for (const auto& [j, b] : row) {
        hessian(i, j) += scale * a * b;
      }
    }
  }

  MatrixXd hessian;
  VectorXd gradient;
};

/// The rows of a sample, and what the unknowns but the clock do to its state, in the canonical chart.
struct AlignmentFit::Epoch {
  std::vector<GnssRow> rows;  ///< their deviations with the estimate's own
  Eigen::Matrix<double, 15, kState> chart = Eigen::Matrix<double, 15, kState>::Zero();
};

AlignmentGuess::AlignmentGuess(double yaw, const Vector3d& shift, std::size_t samples)
    : yaw_rad(yaw), p_NW(shift), clock_m(samples, 0), drift_mps(samples, 0), clock_known(samples, false) {}

AlignmentFit::AlignmentFit(const GnssConfig& config, const AntennaMount& mount,
                           std::vector<const AlignmentSample*> samples)
    : config_(config), mount_(mount), samples_(std::move(samples)) {}

double AlignmentFit::EpochsOfOneError() const {
  constexpr double kCorrelationS =
      2;  // of a new estimate's velocity error, until vision has observed bias and tilt
  const double window_s = SecondsBetween(samples_.front()->state.stamp_ns, samples_.back()->state.stamp_ns);
  return std::max(1.0,
                  kCorrelationS * static_cast<double>(samples_.size()) / std::max(window_s, kCorrelationS));
}

AlignmentFit::Epoch AlignmentFit::Linearize(std::size_t index, AlignmentGuess* guess) const {
  const AlignmentState& state = samples_[index]->state;
  const YawShift transform{guess->yaw_rad, guess->p_NW};
  const Eigen::Matrix3d R_NW = transform.Rotation();
  GnssPoint point{state.nav, state.bias, state.gyro_radps, guess->biases};
  const double since_newest_s = SecondsBetween(samples_.back()->state.stamp_ns, state.stamp_ns);
  point.nav = transform * NavState{state.nav.R_WB, state.nav.p_WB + since_newest_s * guess->dv_W,
                                   state.nav.v_WB + guess->dv_W};
  // Where the epoch's offset puts the state.
  const Vector3d acceleration_N = R_NW * state.acceleration_W;
  const Vector3d omega_B = state.gyro_radps - state.bias.gyro;
  const Pose T_NB = BodyAfter(point.nav.T_WB(), BodyRates(omega_B, point.nav.v_WB), guess->time_offset_s);
  point.nav = {T_NB.rotation, T_NB.translation, point.nav.v_WB + guess->time_offset_s * acceleration_N};
  point.clock[ClockState::kClock] = guess->clock_m[index];
  point.clock[ClockState::kDrift] = guess->drift_mps[index];
  Epoch epoch;
  GnssResiduals residuals;
  epoch.rows = LinearizeEpoch(config_, mount_, point, samples_[index]->measurements, &residuals);
  if (!guess->clock_known[index]) {
    const double common = CommonStep(epoch.rows);
    guess->clock_m[index] += common;
    guess->clock_known[index] = true;
    for (GnssRow& row : epoch.rows) {
      row.residual += row.is_rate ? 0 : common;
    }
  }
  // The velocity's error changes over the window too: what changes is the row's own. But it is one error of
  // three axes for all satellites of an epoch and for the epochs of a while, not one for each row.
  const double rows_of_one_error = 0.5 * static_cast<double>(epoch.rows.size()) / 3 * EpochsOfOneError();
  const Eigen::Matrix3d variance_N =
      std::max(1.0, rows_of_one_error) * R_NW * state.velocity_covariance_W * R_NW.transpose();
  for (GnssRow& row : epoch.rows) {
    const Eigen::RowVector3d e = row.jacobian.segment<3>(6) + since_newest_s * row.jacobian.segment<3>(3);
    row.deviation = std::sqrt(row.deviation * row.deviation + e.dot(e * variance_N));
  }
  epoch.chart.block<9, 4>(0, kYaw) = transform.ParameterJacobian(point.nav);
  epoch.chart.block<6, 1>(0, kOffset) = BodyRates(omega_B, point.nav.v_WB);
  epoch.chart.block<3, 1>(6, kOffset) = acceleration_N;
  epoch.chart.block<3, 3>(3, kVelocity) = since_newest_s * R_NW;
  epoch.chart.block<3, 3>(6, kVelocity) = R_NW;
  return epoch;
}

void AlignmentFit::AddEpoch(std::size_t index, const Options& options, AlignmentGuess* guess,
                            NormalEquations* system, AlignmentStep* step,
                            std::vector<double>* whitened) const {
  const Epoch epoch = Linearize(index, guess);
  for (const GnssRow& row : epoch.rows) {
    const Eigen::Matrix<double, 1, kState> shared = row.jacobian * epoch.chart;
    const double r = row.residual / row.deviation;
    const double kernel = RobustWeight(config_.robust_kernel, config_.robust_scale_sigma, r * r);
    const double weight = std::abs(r) < options.gate_sigma ? (options.robust ? kernel : 1) : 0;
    step->cost += kernel * r * r;
    whitened->push_back(r);
    NormalEquations::Row entries = {{kShift, shared[1]},
                                    {kShift + 1, shared[2]},
                                    {kShift + 2, shared[3]},
                                    {kVelocity, shared[kVelocity]},
                                    {kVelocity + 1, shared[kVelocity + 1]},
                                    {kVelocity + 2, shared[kVelocity + 2]},
                                    {ClockColumn(index) + (row.is_rate ? 1 : 0), 1.0}};
    if (options.yaw_free) {
      entries.emplace_back(kYaw, shared[kYaw]);
      entries.emplace_back(kOffset, shared[kOffset]);
    }
    if (!row.is_rate && row.bias_index >= 0) {
      entries.emplace_back(kBiases + row.bias_index - ClockState::kBiases, 1.0);
    }
    system->Add(entries, row.residual, row.deviation, weight * row.information);
  }
}

void AlignmentFit::AddClockProcess(const AlignmentGuess& guess, NormalEquations* system) const {
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    const Index column = ClockColumn(k);
    system->Add({{column + 1, 1.0}}, guess.drift_mps[k], kFreeDriftStdMps);
    if (k + 1 == samples_.size()) {
      break;
    }
    const double dt_s = SecondsBetween(samples_[k]->state.stamp_ns, samples_[k + 1]->state.stamp_ns);
    const ClockTransition transition = PropagateClock(config_, dt_s);
    const double mean_drift = 0.5 * (guess.drift_mps[k] + guess.drift_mps[k + 1]);
    const double step = guess.clock_m[k + 1] - guess.clock_m[k] - mean_drift * dt_s;
    constexpr double kFloor = 1e-3;
    const double walk = config_.clock_walk_m_sqrts * std::sqrt(dt_s) + kFloor;
    if (std::abs(step) < config_.clock_jump_m || std::abs(mean_drift) < kFloor) {
      const bool settled = std::abs(step) < config_.clock_jump_m;
      system->Add({{column, -1.0}, {column + 2, 1.0}, {column + 1, -0.5 * dt_s}, {column + 3, -0.5 * dt_s}},
                  step, settled ? walk : kFreeDriftStdMps);
    }
    system->Add({{column + 1, -1.0}, {column + 3, 1.0}}, guess.drift_mps[k + 1] - guess.drift_mps[k],
                std::sqrt(transition.q(1, 1)) + kFloor);
  }
}

void AlignmentFit::AddPriors(const Options& options, const AlignmentGuess& guess,
                             NormalEquations* system) const {
  constexpr double kFarM = 1e5;
  constexpr double kHeld = 1e-9;
  constexpr double kAnyYawRad = 10;
  for (Index i = 0; i < 4; ++i) {
    system->Add({{kBiases + i, 1.0}}, guess.biases[ClockState::kBiases + i], config_.inter_system_std_m);
  }
  for (Index i = 0; i < 3; ++i) {
    system->Add({{kShift + i, 1.0}}, 0, kFarM);
  }
  // Over the window the velocity is as uncertain as on average; the axes apart, which is never too sure.
  Vector3d variance = Vector3d::Zero();
  for (const AlignmentSample* sample : samples_) {
    variance += sample->state.velocity_covariance_W.diagonal() / static_cast<double>(samples_.size());
  }
  for (Index i = 0; i < 3; ++i) {
    const double deviation = std::sqrt(std::max(variance[i], 0.0)) + kHeld;
    system->Add({{kVelocity + i, 1.0}}, guess.dv_W[i], deviation);
  }
  const bool offset_free = config_.estimate_time_offset && options.yaw_free;
  system->Add({{kOffset, 1.0}}, guess.time_offset_s, offset_free ? 0.5 * config_.max_time_offset_s : kHeld);
  system->Add({{kYaw, 1.0}}, 0, options.yaw_free ? kAnyYawRad : kHeld);
}

void AlignmentFit::Move(const VectorXd& step, AlignmentGuess* guess) const {
  guess->yaw_rad = std::remainder(guess->yaw_rad + step[kYaw], 2 * M_PI);
  guess->p_NW += step.segment<3>(kShift);
  guess->time_offset_s =
      std::clamp(guess->time_offset_s + step[kOffset], -config_.max_time_offset_s, config_.max_time_offset_s);
  guess->dv_W += step.segment<3>(kVelocity);
  guess->biases.tail<4>() += step.segment<4>(kBiases);
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    guess->clock_m[k] += step[ClockColumn(k)];
    guess->drift_mps[k] += step[ClockColumn(k) + 1];
  }
}

AlignmentStep AlignmentFit::Step(const Options& options, AlignmentGuess* guess) const {
  AlignmentStep result;
  NormalEquations system(ClockColumn(samples_.size()));
  std::vector<double> whitened;
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    AddEpoch(k, options, guess, &system, &result, &whitened);
  }
  AddClockProcess(*guess, &system);
  AddPriors(options, *guess, &system);
  const SymmetricSolver solver(system.hessian);
  if (!solver.positive()) {
    return result;
  }
  const VectorXd step = solver.Solve(-system.gradient);
  if (!step.allFinite()) {
    return result;
  }
  Move(step, guess);
  result.ok = true;
  result.scale = RobustScale(whitened, static_cast<int>(std::min<Index>(kClocks, step.size())));
  result.covariance = solver.Solve(MatrixXd::Identity(step.size(), 4)).topRows<4>();
  return result;
}

}  // namespace alidade
