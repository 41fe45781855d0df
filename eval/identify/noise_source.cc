#include "eval/identify/noise_source.h"

#include <string>

#include "core/estimator/measurement.h"

namespace alidade {

const char* NameOf(NoiseSource source) {
  switch (source) {
    case NoiseSource::kGyro:
      return "gyroscope_noise_density";
    case NoiseSource::kAccel:
      return "accelerometer_noise_density";
    case NoiseSource::kGyroWalk:
      return "gyroscope_random_walk";
    case NoiseSource::kAccelWalk:
      return "accelerometer_random_walk";
    case NoiseSource::kPixel:
      return "pixel_noise";
    case NoiseSource::kGnss:
      return "gnss_scale";
    case NoiseSource::kMeasurement:
      break;
  }
  static const std::string name = MeasurementKeys() + "_scale";
  return name.c_str();
}

const char* UnitOf(NoiseSource source) {
  switch (source) {
    case NoiseSource::kGyro:
      return "rad/s/sqrt(Hz)";
    case NoiseSource::kAccel:
      return "m/s^2/sqrt(Hz)";
    case NoiseSource::kGyroWalk:
      return "rad/s^2/sqrt(Hz)";
    case NoiseSource::kAccelWalk:
      return "m/s^3/sqrt(Hz)";
    case NoiseSource::kPixel:
      return "px";
    case NoiseSource::kGnss:
    case NoiseSource::kMeasurement:
      break;
  }
  return "-";
}

}  // namespace alidade
