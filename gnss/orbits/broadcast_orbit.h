#pragma once

#include "gnss/formats/ephemeris.h"
#include "gnss/orbits/satellite_state.h"

namespace alidade {

/// Position, velocity and clock from Kepler elements at a GPST stamp. IS-GPS-200 table 20-IV, Galileo OS SIS
/// ICD 5.1.1, BDS-SIS-ICD-B1I 5.2.4.12 with the GEO's rotation by -5 deg about x and Earth rotation about z
/// (message D2). Velocity by differentiating the same equations. The clock includes the relativistic term -2
/// sqrt(mu a) e sin(E) / c^2.
[[nodiscard]] SatelliteState PropagateKepler(const KeplerEphemeris& ephemeris, TimeNs stamp_ns);

/// Position, velocity and clock of GLONASS: RK4 with steps of 60 s at most from the reference time, in PZ-90,
/// with J2 and constant Sun and Moon (GLONASS ICD 5.1, A.3.1.2). PZ-90.11 is taken for WGS 84 (cm).
/// Relativity is in the broadcast clock. Precondition: within an hour of the reference time.
[[nodiscard]] SatelliteState PropagateGlonass(const GlonassEphemeris& ephemeris, TimeNs stamp_ns);

}  // namespace alidade
