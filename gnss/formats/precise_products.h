#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gnss/base/gnss_time.h"
#include "gnss/base/satellite_id.h"
#include "gnss/base/text_file.h"

namespace alidade {

/// A satellite's centre of mass, ECEF [m].
struct OrbitNode {
  TimeNs stamp_ns = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
};

/// A satellite's clock [s] without the periodic relativistic term.
struct ClockNode {
  TimeNs stamp_ns = 0;
  double bias_s = 0;
};

/// Precise orbits and clocks of an analysis centre; nodes are sorted, stamps are GPST.
struct PreciseProducts {
  std::map<SatelliteId, std::vector<OrbitNode>> orbits;
  std::map<SatelliteId, std::vector<ClockNode>> clocks;         ///< of RINEX CLK
  std::map<SatelliteId, std::vector<ClockNode>> coarse_clocks;  ///< of SP3, used where `clocks` has none
  ReaderWarnings warnings;

  /// Adds what `other` holds; of two nodes with one stamp the earlier file's stays.
  void Merge(PreciseProducts other);
};

/// Reads an SP3 file of version a to d, plain or gzip (S. Hilla, "The extended standard product 3 orbit
/// format", 2010 and 2016). Positions and clocks alone: velocities, correlations and standard deviations are
/// skipped. Entries marked as bad (0 0 0, 999999.999999) are not used; the header's counts are not trusted.
/// Errors: no SP3, an unknown time system, no position.
Result<PreciseProducts> ReadSp3(const std::string& path);
Result<PreciseProducts> ParseSp3(const std::string& path, std::string_view text);

/// Reads satellite clocks ("AS") of a RINEX CLK file of version 2.00 to 3.04, plain or gzip. Errors: no clock
/// file, an unknown time system, no satellite clock.
Result<PreciseProducts> ReadRinexClock(const std::string& path);
Result<PreciseProducts> ParseRinexClock(const std::string& path, std::string_view text);

}  // namespace alidade
