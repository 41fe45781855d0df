#include "eval/record/satellite_rows.h"

#include "core/format.h"
#include "core/numbers.h"

namespace alidade {

std::string SatelliteHeader() {
  return "timestamp_ns,satellite,azimuth_deg,elevation_deg,residual_m,deviation_m,used,rate_residual_mps,"
         "rate_used\n";
}

std::string SatelliteRows(const GnssResiduals& epoch) {
  std::string text;
  for (const SatelliteResidual& s : epoch.satellites) {
    text +=
        std::to_string(epoch.stamp_ns) + "," + ToString(s.satellite) +
        Format(",%.2f,%.2f,%.4f,%.4f,%d,", s.direction.azimuth_rad * kDegreesPerRadian,
               s.direction.elevation_rad * kDegreesPerRadian, s.residual_m, s.deviation_m, s.used ? 1 : 0) +
        (s.range_rate_residual_mps ? Format("%.5f", *s.range_rate_residual_mps) : "") +
        (s.range_rate_used ? ",1\n" : ",0\n");
  }
  return text;
}

}  // namespace alidade
