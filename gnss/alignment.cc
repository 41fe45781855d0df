#include "gnss/alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/robust.h"
#include "gnss/receiver_clock.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Columns of the unknowns; then clock and drift of each sample.
constexpr Index kYaw = 0;
constexpr Index kShift = 1;
constexpr Index kOffset = 4;
constexpr Index kBiases = 5;
constexpr Index kClocks = 9;

constexpr std::size_t kMaxSamples = 40;  // bounds the work; epochs share most errors anyway
constexpr double kMaxStateGapS = 2;      // no interpolation across a longer silence
constexpr double kRetryS = 0.5;

Eigen::Matrix3d RotationZ(double yaw_rad) {
  return Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
}

/// Normal equations of scalar rows.
class NormalEquations {
 public:
  explicit NormalEquations(Index size)
      : hessian(MatrixXd::Zero(size, size)), gradient(VectorXd::Zero(size)) {}

  /// Adds weight (residual + row x)^2 / deviation^2; the row's columns may repeat none.
  void Add(const std::vector<std::pair<Index, double>>& row, double residual, double deviation,
           double weight = 1) {
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

}  // namespace

Eigen::Matrix3d GnssAlignment::R_NW() const {
  return RotationZ(yaw_rad);
}

NavEstimate TurnIntoEnu(const GnssAlignment& alignment, const NavEstimate& estimate) {
  const Eigen::Matrix3d R_NW = alignment.R_NW();
  NavEstimate turned = estimate;
  turned.nav.R_WB = R_NW * estimate.nav.R_WB;
  turned.nav.p_WB = R_NW * estimate.nav.p_WB + alignment.p_NW;
  turned.nav.v_WB = R_NW * estimate.nav.v_WB;
  Matrix15d turn = Matrix15d::Identity();
  turn.block<3, 3>(3, 3) = R_NW;
  turn.block<3, 3>(6, 6) = R_NW;
  Eigen::Matrix<double, 15, 4> spread = Eigen::Matrix<double, 15, 4>::Zero();
  spread.block<3, 1>(0, 0) = turned.nav.R_WB.transpose() * Vector3d::UnitZ();
  spread.block<3, 1>(3, 0) = Vector3d::UnitZ().cross(turned.nav.p_WB - alignment.p_NW);
  spread.block<3, 1>(6, 0) = Vector3d::UnitZ().cross(turned.nav.v_WB);
  spread.block<3, 3>(3, 1).setIdentity();
  const Matrix15d covariance =
      turn * estimate.covariance * turn.transpose() + spread * alignment.covariance * spread.transpose();
  turned.covariance = 0.5 * (covariance + covariance.transpose());
  return turned;
}

/// Present values of the unknowns.
struct GnssAligner::Guess {
  double yaw_rad = 0;
  Vector3d p_NW = Vector3d::Zero();
  double time_offset_s = 0;
  Vector6d biases = Vector6d::Zero();  ///< of systems, by ClockState's index
  std::vector<double> clock_m;         ///< by sample
  std::vector<double> drift_mps;
  std::vector<bool> clock_known;
};

/// What a step saw at the guess it started from.
struct GnssAligner::Fit {
  bool ok = false;
  double cost = 0;  ///< robust
  double scale = 1;
  MatrixXd covariance;  ///< of all unknowns
};

GnssAligner::GnssAligner(const GnssConfig& config, const GnssReceiver& receiver)
    : config_(config), receiver_(receiver) {}

void GnssAligner::AddState(TimeNs stamp_ns, const NavState& nav, const ImuBias& bias,
                           const Vector3d& gyro_radps) {
  if (!states_.empty() && stamp_ns <= states_.back().stamp_ns) {
    return;
  }
  State state{stamp_ns, nav, bias, gyro_radps, Vector3d::Zero()};
  if (!states_.empty()) {
    state.acceleration_W =
        (nav.v_WB - states_.back().nav.v_WB) / SecondsBetween(states_.back().stamp_ns, stamp_ns);
  }
  states_.push_back(state);
  MatchEpochs();
}

void GnssAligner::AddEpoch(const GnssEpoch& epoch, const std::optional<Vector3d>& approximate_E) {
  approximate_E_ = approximate_E ? approximate_E : approximate_E_;
  builder_ = epoch.builder;
  if (static_cast<int>(epoch.measurements.satellites.size()) >= config_.align_min_satellites) {
    pending_.push_back(epoch);
  }
  MatchEpochs();
}

/// Moves pending epochs that two states embrace to the samples, with the state interpolated between them.
void GnssAligner::MatchEpochs() {
  while (!pending_.empty() && !states_.empty() && pending_.front().stamp_ns <= states_.back().stamp_ns) {
    const TimeNs stamp = pending_.front().stamp_ns;
    const auto after = std::find_if(states_.begin(), states_.end(),
                                    [&](const State& state) { return state.stamp_ns >= stamp; });
    const bool embraced = after != states_.begin() || after->stamp_ns == stamp;
    const State& late = *after;
    const State& early = after == states_.begin() ? late : *(after - 1);
    const double span_s = SecondsBetween(early.stamp_ns, late.stamp_ns);
    if (embraced && span_s <= kMaxStateGapS) {
      const double share = span_s > 0 ? SecondsBetween(early.stamp_ns, stamp) / span_s : 0;
      Sample sample{late, std::move(pending_.front().measurements)};
      State& state = sample.state;
      state.stamp_ns = stamp;
      // Position by the cubic that fits both velocities; the rest linearly.
      const Vector3d chord = late.nav.p_WB - early.nav.p_WB;
      const double s2 = share * share;
      const double s3 = s2 * share;
      state.nav.p_WB = early.nav.p_WB + (3 * s2 - 2 * s3) * chord +
                       span_s * ((s3 - 2 * s2 + share) * early.nav.v_WB + (s3 - s2) * late.nav.v_WB);
      state.nav.v_WB = (1 - share) * early.nav.v_WB + share * late.nav.v_WB;
      state.nav.R_WB =
          early.nav.R_WB * so3::Exp(share * so3::Log(early.nav.R_WB.transpose() * late.nav.R_WB));
      state.gyro_radps = (1 - share) * early.gyro_radps + share * late.gyro_radps;
      samples_.push_back(std::move(sample));
      located_ = false;
    }
    pending_.pop_front();
  }
  const TimeNs newest = states_.empty() ? 0 : states_.back().stamp_ns;
  const TimeNs oldest = newest - SecondsToNs(config_.align_window_s);
  while (!samples_.empty() && samples_.front().state.stamp_ns < oldest) {
    samples_.pop_front();
  }
  // A late epoch still finds its states.
  while (states_.size() > 2 && SecondsBetween(states_[1].stamp_ns, newest) > kMaxStateGapS) {
    states_.pop_front();
  }
}

void GnssAligner::Locate() {
  if (located_) {
    return;
  }
  enu_ = EnuFrame::At(receiver_.anchor_E.value_or(*approximate_E_));
  for (Sample& sample : samples_) {
    builder_->Locate(*approximate_E_, &sample.measurements);
  }
  located_ = true;
}

std::vector<const GnssAligner::Sample*> GnssAligner::Choose() const {
  const std::size_t step = (samples_.size() + kMaxSamples - 1) / kMaxSamples;
  std::vector<const Sample*> chosen;
  for (std::size_t i = (samples_.size() - 1) % std::max<std::size_t>(step, 1); i < samples_.size();
       i += step) {
    chosen.push_back(&samples_[i]);
  }
  return chosen;
}

GnssAligner::Fit GnssAligner::Step(const std::vector<const Sample*>& samples, bool yaw_free, bool robust,
                                   double gate_sigma, Guess* guess) const {
  const AntennaMount mount{enu_, receiver_.p_BA};
  const Eigen::Matrix3d R_NW = RotationZ(guess->yaw_rad);
  NormalEquations system(kClocks + 2 * static_cast<Index>(samples.size()));
  std::vector<double> whitened;
  Fit fit;
  GnssResiduals residuals;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const State& state = samples[k]->state;
    const Index clock_column = kClocks + 2 * static_cast<Index>(k);
    GnssPoint point{state.nav, state.bias, state.gyro_radps, guess->biases};
    point.nav.R_WB = R_NW * state.nav.R_WB;
    point.nav.p_WB = R_NW * state.nav.p_WB + guess->p_NW;
    point.nav.v_WB = R_NW * state.nav.v_WB;
    // Where the epoch's offset puts the state.
    const Vector3d acceleration_N = R_NW * state.acceleration_W;
    const Vector3d omega_B = state.gyro_radps - state.bias.gyro;
    point.nav.p_WB += guess->time_offset_s * point.nav.v_WB;
    point.nav.v_WB += guess->time_offset_s * acceleration_N;
    point.nav.R_WB = point.nav.R_WB * so3::Exp(guess->time_offset_s * omega_B);
    point.clock[ClockState::kClock] = guess->clock_m[k];
    point.clock[ClockState::kDrift] = guess->drift_mps[k];
    std::vector<GnssRow> rows = LinearizeEpoch(config_, mount, point, samples[k]->measurements, &residuals);
    if (!guess->clock_known[k]) {
      const double common = CommonStep(rows);
      guess->clock_m[k] += common;
      guess->clock_known[k] = true;
      for (GnssRow& row : rows) {
        row.residual += row.is_rate ? 0 : common;
      }
    }
    // What the unknowns do to the state, in the canonical chart.
    Eigen::Matrix<double, 15, 5> chart = Eigen::Matrix<double, 15, 5>::Zero();
    chart.block<3, 1>(0, kYaw) = point.nav.R_WB.transpose() * Vector3d::UnitZ();
    chart.block<3, 1>(3, kYaw) = Vector3d::UnitZ().cross(point.nav.p_WB - guess->p_NW);
    chart.block<3, 1>(6, kYaw) = Vector3d::UnitZ().cross(point.nav.v_WB);
    chart.block<3, 3>(3, kShift).setIdentity();
    chart.block<3, 1>(0, kOffset) = omega_B;
    chart.block<3, 1>(3, kOffset) = point.nav.v_WB;
    chart.block<3, 1>(6, kOffset) = acceleration_N;
    for (const GnssRow& row : rows) {
      const Eigen::Matrix<double, 1, 5> shared = row.jacobian * chart;
      const double r = row.residual / row.deviation;
      const double huber = robust ? RobustWeight(RobustKernel::kHuber, config_.robust_scale_sigma, r * r) : 1;
      const double weight = std::abs(r) < gate_sigma ? huber : 0;
      fit.cost += RobustWeight(RobustKernel::kHuber, config_.robust_scale_sigma, r * r) * r * r;
      whitened.push_back(r);
      std::vector<std::pair<Index, double>> entries = {{kShift, shared[1]},
                                                       {kShift + 1, shared[2]},
                                                       {kShift + 2, shared[3]},
                                                       {clock_column + (row.is_rate ? 1 : 0), 1.0}};
      if (yaw_free) {
        entries.emplace_back(kYaw, shared[kYaw]);
        entries.emplace_back(kOffset, shared[kOffset]);
      }
      if (!row.is_rate && row.bias_index >= 0) {
        entries.emplace_back(kBiases + row.bias_index - ClockState::kBiases, 1.0);
      }
      system.Add(entries, row.residual, row.deviation, weight);
    }
  }
  // The clock's process; not across a jump.
  constexpr double kFreeDriftStdMps = 1e4;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const Index column = kClocks + 2 * static_cast<Index>(k);
    system.Add({{column + 1, 1.0}}, guess->drift_mps[k], kFreeDriftStdMps);
    if (k + 1 == samples.size()) {
      break;
    }
    const double dt_s = SecondsBetween(samples[k]->state.stamp_ns, samples[k + 1]->state.stamp_ns);
    const ClockTransition transition = PropagateClock(config_, dt_s);
    const double mean_drift = 0.5 * (guess->drift_mps[k] + guess->drift_mps[k + 1]);
    const double step = guess->clock_m[k + 1] - guess->clock_m[k] - mean_drift * dt_s;
    constexpr double kFloor = 1e-3;
    const double walk = config_.clock_walk_m_sqrts * std::sqrt(dt_s) + kFloor;
    if (std::abs(step) < config_.clock_jump_m || std::abs(mean_drift) < kFloor) {
      const bool settled = std::abs(step) < config_.clock_jump_m;
      system.Add({{column, -1.0}, {column + 2, 1.0}, {column + 1, -0.5 * dt_s}, {column + 3, -0.5 * dt_s}},
                 step, settled ? walk : kFreeDriftStdMps);
    }
    system.Add({{column + 1, -1.0}, {column + 3, 1.0}}, guess->drift_mps[k + 1] - guess->drift_mps[k],
               std::sqrt(transition.q(1, 1)) + kFloor);
  }
  for (Index i = 0; i < 4; ++i) {
    system.Add({{kBiases + i, 1.0}}, guess->biases[ClockState::kBiases + i], config_.inter_system_std_m);
  }
  constexpr double kFarM = 1e5;
  for (Index i = 0; i < 3; ++i) {
    system.Add({{kShift + i, 1.0}}, 0, kFarM);
  }
  constexpr double kHeld = 1e-9;
  system.Add({{kOffset, 1.0}}, guess->time_offset_s,
             config_.estimate_time_offset && yaw_free ? 0.5 * config_.max_time_offset_s : kHeld);
  if (!yaw_free) {
    system.Add({{kYaw, 1.0}}, 0, kHeld);
  } else {
    system.Add({{kYaw, 1.0}}, 0, 10);
  }
  const Eigen::LDLT<MatrixXd> solver(system.hessian);
  if (solver.info() != Eigen::Success || !solver.isPositive()) {
    return fit;
  }
  const VectorXd step = solver.solve(-system.gradient);
  if (!step.allFinite()) {
    return fit;
  }
  guess->yaw_rad = std::remainder(guess->yaw_rad + step[kYaw], 2 * M_PI);
  guess->p_NW += step.segment<3>(kShift);
  guess->time_offset_s =
      std::clamp(guess->time_offset_s + step[kOffset], -config_.max_time_offset_s, config_.max_time_offset_s);
  guess->biases.tail<4>() += step.segment<4>(kBiases);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    guess->clock_m[k] += step[kClocks + 2 * static_cast<Index>(k)];
    guess->drift_mps[k] += step[kClocks + 2 * static_cast<Index>(k) + 1];
  }
  fit.ok = true;
  fit.scale = RobustScale(whitened, static_cast<int>(std::min<Index>(kClocks, step.size())));
  fit.covariance = solver.solve(MatrixXd::Identity(step.size(), step.size()));
  return fit;
}

GnssAligner::Guess GnssAligner::FirstGuess(const std::vector<const Sample*>& samples) const {
  constexpr int kCandidates = 24;
  constexpr int kSteps = 3;
  Guess best;
  double best_cost = INFINITY;
  const Vector3d last_W = samples.back()->state.nav.p_WB;
  for (int i = 0; i < kCandidates; ++i) {
    Guess guess;
    guess.yaw_rad = std::remainder(2 * M_PI * i / kCandidates, 2 * M_PI);
    guess.p_NW = enu_.FromEcef(*approximate_E_) - RotationZ(guess.yaw_rad) * last_W;
    guess.clock_m.assign(samples.size(), 0);
    guess.drift_mps.assign(samples.size(), 0);
    guess.clock_known.assign(samples.size(), false);
    Fit fit;
    for (int step = 0; step < kSteps; ++step) {
      fit = Step(samples, false, step > 0, INFINITY, &guess);
    }
    if (fit.ok && fit.cost < best_cost) {
      best_cost = fit.cost;
      best = std::move(guess);
    }
  }
  return best;
}

std::optional<GnssAlignment> GnssAligner::TryAlign() {
  if (static_cast<int>(samples_.size()) < config_.align_min_epochs || !approximate_E_) {
    report_ = Format("%zu epochs of at least %d satellites within the window, expected %d%s", samples_.size(),
                     config_.align_min_satellites, config_.align_min_epochs,
                     approximate_E_ ? "" : "; no position yet");
    return std::nullopt;
  }
  const TimeNs newest = samples_.back().state.stamp_ns;
  if (tried_ns_ != INT64_MIN && SecondsBetween(tried_ns_, newest) < kRetryS) {
    return std::nullopt;
  }
  tried_ns_ = newest;
  Locate();
  const std::vector<const Sample*> samples = Choose();
  Guess guess = FirstGuess(samples);
  if (guess.clock_m.empty()) {
    report_ = "the satellites do not determine the alignment";
    return std::nullopt;
  }
  constexpr int kIterations = 12;
  constexpr int kUngated = 6;
  constexpr double kGateScales = 3.5;
  Fit fit;
  for (int i = 0; i < kIterations; ++i) {
    // Huber's kernel alone is pulled by reflections, which are all late: they go, at a scale that shrinks.
    fit = Step(samples, true, true, i < kUngated ? INFINITY : kGateScales * fit.scale, &guess);
    if (!fit.ok) {
      report_ = "the satellites do not determine the alignment";
      return std::nullopt;
    }
  }
  const double inflation = config_.align_inflation * config_.align_inflation * fit.scale * fit.scale;
  GnssAlignment alignment;
  alignment.covariance = inflation * fit.covariance.topLeftCorner<4, 4>();
  const double yaw_std = std::sqrt(alignment.covariance(0, 0));
  report_ = Format("%zu epochs over %.1f s: yaw to %.3f rad, position to %.2f m, scale %.2f", samples_.size(),
                   SecondsBetween(samples_.front().state.stamp_ns, newest), yaw_std,
                   std::sqrt(alignment.covariance.bottomRightCorner<3, 3>().trace()), fit.scale);
  if (!(yaw_std < config_.align_max_yaw_std_rad)) {
    report_ += Format(", expected below %.3f rad: too little motion", config_.align_max_yaw_std_rad);
    return std::nullopt;
  }
  alignment.stamp_ns = newest;
  alignment.enu = enu_;
  alignment.yaw_rad = guess.yaw_rad;
  alignment.p_NW = guess.p_NW;
  alignment.clock = guess.biases;
  alignment.clock[ClockState::kClock] = guess.clock_m.back();
  alignment.clock[ClockState::kDrift] = guess.drift_mps.back();
  alignment.time_offset_s = guess.time_offset_s;
  alignment.report =
      report_ + Format(", yaw %.4f rad", guess.yaw_rad) +
      (config_.estimate_time_offset ? Format(", time offset %.4f s", guess.time_offset_s) : "");
  return alignment;
}

}  // namespace alidade
