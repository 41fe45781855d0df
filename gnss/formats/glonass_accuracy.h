#pragma once

namespace alidade {

/// Accuracy of a GLONASS ephemeris [m], a typical one: its message holds it (F_T, GLONASS ICD 5.1, 4.4), but
/// RINEX up to 3.04 has no field for it.
inline constexpr double kGlonassAccuracyM = 4;

}  // namespace alidade
