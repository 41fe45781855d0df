#include "gnss/formats/rinex_writer.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/format.h"

namespace alidade {
namespace {

std::string HeaderLine(const std::string& content, const char* label) {
  return Format("%-60.60s%-20s\n", content.c_str(), label);
}

/// Signals of each system, sorted.
std::map<GnssSystem, std::set<SignalCode>> SignalsOf(const ObservationFile& file) {
  std::map<GnssSystem, std::set<SignalCode>> signals;
  for (const ObservationEpoch& epoch : file.epochs) {
    for (const SatelliteObservation& observed : epoch.satellites) {
      for (const SignalObservation& signal : observed.signals) {
        signals[observed.satellite.system].insert(signal.signal);
      }
    }
  }
  return signals;
}

std::string SignalLines(GnssSystem system, const std::set<SignalCode>& signals) {
  constexpr std::size_t kPerLine = 13;
  std::string text;
  std::string line = Format("%c  %3zu", Letter(system), 4 * signals.size());
  std::size_t count = 0;
  for (const SignalCode signal : signals) {
    for (const char kind : {'C', 'L', 'D', 'S'}) {
      if (count > 0 && count % kPerLine == 0) {
        text += HeaderLine(line, "SYS / # / OBS TYPES");
        line = "      ";
      }
      line += Format(" %c%s", kind, ToString(signal).c_str());
      ++count;
    }
  }
  return text + HeaderLine(line, "SYS / # / OBS TYPES");
}

std::string ChannelLines(const std::map<int, int>& channels) {
  constexpr int kPerLine = 8;
  std::string text;
  std::string line = Format("%3zu", channels.size());
  int count = 0;
  for (const auto& [number, channel] : channels) {
    if (count > 0 && count % kPerLine == 0) {
      text += HeaderLine(line, "GLONASS SLOT / FRQ #");
      line = "   ";
    }
    line += Format(" R%02d %2d", number, channel);
    ++count;
  }
  return text + HeaderLine(line, "GLONASS SLOT / FRQ #");
}

std::string ObservationHeader(const ObservationFile& file,
                              const std::map<GnssSystem, std::set<SignalCode>>& signals) {
  const bool mixed = signals.size() > 1;
  const char system = mixed || signals.empty() ? 'M' : Letter(signals.begin()->first);
  std::string text =
      HeaderLine(Format("%9.2f%11s%-20s%c", 3.04, "", "OBSERVATION DATA", system), "RINEX VERSION / TYPE");
  text += HeaderLine("alidade", "PGM / RUN BY / DATE");
  text += HeaderLine(file.marker, "MARKER NAME");
  if (file.approximate_position_E) {
    const Eigen::Vector3d& p = *file.approximate_position_E;
    text += HeaderLine(Format("%14.4f%14.4f%14.4f", p.x(), p.y(), p.z()), "APPROX POSITION XYZ");
  }
  text += HeaderLine(Format("%14.4f%14.4f%14.4f", 0.0, 0.0, 0.0), "ANTENNA: DELTA H/E/N");
  for (const auto& [id, codes] : signals) {
    text += SignalLines(id, codes);
  }
  if (!file.epochs.empty()) {
    const CalendarTime t = CalendarFromGpsTime(TimeScale::kGps, file.epochs.front().stamp_ns);
    text += HeaderLine(Format("%6d%6d%6d%6d%6d%5d.%07d%5s%3s", t.year, t.month, t.day, t.hour, t.minute,
                              t.second, static_cast<int>(t.nanoseconds / 100), "", "GPS"),
                       "TIME OF FIRST OBS");
  }
  if (!file.glonass_channels.empty()) {
    text += ChannelLines(file.glonass_channels);
  }
  return text + HeaderLine("", "END OF HEADER");
}

std::string Value(const std::optional<double>& value) {
  return value ? Format("%14.3f  ", *value) : std::string(16, ' ');
}

std::string SatelliteLine(const SatelliteObservation& observed, const std::set<SignalCode>& signals) {
  std::string line = ToString(observed.satellite);
  for (const SignalCode code : signals) {
    const auto found = std::find_if(observed.signals.begin(), observed.signals.end(),
                                    [&](const SignalObservation& s) { return s.signal == code; });
    const SignalObservation signal = found == observed.signals.end() ? SignalObservation{} : *found;
    for (const auto& value :
         {signal.pseudorange_m, signal.phase_cycles, signal.doppler_hz, signal.cn0_dbhz}) {
      line += Value(value);
    }
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::string Number(double value) {
  return Format("%19.12E", value);
}

/// Label of a message: satellite and calendar time in the system's own scale.
std::string MessageLabel(SatelliteId satellite, TimeScale scale, TimeNs stamp_ns) {
  const CalendarTime t = CalendarFromGpsTime(scale, stamp_ns);
  return ToString(satellite) +
         Format(" %04d %02d %02d %02d %02d %02d", t.year, t.month, t.day, t.hour, t.minute, t.second);
}

std::string NumberLine(double a, double b, double c, double d) {
  return "    " + Number(a) + Number(b) + Number(c) + Number(d) + "\n";
}

std::string KeplerText(const KeplerEphemeris& e) {
  const GnssSystem system = e.satellite.system;
  const TimeScale scale = system == GnssSystem::kBeidou ? TimeScale::kBeidou : TimeScale::kGps;
  const auto of_week = [&](TimeNs stamp_ns) {
    const TimeNs shift = GpsTimeFromWeek(scale, 0, 0);
    return SecondsBetween(0, (stamp_ns - shift) % kWeekNs);
  };
  const TimeNs whole_weeks = (e.toe_ns - GpsTimeFromWeek(scale, 0, 0)) / kWeekNs;
  const auto week = static_cast<double>(whole_weeks);
  const bool two_delays = system == GnssSystem::kGalileo || system == GnssSystem::kBeidou;
  std::string text =
      MessageLabel(e.satellite, scale, e.toc_ns) + Number(e.af0) + Number(e.af1) + Number(e.af2) + "\n";
  text += NumberLine(e.issue, e.crs, e.delta_n, e.m0);
  text += NumberLine(e.cuc, e.eccentricity, e.cus, e.sqrt_a);
  text += NumberLine(e.toe_of_week_s, e.cic, e.omega0, e.cis);
  text += NumberLine(e.i0, e.crc, e.omega, e.omega_dot);
  text += NumberLine(e.i_dot, e.data_source, week, 0);
  text += NumberLine(e.accuracy_m, e.health, e.group_delay_s[0], two_delays ? e.group_delay_s[1] : e.issue);
  return text + "    " + Number(of_week(e.transmission_ns)) + "\n";
}

std::string GlonassText(const GlonassEphemeris& e) {
  constexpr double kKilometre = 1e-3;
  const Eigen::Vector3d p = kKilometre * e.position_m;
  const Eigen::Vector3d v = kKilometre * e.velocity_mps;
  const Eigen::Vector3d a = kKilometre * e.acceleration_mps2;
  const TimeNs sent_utc = e.transmission_ns - LeapSeconds(e.transmission_ns) * kSecondNs;
  const double of_week = SecondsBetween(0, WeekFromGpsTime(sent_utc).of_week_ns);
  return MessageLabel(e.satellite, TimeScale::kUtc, e.toe_ns) + Number(e.clock_bias_s) +
         Number(e.clock_drift) + Number(of_week) + "\n" + NumberLine(p.x(), v.x(), a.x(), e.health) +
         NumberLine(p.y(), v.y(), a.y(), e.channel) + NumberLine(p.z(), v.z(), a.z(), 0);
}

std::string KlobucharLines(const char* system, const KlobucharParameters& parameters) {
  std::string text;
  for (const auto& [letter, values] : {std::pair('A', parameters.alpha), std::pair('B', parameters.beta)}) {
    text += HeaderLine(
        Format("%s%c %12.4E%12.4E%12.4E%12.4E", system, letter, values[0], values[1], values[2], values[3]),
        "IONOSPHERIC CORR");
  }
  return text;
}

}  // namespace

std::string FormatRinexObservation(const ObservationFile& file) {
  const auto signals = SignalsOf(file);
  std::string text = ObservationHeader(file, signals);
  for (const ObservationEpoch& epoch : file.epochs) {
    const CalendarTime t = CalendarFromGpsTime(TimeScale::kGps, epoch.stamp_ns);
    text += Format("> %04d %02d %02d %02d %02d %2d.%07d  0%3zu\n", t.year, t.month, t.day, t.hour, t.minute,
                   t.second, static_cast<int>(t.nanoseconds / 100), epoch.satellites.size());
    for (const SatelliteObservation& observed : epoch.satellites) {
      text += SatelliteLine(observed, signals.at(observed.satellite.system));
    }
  }
  return text;
}

std::string FormatRinexNavigation(const NavigationData& data) {
  std::string text =
      HeaderLine(Format("%9.2f%11s%-20s%c", 3.04, "", "N: GNSS NAV DATA", 'M'), "RINEX VERSION / TYPE");
  text += HeaderLine("alidade", "PGM / RUN BY / DATE");
  if (data.gps_ionosphere) {
    text += KlobucharLines("GPS", *data.gps_ionosphere);
  }
  if (data.beidou_ionosphere) {
    text += KlobucharLines("BDS", *data.beidou_ionosphere);
  }
  if (data.leap_seconds) {
    text += HeaderLine(Format("%6d", *data.leap_seconds), "LEAP SECONDS");
  }
  text += HeaderLine("", "END OF HEADER");
  for (const auto& [id, list] : data.kepler) {
    for (const KeplerEphemeris& e : list) {
      text += KeplerText(e);
    }
  }
  for (const auto& [number, list] : data.glonass) {
    for (const GlonassEphemeris& e : list) {
      text += GlonassText(e);
    }
  }
  return text;
}

}  // namespace alidade
