#include "filter/gnss_update.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/dense_solvers.h"
#include "gnss/model/receiver_clock.h"

namespace alidade {
namespace {

constexpr Eigen::Index kClock = FilterState::kClockSize;
constexpr Eigen::Index kCore = SquareRootCovariance::kCore;
constexpr Eigen::Index kSeen = kClock + kCore;

}  // namespace

GnssUpdate::GnssUpdate(const GnssConfig& config, const GnssReceiver& receiver)
    : config_(config), receiver_(receiver), gate_threshold_(ChiSquareQuantile(1, config.gate_probability)) {}

void GnssUpdate::Align(const GnssAlignment& alignment, FilterState* state) {
  if (!alignment.clock) {
    state->Align(alignment.Transform(), alignment.covariance, std::nullopt);
    return;
  }
  const ClockState fresh = FreshClock(config_, *alignment.clock);
  state->Align(alignment.Transform(), alignment.covariance, fresh.covariance);
  mount_ = AntennaMount{*alignment.enu, receiver_.p_BA};
  clock_ = fresh.mean;
  clock_stamp_ns_ = alignment.stamp_ns;
}

ClockState GnssUpdate::Clock(const FilterState& state) const {
  const double since_s = std::max(0.0, SecondsBetween(clock_stamp_ns_, state.stamp_ns()));
  const ClockTransition transition = PropagateClock(config_, since_s);
  const Matrix6d covariance = state.covariance().PoseBlock(state.ClockOffset(), state.ClockOffset());
  return {transition.phi * clock_, transition.phi * covariance * transition.phi.transpose() + transition.q};
}

void GnssUpdate::PropagateClockTo(TimeNs stamp_ns, FilterState* state) {
  if (stamp_ns <= clock_stamp_ns_) {
    return;
  }
  const ClockTransition transition = PropagateClock(config_, SecondsBetween(clock_stamp_ns_, stamp_ns));
  clock_ = transition.phi * clock_;
  state->covariance().PropagateLeading(state->ClockOffset(), transition.phi, transition.q);
  if (observer_ != nullptr) {
    observer_->OnPropagateClock(transition.phi, transition.q);
  }
  clock_stamp_ns_ = stamp_ns;
}

void GnssUpdate::ResetClock(double step_m, FilterState* state) {
  ClockTransition anew;
  anew.phi(ClockState::kClock, ClockState::kClock) = 0;
  anew.q(ClockState::kClock, ClockState::kClock) = kFreshClockStdM * kFreshClockStdM;
  state->covariance().PropagateLeading(state->ClockOffset(), anew.phi, anew.q);
  if (observer_ != nullptr) {
    observer_->OnPropagateClock(anew.phi, anew.q);
  }
  clock_[ClockState::kClock] += step_m;
  for (GnssRow& row : rows_) {
    row.residual += row.is_rate ? 0 : step_m;
  }
  for (SatelliteResidual& satellite : residuals_.satellites) {
    satellite.residual_m += step_m;
  }
}

bool GnssUpdate::Apply(const GnssEpoch& epoch, const Eigen::Vector3d& gyro_radps, FilterState* state,
                       Eigen::Ref<Eigen::VectorXd> correction, FrameStatistics* statistics) {
  PropagateClockTo(epoch.stamp_ns, state);
  located_ = epoch.measurements;
  LocateEpoch(*epoch.builder, *mount_, state->nav(), &located_);
  residuals_.stamp_ns = epoch.stamp_ns;
  rows_ = LinearizeEpoch(config_, *mount_, {state->nav(), state->bias(), gyro_radps, clock_}, located_,
                         &residuals_);
  correction.setZero();
  if (rows_.empty()) {
    return true;
  }
  const double step = CommonStep(rows_);
  const Matrix6d clock = state->covariance().PoseBlock(state->ClockOffset(), state->ClockOffset());
  const double clock_std = std::sqrt(clock(ClockState::kClock, ClockState::kClock));
  if (IsClockJump(config_, rows_, step, clock_std)) {
    ResetClock(step, state);
    statistics->clock_jump = true;
  }
  FillRows(*state);
  Weigh(*state, statistics);
  const double discarded = Compress();
  NotifyObserver(*state);
  if (!state->covariance().UpdateByBlock(state->ClockOffset(), jacobian_.leftCols<kSeen>(), innovation_,
                                         correction, &statistics->gnss_nis,
                                         jacobian_.rightCols(jacobian_.cols() - kSeen))) {
    return false;
  }
  statistics->gnss_nis += discarded;
  return correction.segment<6>(state->ClockOffset()).allFinite();
}

void GnssUpdate::Correct(const Eigen::Ref<const Eigen::VectorXd>& correction, const FilterState& state) {
  clock_ += correction.segment<6>(state.ClockOffset());
}

void GnssUpdate::FillRows(const FilterState& state) {
  const auto count = static_cast<Eigen::Index>(rows_.size());
  const bool antenna = state.layout().antenna() == Sensor::kGnss;
  jacobian_.resize(count, kSeen + (antenna ? 3 : 0));
  innovation_.resize(count);
  const NavState& point = state.first_estimates() ? state.nav_first() : state.nav();
  const Matrix15d chart = ImuChartJacobian(state.convention(), point);
  for (Eigen::Index i = 0; i < count; ++i) {
    const GnssRow& row = rows_[static_cast<std::size_t>(i)];
    jacobian_.block<1, kClock>(i, 0) = row.ClockJacobian() / row.deviation;
    jacobian_.block<1, kCore>(i, kClock).noalias() = row.jacobian * chart / row.deviation;
    if (antenna) {
      jacobian_.rightCols<3>().row(i) = row.lever_arm / row.deviation;
    }
    innovation_[i] = -row.residual / row.deviation;
  }
}

void GnssUpdate::Weigh(const FilterState& state, FrameStatistics* statistics) {
  nis_.resize(rows_.size());
  const Eigen::MatrixXd predicted =
      jacobian_.leftCols<kSeen>() * state.covariance().Block(state.ClockOffset(), kSeen);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    nis_[i] = NormalisedInnovation(innovation_[k], predicted.row(k).dot(jacobian_.row(k).head<kSeen>()),
                                   rows_[i].contradicted);
  }
  const GnssWeights result = WeighRows(config_, gate_threshold_, nis_);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double root = std::sqrt(result.weights[i] * rows_[i].information);
    jacobian_.row(k) *= root;
    innovation_[k] *= root;
    SatelliteResidual& satellite = residuals_.satellites[rows_[i].satellite];
    (rows_[i].is_rate ? satellite.range_rate_used : satellite.used) = root > 0;
  }
  statistics->gnss_nis_dof = result.used;
  for (const SatelliteResidual& satellite : residuals_.satellites) {
    ++(satellite.used || satellite.range_rate_used ? statistics->satellites_used
                                                   : statistics->satellites_gated);
  }
}

double GnssUpdate::Compress() {
  const Eigen::Index columns = jacobian_.cols();
  if (jacobian_.rows() <= columns) {
    return 0;
  }
  jacobian_ = UpperTriangle(jacobian_, &innovation_);
  const double discarded = innovation_.tail(innovation_.size() - columns).squaredNorm();
  innovation_.conservativeResize(columns);
  return discarded;
}

void GnssUpdate::NotifyObserver(const FilterState& state) const {
  if (observer_ == nullptr) {
    return;
  }
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(jacobian_.rows(), state.covariance().dimension());
  rows.middleCols<kSeen>(state.ClockOffset()) = jacobian_.leftCols<kSeen>();
  rows.rightCols(jacobian_.cols() - kSeen) = jacobian_.rightCols(jacobian_.cols() - kSeen);
  observer_->OnUpdate(state, {std::move(rows), innovation_, {}, RowSource::kGnss});
}

}  // namespace alidade
