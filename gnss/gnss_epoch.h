#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "gnss/satellite_measurement.h"
#include "gnss/single_point.h"

namespace alidade {

/// Raw GNSS of a measurement log, as files say it; what is made of it is up to an estimator's settings.
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

/// What became of an epoch's satellites in an estimator; those below the mask are not listed.
struct GnssResiduals {
  TimeNs stamp_ns = 0;  ///< IMU time
  std::vector<SatelliteResidual> satellites;
};

}  // namespace alidade
