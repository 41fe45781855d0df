#include "core/calibration_watch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

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
  return coordinate < layout.intrinsics() + 2 ? Parameter{"the focal length of the camera", "px", 1}
                                              : Parameter{"the principal point of the camera", "px", 1};
}

}  // namespace

CalibrationDoubt FindCalibrationDoubt(const CalibrationEstimate& watched, const Matrix15d& covariance) {
  const Eigen::VectorXd prior = WatchedDeviations(watched.layout);
  CalibrationDoubt doubt;
  int worst = -1;
  double shift = 0;
  for (int i = 0; i < watched.layout.size(); ++i) {
    const double precision = 1 / (watched.deviations[i] * watched.deviations[i]);
    const double information = precision - 1 / (prior[i] * prior[i]);
    // What rounding leaves of two large numbers is no information.
    if (!(information > 1e-9 * precision)) {
      continue;
    }
    const double score = watched.error[i] * precision;
    const double sigmas = std::abs(score) / std::sqrt(information);
    if (sigmas > doubt.sigmas) {
      const Parameter parameter = ParameterOf(watched.layout, i);
      shift = score / information * precision;
      doubt = {parameter.name, parameter.unit, sigmas, -parameter.scale * score / information, 0};
      worst = i;
    }
  }
  if (worst >= 0) {
    const Vector6d moved = shift * watched.state_covariance.col(worst).head<6>();
    const Eigen::LDLT<Matrix6d> factor(covariance.topLeftCorner<6, 6>());
    doubt.pose_sigmas = std::sqrt(std::max(0.0, moved.dot(factor.solve(moved))));
  }
  return doubt;
}

}  // namespace alidade
