#pragma once

#include <cstddef>
#include <vector>

#include "eval/render/hall_renderer.h"
#include "eval/simulation/sim_fault.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// What SimulatorConfig::fault does to the images of a rendered camera. blackout: no light, the sensor's
/// noise is left. glare: kGlareLight times the light. blur: a Gaussian of fault_blur_px before the sensor.
/// frozen: the first image of the fault again and again, bit by bit. Exposure control reacts to the light.
class ImageFault {
 public:
  static constexpr double kGlareLight = 100;

  /// `start_ns`: of the first IMU sample. `stamps`: of the images.
  ImageFault(const SimulatorConfig& config, TimeNs start_ns, const std::vector<TimeNs>& stamps);

  /// The image that the camera hands out as the one at `stamps[index]`.
  [[nodiscard]] std::size_t Shown(std::size_t index) const;
  void Apply(TimeNs stamp_ns, Shot* shot) const;

 private:
  SimFaultKind kind_;
  FaultSpan span_;
  double blur_px_;
  std::size_t first_ = 0;  ///< image of the fault
  std::size_t after_ = 0;  ///< the last one
};

}  // namespace alidade
