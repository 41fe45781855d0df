#include "smoother/solve/frame_rows.h"

#include <array>

#include "smoother/factors/imu_factor.h"

namespace alidade {

ImuRows LinearizeImu(const WindowFrame& first, const WindowFrame& second, const Eigen::Vector3d& gravity_W) {
  const ImuFactor factor(&*second.preintegration, gravity_W, first.first_estimate(), second.first_estimate());
  Eigen::Matrix<double, 15, 9, Eigen::RowMajor> nav_first, nav_second;
  Eigen::Matrix<double, 15, 6, Eigen::RowMajor> bias_first, bias_second;
  const std::array<const double*, 4> parameters = {first.nav.data(), first.bias.data(), second.nav.data(),
                                                   second.bias.data()};
  const std::array<double*, 4> jacobians = {nav_first.data(), bias_first.data(), nav_second.data(),
                                            bias_second.data()};
  ImuRows rows;
  factor.Evaluate(parameters.data(), rows.residual.data(), jacobians.data());
  rows.first << nav_first, bias_first;
  rows.second << nav_second, bias_second;
  return rows;
}

RestRows::RestRows(const WindowFrame& frame) {
  if (frame.rest) {
    frame.rest->Evaluate(frame.nav_state(), frame.imu_bias(), &residual, &jacobian);
  }
}

FrameEpochRows EpochRows(const GnssFactorContext& gnss, const WindowFrame& frame) {
  FrameEpochRows all;
  GnssResiduals ignored;
  for (const FrameEpoch& epoch : frame.epochs) {
    const FrameEpochRows rows =
        LinearizeFrameEpoch(gnss, epoch, epoch.SecondsAfter(frame.stamp_ns), frame.nav_state(),
                            frame.imu_bias(), frame.clock_state(), true, &ignored);
    const Eigen::Index before = all.residual.size();
    const Eigen::Index count = rows.residual.size();
    all.frame.conservativeResize(before + count, Eigen::NoChange);
    all.clock.conservativeResize(before + count, Eigen::NoChange);
    all.residual.conservativeResize(before + count);
    all.frame.bottomRows(count) = rows.frame;
    all.clock.bottomRows(count) = rows.clock;
    all.residual.tail(count) = rows.residual;
  }
  return all;
}

ClockStep StepTo(const GnssFactorContext& gnss, const WindowFrame& from, const WindowFrame& to) {
  return {gnss.config, SecondsBetween(from.stamp_ns, to.stamp_ns), to.clock_anew};
}

}  // namespace alidade
