#include "core/calibration_watch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "core/numbers.h"

namespace alidade {
namespace {

struct Parameter {
  const char* name;
  const char* unit;
  double scale;  ///< `unit` in the coordinate's unit
};

Parameter ParameterOf(const CalibrationLayout& layout, int coordinate) {
  if (coordinate == layout.time_offset()) {
    return {"the time offset of the camera", "ms", 1e3};
  }
  if (layout.extrinsics() >= 0 && coordinate >= layout.extrinsics() && coordinate < layout.extrinsics() + 6) {
    return coordinate < layout.extrinsics() + 3
               ? Parameter{"the rotation of the camera on the body", "deg", kDegreesPerRadian}
               : Parameter{"the position of the camera on the body", "m", 1};
  }
  if (layout.lever_arm() >= 0 && coordinate >= layout.lever_arm()) {
    return {layout.antenna() == Sensor::kGnss ? "the lever arm of the GNSS antenna"
                                              : "the lever arm of the position sensor",
            "m", 1};
  }
  return coordinate < layout.intrinsics() + 2 ? Parameter{"the focal length of the camera", "px", 1}
                                              : Parameter{"the principal point of the camera", "px", 1};
}

}  // namespace

CalibrationDoubt FindCalibrationDoubt(const CalibrationEstimate& watched, const Matrix15d& covariance) {
  const Eigen::VectorXd prior = WatchedDeviations(watched.layout);
  CalibrationDoubt doubt;
  std::map<std::string_view, Vector6d> moved;  // by name: what the coordinates of a parameter do to the pose
  for (int i = 0; i < watched.layout.size(); ++i) {
    const double precision = 1 / (watched.deviations[i] * watched.deviations[i]);
    const double information = precision - 1 / (prior[i] * prior[i]);
    // What rounding leaves of two large numbers is no information.
    if (!(information > 1e-9 * precision)) {
      continue;
    }
    const double score = watched.error[i] * precision;
    const double error = score / information;
    const double sigmas = std::abs(score) / std::sqrt(information);
    const Parameter parameter = ParameterOf(watched.layout, i);
    moved.try_emplace(parameter.name, Vector6d::Zero()).first->second +=
        error * precision * watched.state_covariance.col(i).head<6>();
    if (sigmas > doubt.sigmas) {
      doubt = {parameter.name, parameter.unit, sigmas, -parameter.scale * error, 0};
    }
  }
  if (doubt.sigmas > 0) {
    const Vector6d& shift = moved.at(doubt.parameter);
    const Eigen::LDLT<Matrix6d> factor(covariance.topLeftCorner<6, 6>());
    doubt.pose_sigmas = std::sqrt(std::max(0.0, shift.dot(factor.solve(shift))));
  }
  return doubt;
}

}  // namespace alidade
