#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gnss/orbits/satellite_catalog.h"

namespace alidade {

/// Files of a campaign; several of a kind are merged, the first one wins where they repeat.
struct GnssFiles {
  std::vector<std::string> navigation;  ///< RINEX navigation
  std::vector<std::string> orbits;      ///< SP3
  std::vector<std::string> clocks;      ///< RINEX CLK
};

/// Reads them into one catalog; faults that were passed over are added to `warnings`. Errors: those of the
/// readers, the first one. At least one navigation file is needed: health, group delays and ionosphere are
/// there alone.
Result<std::shared_ptr<const SatelliteCatalog>> LoadSatelliteCatalog(const GnssFiles& files,
                                                                     ReaderWarnings* warnings);

}  // namespace alidade
