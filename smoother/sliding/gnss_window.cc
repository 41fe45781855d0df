#include "smoother/sliding/gnss_window.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/robust.h"
#include "gnss/base/constants.h"

namespace alidade {
namespace {

/// The variance behind each row of an epoch: pseudoranges come first, one a satellite; then the rates of
/// those that have one.
std::vector<double*> RowVariances(const GnssConfig& config, const GnssResiduals& residuals,
                                  EpochMeasurements* epoch) {
  std::vector<double*> variances;
  std::vector<double*> rates;
  auto measured = epoch->satellites.begin();
  for (const SatelliteResidual& satellite :
       residuals.satellites) {  // those of the epoch above the mask, in order
    while (!(measured->satellite == satellite.satellite)) {
      ++measured;
    }
    if (config.pseudorange) {
      variances.push_back(&measured->pseudorange_variance);
    }
    if (config.doppler && satellite.range_rate_residual_mps) {
      rates.push_back(&measured->range_rate_variance);
    }
  }
  variances.insert(variances.end(), rates.begin(), rates.end());
  return variances;
}

}  // namespace

GnssWindow::GnssWindow(const GnssConfig& config, const GnssReceiver& receiver,
                       const Eigen::Vector3d& gravity_W)
    : config_(config),
      receiver_(receiver),
      gravity_W_(gravity_W),
      gate_threshold_(ChiSquareQuantile(1, config.gate_probability)) {}

void GnssWindow::Align(const GnssAlignment& alignment, WindowFrame* frame, LinearPrior* prior) {
  context_ = GnssFactorContext{config_, {*alignment.enu, receiver_.p_BA}, gravity_W_};
  removed_jumps_m_ = 0;
  clock_lost_ = false;
  clock_known_ns_ = alignment.stamp_ns;
  const double since_s = SecondsBetween(alignment.stamp_ns, frame->stamp_ns);
  const ClockState fresh = FreshClock(config_, PropagateClock(config_, since_s).phi * *alignment.clock);
  frame->clock.emplace();
  Eigen::Map<Vector6d>{frame->clock->data()} = fresh.mean;
  const Eigen::LLT<Matrix6d> factor(fresh.covariance);
  const Eigen::Index rows = prior->jacobian.rows();
  const Eigen::Index columns = prior->jacobian.cols();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows + 6, columns + 6);
  jacobian.topLeftCorner(rows, columns) = prior->jacobian;
  jacobian.bottomRightCorner<6, 6>() = factor.matrixL().solve(Matrix6d::Identity());
  prior->jacobian = std::move(jacobian);
  prior->residual.conservativeResize(rows + 6);
  prior->residual.tail<6>().setZero();
  prior->clock_origin = fresh.mean;
}

void GnssWindow::PredictClock(const WindowFrame& from, WindowFrame* frame) {
  if (!aligned() || !from.clock) {
    return;
  }
  const double dt_s = SecondsBetween(from.stamp_ns, frame->stamp_ns);
  frame->clock.emplace();
  Eigen::Map<Vector6d>{frame->clock->data()} = PropagateClock(config_, dt_s).phi * from.clock_state();
  frame->clock_anew = clock_lost_;
  clock_lost_ = false;
}

bool GnssWindow::Attach(const GnssEpoch& epoch, std::vector<ImuSample> imu, const ImuNoise& noise,
                        WindowFrame* frame) {
  FrameEpoch attached;
  attached.stamp_ns = epoch.stamp_ns;
  attached.measurements = epoch.measurements;
  attached.Set(std::move(imu), frame->imu_bias(), noise);
  if (!attached.imu.empty()) {
    attached.gyro_radps = attached.imu.back().gyro;
  }
  LocateEpoch(*epoch.builder, context_->mount, frame->nav_state(), &attached.measurements);
  for (SatelliteMeasurement& m : attached.measurements.satellites) {
    m.pseudorange_m -= removed_jumps_m_;
  }
  jumped_ = false;
  std::vector<GnssRow> rows = PredictRows(attached, *frame);
  if (!RemoveClockJump(&attached, &rows)) {
    return false;
  }
  for (const GnssRow& row : rows) {
    const double residual = row.residual / row.deviation;
    attached.used.push_back(!row.contradicted || residual * residual <= gate_threshold_);
  }
  frame->epochs.push_back(std::move(attached));
  return true;
}

std::vector<GnssRow> GnssWindow::PredictRows(const FrameEpoch& epoch, const WindowFrame& frame) const {
  GnssResiduals ignored;
  const double dt_s = epoch.SecondsAfter(frame.stamp_ns);
  GnssPoint point{frame.nav_state(), frame.imu_bias(), epoch.gyro_radps, frame.clock_state()};
  point.nav.p_WB += dt_s * point.nav.v_WB;
  point.clock[ClockState::kClock] += dt_s * point.clock[ClockState::kDrift];
  return LinearizeEpoch(config_, context_->mount, point, epoch.measurements, &ignored);
}

bool GnssWindow::RemoveClockJump(FrameEpoch* epoch, std::vector<GnssRow>* rows) {
  constexpr double kMillisecondM = 1e-3 * kSpeedOfLight;
  constexpr double kSureM = 200;  // within which a step counts as whole milliseconds
  const double step = CommonStep(*rows);
  step_m_ = step;
  const double since_s = std::max(0.0, SecondsBetween(clock_known_ns_, epoch->stamp_ns));
  const double walk = PropagateClock(config_, since_s).q(ClockState::kClock, ClockState::kClock);
  clock_known_ns_ = rows->empty() ? clock_known_ns_ : epoch->stamp_ns;
  if (!IsClockJump(config_, *rows, step, std::sqrt(kFreshClockStdM * kFreshClockStdM + walk))) {
    return !clock_lost_;
  }
  jumped_ = true;
  const double whole = std::round(step / kMillisecondM) * kMillisecondM;
  if (whole == 0 || std::abs(step - whole) > kSureM) {
    // Taken off what follows: the clock begins anew where it was, known to kFreshClockStdM.
    removed_jumps_m_ += step;
    clock_lost_ = true;
    return false;
  }
  removed_jumps_m_ += whole;
  step_m_ -= whole;
  for (SatelliteMeasurement& m : epoch->measurements.satellites) {
    m.pseudorange_m -= whole;
  }
  for (GnssRow& row : *rows) {
    row.residual += row.is_rate ? 0 : whole;
  }
  return !clock_lost_;
}

void GnssWindow::Gate(WindowFrame* frame, FrameStatistics* statistics) {
  for (FrameEpoch& epoch : frame->epochs) {
    const double dt_s = epoch.SecondsAfter(frame->stamp_ns);
    epoch.used.clear();
    GnssResiduals residuals;
    residuals.stamp_ns = epoch.stamp_ns;
    const FrameEpochRows rows =
        LinearizeFrameEpoch(*context_, epoch, dt_s, frame->nav_state(), frame->imu_bias(),
                            frame->clock_state(), false, &residuals);
    std::vector<double> nis;
    for (const double residual : rows.residual) {
      nis.push_back(residual * residual);
    }
    const GnssWeights weights = WeighRows(config_, gate_threshold_, nis);
    const std::vector<double*> variances = RowVariances(config_, residuals, &epoch.measurements);
    CHECK_EQ(variances.size(), nis.size());
    for (std::size_t k = 0; k < nis.size(); ++k) {
      epoch.used.push_back(weights.weights[k] > 0);
      if (epoch.used[k] && nis[k] > gate_threshold_) {
        *variances[k] /= weights.weights[k];  // the state is suspect: as WindowTrack::ScaleInformation
      }
    }
    if (epoch.counted) {
      continue;
    }
    epoch.counted = true;
    statistics->gnss_nis_dof += weights.used;
    for (std::size_t k = 0; k < nis.size(); ++k) {
      statistics->gnss_nis += weights.weights[k] * nis[k];
    }
    // Pseudoranges come first, one a satellite; then the rates of those that have one.
    std::size_t row = 0;
    for (SatelliteResidual& satellite : residuals.satellites) {
      satellite.used = config_.pseudorange && epoch.used[row++];
    }
    for (SatelliteResidual& satellite : residuals.satellites) {
      satellite.range_rate_used = config_.doppler && satellite.range_rate_residual_mps && epoch.used[row++];
      ++(satellite.used || satellite.range_rate_used ? statistics->satellites_used
                                                     : statistics->satellites_gated);
    }
    residuals_ = residuals;
  }
}

}  // namespace alidade
