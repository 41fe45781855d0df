#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/estimator/estimator.h"
#include "core/estimator/measurement_log.h"
#include "core/imu_buffer.h"
#include "core/imu_propagation.h"

namespace alidade::test {

/// Dead reckoning, and a diary of what the runner handed over.
class FakeEstimator final : public Estimator {
 public:
  Status Initialize(const NavEstimate& initial) override {
    latest_ = initial;
    initialized_ = true;
    return Status::Ok();
  }
  Status AddImu(const ImuSample& sample) override {
    imu_stamps.push_back(sample.stamp_ns);
    return imu_.Add(sample);
  }
  Status AddFrame(const TrackFrame& frame) override {
    imu_before_frame.push_back(imu_stamps.empty() ? -1 : imu_stamps.back());
    repeated.push_back(frame.repeated);
    if (static_cast<int>(imu_before_frame.size()) == diverge_at_frame) {
      return Status::Diverged("fake: lost");
    }
    if (static_cast<int>(imu_before_frame.size()) == not_finite_at_frame) {
      latest_.nav.p_WB.x() = std::nan("");
      return Status::Ok();
    }
    const TimeNs stamp = frame.stamp_ns + SecondsToNs(time_offset_s);
    if (stamp > latest_.stamp_ns) {
      std::vector<ImuSample> samples;
      ALIDADE_RETURN_IF_ERROR(imu_.Interval(latest_.stamp_ns, stamp, &samples));
      Preintegration preintegration(latest_.bias, ImuNoise());
      preintegration.Add(samples);
      latest_.nav = CarryState(preintegration, latest_.nav, latest_.bias, GravityInWorld(9.81), nullptr);
      latest_.stamp_ns = stamp;
    }
    statistics_ = {};
    statistics_.tracks_in = static_cast<int>(frame.observations.size());
    statistics_.nis = 0.1 * static_cast<double>(imu_before_frame.size());
    statistics_.gnss_nis = 0.3 * static_cast<double>(imu_before_frame.size());
    statistics_.gnss_nis_dof = 3;
    return Status::Ok();
  }
  NavEstimate Latest() const override { return latest_; }
  bool initialized() const override { return initialized_; }
  const FrameStatistics& last_statistics() const override { return statistics_; }

  Result<std::vector<FinalizedFrame>> TakeFinalized(const std::atomic<bool>* /*stop*/) override {
    ++finalized_calls;
    return finalized_status.ok() ? Result<std::vector<FinalizedFrame>>(finalized) : finalized_status;
  }

  std::vector<FinalizedFrame> finalized;  ///< what TakeFinalized answers, unless finalized_status is an error
  Status finalized_status;
  int finalized_calls = 0;
  double time_offset_s = 0;
  int diverge_at_frame = 0;  ///< counted from 1; 0 never
  int not_finite_at_frame = 0;
  std::vector<TimeNs> imu_stamps;
  std::vector<TimeNs> imu_before_frame;  ///< newest sample when each frame came
  std::vector<bool> repeated;            ///< of each frame

 private:
  ImuBuffer imu_{0.5};
  NavEstimate latest_;
  FrameStatistics statistics_;
  bool initialized_ = false;
};

/// A log at rest: 100 Hz IMU over [0, duration], frames every 0.1 s shifted by `frame_shift_s`, and its
/// 17-column truth.
struct RestingScene {
  MeasurementLog log;
  Trajectory truth;

  explicit RestingScene(double duration_s = 1.0, double frame_shift_s = 0.0, double truth_from_s = 0.0) {
    constexpr TimeNs kStart = 1'000'000'000'000;
    const Eigen::Matrix3d R_WB = so3::Exp(Eigen::Vector3d(0.3, -0.2, 1.0));
    truth.has_velocity = truth.has_bias = true;
    for (int i = 0; i <= static_cast<int>(100 * duration_s); ++i) {
      const TimeNs stamp = kStart + i * 10'000'000LL;
      log.imu.push_back({stamp, Eigen::Vector3d::Zero(), R_WB.transpose() * Eigen::Vector3d(0, 0, 9.81)});
      if (0.01 * i >= truth_from_s) {
        TrajectoryPoint point;
        point.stamp_ns = stamp;
        point.nav.R_WB = R_WB;
        point.nav.p_WB = {1, 2, 3};
        truth.points.push_back(point);
      }
    }
    for (int i = 0; i <= static_cast<int>(10 * duration_s); ++i) {
      TrackFrame frame;
      frame.stamp_ns = kStart + i * 100'000'000LL + SecondsToNs(frame_shift_s);
      frame.frontend_ms = 1.5;
      for (int track = 0; track < i; ++track) {
        frame.observations.push_back({track, {10.0 * track, 0.1 * i}});  // a sensor never sees the same twice
      }
      log.frames.push_back(frame);
    }
  }
};

}  // namespace alidade::test
