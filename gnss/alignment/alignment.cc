#include "gnss/alignment/alignment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/format.h"
#include "core/robust.h"
#include "gnss/model/receiver_clock.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kMaxSamples = 40;  // bounds the work; epochs share most errors anyway
constexpr double kRetryS = 0.5;

bool Refused(const SinglePointSolution& solution, SatelliteId satellite) {
  const auto found =
      std::find_if(solution.satellites.begin(), solution.satellites.end(),
                   [&](const SatelliteResidual& residual) { return residual.satellite == satellite; });
  return found != solution.satellites.end() && !found->used;
}

}  // namespace

GnssAlignment AlreadyAligned(GnssAlignment alignment, TimeNs stamp_ns) {
  alignment.stamp_ns = stamp_ns;
  alignment.yaw_rad = 0;
  alignment.p_NW.setZero();
  alignment.covariance = 1e-12 * Eigen::Matrix4d::Identity();
  return alignment;
}

NavEstimate TurnIntoEnu(const GnssAlignment& alignment, const NavEstimate& estimate) {
  const YawShift transform = alignment.Transform();
  NavEstimate turned = transform * estimate;
  Eigen::Matrix<double, 15, 4> spread = Eigen::Matrix<double, 15, 4>::Zero();
  spread.topRows<9>() = transform.ParameterJacobian(turned.nav);
  turned.covariance += spread * alignment.covariance * spread.transpose();
  turned.covariance = (0.5 * (turned.covariance + turned.covariance.transpose())).eval();
  return turned;
}

GnssAligner::GnssAligner(const GnssConfig& config, const GnssReceiver& receiver)
    : config_(config), receiver_(receiver), matcher_(config.align_window_s) {}

void GnssAligner::AddState(TimeNs stamp_ns, const NavState& nav, const ImuBias& bias,
                           const Vector3d& gyro_radps, const Eigen::Matrix3d& velocity_covariance_W) {
  AlignmentState state;
  state.stamp_ns = stamp_ns;
  state.nav = nav;
  state.bias = bias;
  state.gyro_radps = gyro_radps;
  state.velocity_covariance_W = velocity_covariance_W;
  matcher_.AddState(std::move(state));
  MatchEpochs();
}

void GnssAligner::AddEpoch(const GnssEpoch& epoch, const std::optional<Vector3d>& approximate_E,
                           const std::optional<SinglePointSolution>& solution) {
  approximate_E_ = approximate_E ? approximate_E : approximate_E_;
  builder_ = epoch.builder;
  left_out_.Add(epoch.measurements.left_out);
  GnssEpoch taken = epoch;
  if (solution) {
    std::erase_if(taken.measurements.satellites,
                  [&](const SatelliteMeasurement& m) { return Refused(*solution, m.satellite); });
  }
  if (static_cast<int>(taken.measurements.satellites.size()) >= config_.align_min_satellites) {
    matcher_.AddMessage(std::move(taken));
    any_epoch_ = true;
  }
  matcher_.DropOld(epoch.stamp_ns);  // one with too few satellites still has the time
  MatchEpochs();
}

void GnssAligner::ForgetEstimate() {
  matcher_.ForgetStates();
  samples_.clear();
}

void GnssAligner::MatchEpochs() {
  while (std::optional<StateMatcher<GnssEpoch>::Match> match = matcher_.Next()) {
    samples_.push_back({match->state, std::move(match->message.measurements)});
    located_ = false;
  }
  const TimeNs newest = matcher_.states().empty() ? 0 : matcher_.states().newest().stamp_ns;
  const TimeNs oldest = newest - SecondsToNs(config_.align_window_s);
  while (!samples_.empty() && samples_.front().state.stamp_ns < oldest) {
    samples_.pop_front();
  }
}

void GnssAligner::Locate() {
  if (located_) {
    return;
  }
  enu_ = EnuFrame::At(receiver_.anchor_E.value_or(*approximate_E_));
  // What the newest epoch knows of the errors holds for those before it; each one that is chosen stands for
  // those that are not.
  PseudorangeNoise noise = samples_.back().measurements.noise;
  noise.epochs = std::max(1.0, noise.epochs / static_cast<double>(ChoiceStep()));
  noise = noise.AtOnce();
  for (AlignmentSample& sample : samples_) {
    sample.measurements.noise = noise;
    builder_->Locate(*approximate_E_, &sample.measurements);
  }
  located_ = true;
}

std::size_t GnssAligner::ChoiceStep() const {
  return std::max<std::size_t>((samples_.size() + kMaxSamples - 1) / kMaxSamples, 1);
}

std::vector<const AlignmentSample*> GnssAligner::Choose() const {
  const std::size_t step = ChoiceStep();
  std::vector<const AlignmentSample*> chosen;
  for (std::size_t i = (samples_.size() - 1) % step; i < samples_.size(); i += step) {
    chosen.push_back(&samples_[i]);
  }
  return chosen;
}

std::optional<AlignmentGuess> GnssAligner::FirstGuess(const AlignmentFit& fit) const {
  constexpr int kCandidates = 24;
  constexpr int kSteps = 3;
  std::optional<AlignmentGuess> best;
  double best_cost = INFINITY;
  const Vector3d last_W = fit.samples().back()->state.nav.p_WB;
  for (int i = 0; i < kCandidates; ++i) {
    const double yaw = std::remainder(2 * M_PI * i / kCandidates, 2 * M_PI);
    const Vector3d shift = enu_.FromEcef(*approximate_E_) - YawShift{.yaw_rad = yaw}.Rotation() * last_W;
    AlignmentGuess guess(yaw, shift, fit.samples().size());
    AlignmentStep step;
    for (int k = 0; k < kSteps; ++k) {
      step = fit.Step({.yaw_free = false, .robust = k > 0, .gate_sigma = INFINITY}, &guess);
    }
    if (step.ok && step.cost < best_cost) {
      best_cost = step.cost;
      best = std::move(guess);
    }
  }
  return best;
}

std::string GnssAligner::LeftOut() const {
  return any_epoch_ ? "" : "; satellites left out: " + Describe(left_out_);
}

std::optional<GnssAlignment> GnssAligner::TryAlign() {
  if (static_cast<int>(samples_.size()) < config_.align_min_epochs || !approximate_E_) {
    report_ = Format("%zu epochs of at least %d satellites within the window, expected %d%s", samples_.size(),
                     config_.align_min_satellites, config_.align_min_epochs,
                     approximate_E_ ? "" : "; no position yet") +
              LeftOut();
    return std::nullopt;
  }
  const TimeNs newest = samples_.back().state.stamp_ns;
  if (tried_ns_ != INT64_MIN && SecondsBetween(tried_ns_, newest) < kRetryS) {
    return std::nullopt;
  }
  tried_ns_ = newest;
  Locate();
  const AlignmentFit fit(config_, {enu_, receiver_.p_BA}, Choose());
  std::optional<AlignmentGuess> guess = FirstGuess(fit);
  constexpr int kIterations = 18;
  constexpr int kUngated = 6;
  constexpr double kGateScales = 3.5;
  constexpr double kFirstGateSigma = 60;
  constexpr double kGateShrinks = 0.65;
  AlignmentStep step;
  double widest = INFINITY;
  for (int i = 0; guess && i < kIterations && (i == 0 || step.ok); ++i) {
    // Huber's kernel alone is pulled by reflections, which are all late: they go, the latest first. A gate as
    // narrow as it will be would at once refuse good satellites of a solution that is metres off.
    widest = i < kUngated ? INFINITY : std::min(kFirstGateSigma, kGateShrinks * widest);
    step = fit.Step({.gate_sigma = std::max(widest, kGateScales * step.scale)}, &*guess);
  }
  if (!step.ok) {
    report_ = "the satellites do not determine the alignment";
    return std::nullopt;
  }
  return AcceptFit(*guess, step);
}

std::optional<GnssAlignment> GnssAligner::AcceptFit(const AlignmentGuess& guess, const AlignmentStep& fit) {
  const TimeNs newest = samples_.back().state.stamp_ns;
  const double inflation = config_.align_inflation * config_.align_inflation * fit.scale * fit.scale;
  GnssAlignment alignment;
  alignment.covariance = inflation * fit.covariance;
  const double yaw_std = std::sqrt(alignment.covariance(0, 0));
  report_ = Format("%zu epochs over %.1f s: yaw to %.3f rad, position to %.2f m, scale %.2f", samples_.size(),
                   SecondsBetween(samples_.front().state.stamp_ns, newest), yaw_std,
                   std::sqrt(alignment.covariance.bottomRightCorner<3, 3>().trace()), fit.scale);
  if (!(yaw_std < config_.align_max_yaw_std_rad)) {
    report_ += Format(", expected below %.3f rad: too little motion", config_.align_max_yaw_std_rad);
    return std::nullopt;
  }
  alignment.stamp_ns = newest + SecondsToNs(guess.time_offset_s);
  alignment.enu = enu_;
  alignment.yaw_rad = guess.yaw_rad;
  alignment.p_NW = guess.p_NW;
  Vector6d& clock = alignment.clock.emplace(guess.biases);
  clock[ClockState::kClock] = guess.clock_m.back();
  clock[ClockState::kDrift] = guess.drift_mps.back();
  alignment.time_offset_s = guess.time_offset_s;
  alignment.report =
      report_ + Format(", yaw %.4f rad", guess.yaw_rad) +
      (config_.estimate_time_offset ? Format(", time offset %.4f s", guess.time_offset_s) : "");
  return alignment;
}

}  // namespace alidade
