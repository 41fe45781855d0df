#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gnss/base/gnss_time.h"
#include "gnss/base/satellite_id.h"
#include "gnss/base/text_file.h"

namespace alidade {

/// Which navigation message an ephemeris came with: it decides what the clock refers to.
enum class NavMessage { kLnav, kInav, kFnav, kD1, kD2, kFdma };
[[nodiscard]] std::string_view ToString(NavMessage message);

/// Broadcast Kepler elements and clock of GPS, QZSS, Galileo and BeiDou, in the units of the message (angles
/// rad, lengths m, times s). IS-GPS-200 table 20-III, Galileo OS SIS ICD tables 60 to 68, BDS-SIS-ICD-B1I
/// table 5-9.
struct KeplerEphemeris {
  SatelliteId satellite;
  NavMessage message = NavMessage::kLnav;
  TimeNs toc_ns = 0;           ///< reference of the clock, GPST
  TimeNs toe_ns = 0;           ///< reference of the orbit, GPST
  double toe_of_week_s = 0;    ///< the same as broadcast, in the system's own week: the node refers to it
  TimeNs transmission_ns = 0;  ///< when it was sent, GPST; toc_ns where the file has none
  double af0 = 0, af1 = 0, af2 = 0;
  int issue = 0;  ///< IODE, IODnav, AODE
  double sqrt_a = 0, eccentricity = 0;
  double i0 = 0, omega0 = 0, omega = 0, m0 = 0;
  double delta_n = 0, omega_dot = 0, i_dot = 0;
  double cuc = 0, cus = 0, crc = 0, crs = 0, cic = 0, cis = 0;
  double accuracy_m = 2;  ///< URA or SISA; never below 0.1
  int health = 0;         ///< as broadcast, 0 = healthy (Galileo: RINEX's bits)
  int data_source = 0;    ///< Galileo: RINEX's bits
  /// Group delays [s]: GPS and QZSS TGD; Galileo BGD(E1,E5a), BGD(E1,E5b); BeiDou TGD1 (B1I), TGD2 (B2I).
  std::array<double, 2> group_delay_s = {0, 0};
};

/// Broadcast state and clock of GLONASS in PZ-90 (ECEF) at its reference time. GLONASS ICD 5.1, 4.4.
struct GlonassEphemeris {
  SatelliteId satellite{GnssSystem::kGlonass, 0};
  TimeNs toe_ns = 0;  ///< t_b as GPST
  TimeNs transmission_ns = 0;
  double clock_bias_s = 0;  ///< -tau_n
  double clock_drift = 0;   ///< +gamma_n
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_mps2 = Eigen::Vector3d::Zero();  ///< of Sun and Moon
  int channel = 0;
  int health = 0;                    ///< 0 = healthy (B_n)
  std::optional<double> l2_delay_s;  ///< delta tau_n = delay of L2 minus L1 (RINEX 3.05 on)
};

/// Klobuchar's eight parameters [s, s/semicircle, ...]; GPS's and BeiDou's differ in their model.
struct KlobucharParameters {
  std::array<double, 4> alpha{};
  std::array<double, 4> beta{};
};

/// The contents of the navigation files of one campaign; several files may be merged.
struct NavigationData {
  std::map<SatelliteId, std::vector<KeplerEphemeris>> kepler;  ///< sorted by toe_ns, then transmission
  std::map<int, std::vector<GlonassEphemeris>> glonass;        ///< number -> sorted by toe_ns
  std::optional<KlobucharParameters> gps_ionosphere;
  std::optional<KlobucharParameters> beidou_ionosphere;
  std::optional<std::array<double, 3>>
      galileo_ionosphere;  ///< a_i0..2 of NeQuick G, which is not implemented
  std::optional<int> leap_seconds;
  std::int64_t passed_over = 0;  ///< messages of kinds that are not used (SBAS, CNAV, NavIC, EOP, ...)
  ReaderWarnings warnings;

  [[nodiscard]] std::size_t ephemerides() const;
  /// Adds what `other` holds; equal ephemerides count once, ionosphere of the first file that has one stays.
  void Merge(NavigationData other);
};

}  // namespace alidade
