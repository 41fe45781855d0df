#pragma once

#include "core/lie.h"

namespace alidade {

/// Receiver clock against the datum system (GPS), all in metres: c dt_r, its rate [m/s], then the bias of
/// each further system's clock, in the order Galileo, BeiDou, QZSS, GLONASS. A pseudorange of system s
/// contains clock + bias of s, a range rate the drift (gnss/model/measurement_model.h).
struct ClockState {
  static constexpr int kClock = 0;
  static constexpr int kDrift = 1;
  static constexpr int kBiases = 2;
  static constexpr int kSize = 6;

  Vector6d mean = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
};

}  // namespace alidade
