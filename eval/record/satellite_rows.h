#pragma once

#include <string>

#include "gnss/model/gnss_epoch.h"

namespace alidade {

/// Rows of gnss.csv: every satellite of an epoch with direction, residuals and whether it was used.
[[nodiscard]] std::string SatelliteHeader();
[[nodiscard]] std::string SatelliteRows(const GnssResiduals& epoch);

}  // namespace alidade
