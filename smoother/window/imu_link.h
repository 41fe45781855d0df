#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/preintegration.h"

namespace alidade {

/// From a frame of the window to a measurement at or after it: the IMU carries the frame's state on to there.
/// Over the tenths of a second between them the IMU's noise (millimetres) is left out.
struct ImuLink {
  std::vector<ImuSample> imu;  ///< from the frame on; one sample or none at the frame itself
  std::optional<Preintegration> preintegration;  ///< of `imu`; nothing at the frame itself

  void Set(std::vector<ImuSample> samples, const ImuBias& bias, const ImuNoise& noise) {
    imu = std::move(samples);
    preintegration.reset();
    if (imu.size() > 1) {
      preintegration.emplace(bias, noise);
      preintegration->Add(imu);
    }
  }
  /// The measurement now belongs to an earlier frame, of this bias; `between` leads from there to the frame
  /// before.
  void Prepend(std::span<const ImuSample> between, const ImuBias& bias, const ImuNoise& noise) {
    std::vector<ImuSample> samples(between.begin(), between.end());
    if (!imu.empty()) {
      samples.insert(samples.end(), imu.begin() + 1, imu.end());
    }
    Set(std::move(samples), bias, noise);
  }
};

}  // namespace alidade
