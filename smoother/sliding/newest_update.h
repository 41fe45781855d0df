#pragma once

#include <Eigen/Core>
#include <span>

#include "core/absolute_correction.h"
#include "core/clock_state.h"
#include "gnss/model/epoch_rows.h"
#include "gnss/model/receiver_clock.h"
#include "smoother/factors/gnss_factors.h"
#include "smoother/window/frame_measurement.h"

namespace alidade {

/// The newest frame's state and clock as the last solve left them, and after it as a Kalman filter would have
/// them by the measurements that are attached to the frame since: what the next solve will do, as far as one
/// measurement is concerned. Nothing of it enters the estimate.
class NewestUpdate {
 public:
  static constexpr int kClock = 6;
  static constexpr int kSize = kClock + 15;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;

  /// `clock_state`: covariance of the clock's error with the state's, 6 x 15.
  void Begin(const NavEstimate& newest, const ClockState& clock,
             const Eigen::Matrix<double, kClock, 15>& clock_state);
  /// Over consecutive samples that begin at the state, by the process models; what the measurements since
  /// Begin did stays. kDiverged: PropagateState.
  Status Carry(std::span<const ImuSample> interval, const ImuNoise& noise, const Eigen::Vector3d& gravity_W,
               const ClockTransition& clock);

  [[nodiscard]] AbsoluteCorrection Add(const GnssFactorContext& context, double gate_threshold,
                                       const FrameEpoch& epoch, double dt_s);
  [[nodiscard]] AbsoluteCorrection Add(const FrameMeasurement& measurement, const Eigen::Vector3d& gravity_W);

 private:
  /// Rows over (clock, state), whitened.
  AbsoluteCorrection Update(const Eigen::Ref<const Eigen::MatrixXd>& rows,
                            const Eigen::Ref<const Eigen::VectorXd>& residual);

  NavEstimate state_;
  Vector6d clock_ = Vector6d::Zero();
  Covariance covariance_ = Covariance::Zero();
};

}  // namespace alidade
