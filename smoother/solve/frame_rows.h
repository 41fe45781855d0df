#pragma once

#include "core/rest_model.h"
#include "smoother/factors/gnss_factors.h"
#include "smoother/window/window.h"

namespace alidade {

/// Whitened rows of an IMU factor between two frames at their present states, over the 15 canonical
/// coordinates of each; Jacobians at first estimates where the frames have such.
struct ImuRows {
  Matrix15d first, second;
  Vector15d residual;
};
/// second.preintegration must be there.
[[nodiscard]] ImuRows LinearizeImu(const WindowFrame& first, const WindowFrame& second,
                                   const Eigen::Vector3d& gravity_W);

/// Rows of a frame's rest measurement over its 15 canonical coordinates; zero when it has none.
struct RestRows {
  explicit RestRows(const WindowFrame& frame);

  RestModel::Jacobian jacobian = RestModel::Jacobian::Zero();
  Vector6d residual = Vector6d::Zero();
};

/// The rows of a frame's epochs, at the present states, kernels included.
[[nodiscard]] FrameEpochRows EpochRows(const GnssFactorContext& gnss, const WindowFrame& frame);

[[nodiscard]] ClockStep StepTo(const GnssFactorContext& gnss, const WindowFrame& from, const WindowFrame& to);

}  // namespace alidade
