#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "gnss/model/satellite_measurement.h"

namespace alidade {

/// Raw GNSS of a measurement log, as in the files; an estimator's settings decide how it is used.
struct GnssLog {
  std::vector<ObservationEpoch> epochs;  ///< strictly rising tags
  std::map<int, int> glonass_channels;
  std::shared_ptr<const SatelliteCatalog> catalog;
  std::optional<Eigen::Vector3d> approximate_position_E;
};

/// One epoch as an estimator takes it.
struct GnssEpoch {
  TimeNs stamp_ns = 0;             ///< IMU time: tag - receiver clock + the receiver's time offset
  EpochMeasurements measurements;  ///< prepared; direction, atmosphere and variances come with Locate
  std::shared_ptr<const MeasurementBuilder> builder;  ///< that made them
};

/// What became of one satellite.
struct SatelliteResidual {
  SatelliteId satellite;
  Direction direction;
  double residual_m = 0;   ///< predicted - measured
  double deviation_m = 0;  ///< assumed
  bool used = false;       ///< above the mask and inside the gate
  std::optional<double> range_rate_residual_mps;
  bool range_rate_used = false;
};

/// What became of an epoch's satellites in an estimator; those below the mask are not listed.
struct GnssResiduals {
  TimeNs stamp_ns = 0;  ///< IMU time
  std::vector<SatelliteResidual> satellites;
};

}  // namespace alidade
