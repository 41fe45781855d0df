#include "gnss/formats/navigation_message.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"

namespace alidade {
namespace {

constexpr double kUnknownTime = 0.9999e9;   // RINEX for "not known"
constexpr std::size_t kKeplerNumbers = 27;  // the clock's and six lines: all but the time of transmission

/// Reads numbers by position, 0-based over (clock 3, then 4 a line), and keeps the first fault.
class Numbers {
 public:
  explicit Numbers(const RawNavMessage& raw) : raw_(raw) {}

  double Optional(std::size_t i, double otherwise = 0) const {
    return i < raw_.numbers.size() ? raw_.numbers[i].value_or(otherwise) : otherwise;
  }
  double In(std::size_t i, const char* name, double low, double high) {
    const std::optional<double> value = i < raw_.numbers.size() ? raw_.numbers[i] : std::nullopt;
    if (!value || !(*value >= low && *value <= high)) {
      if (fault_.ok()) {
        const std::string found = value ? Format("%g", *value) : "nothing";
        fault_ = Status::Input(ToString(raw_.satellite) + ": " + name + ": found " + found +
                               Format(", expected %g to %g", low, high));
      }
      return low;
    }
    return *value;
  }
  [[nodiscard]] const Status& fault() const { return fault_; }

 private:
  const RawNavMessage& raw_;
  Status fault_;
};

TimeScale ScaleOf(GnssSystem system) {
  switch (system) {
    case GnssSystem::kBeidou:
      return TimeScale::kBeidou;
    case GnssSystem::kGlonass:
      return TimeScale::kUtc;
    default:
      return TimeScale::kGps;
  }
}

/// A health or flag word: anything that is no small integer counts as unhealthy.
int ToHealth(double value) {
  return value >= 0 && value < 1e6 ? static_cast<int>(value) : 1;
}

NavMessage DeriveMessage(SatelliteId satellite, int data_source) {
  switch (satellite.system) {
    case GnssSystem::kBeidou:
      return IsBeidouGeo(satellite) ? NavMessage::kD2 : NavMessage::kD1;
    case GnssSystem::kGalileo:
      // Bit 8: the clock is that of E1 and E5a; bit 1: sent on E5a. Old files leave it at zero.
      return (data_source & 0x102) != 0 ? NavMessage::kFnav : NavMessage::kInav;
    default:
      return NavMessage::kLnav;
  }
}

void ReadElements(Numbers* n, KeplerEphemeris* e) {
  e->af0 = n->In(0, "clock bias", -0.1, 0.1);
  e->af1 = n->In(1, "clock drift", -1e-6, 1e-6);
  e->af2 = n->In(2, "clock drift rate", -1e-10, 1e-10);
  e->issue = static_cast<int>(n->In(3, "issue of data", 0, 65535));
  e->crs = n->In(4, "Crs", -1e4, 1e4);
  e->delta_n = n->In(5, "delta n", -1e-6, 1e-6);
  e->m0 = n->In(6, "M0", -7, 7);
  e->cuc = n->In(7, "Cuc", -1e-2, 1e-2);
  e->eccentricity = n->In(8, "eccentricity", 0, 0.5);
  e->cus = n->In(9, "Cus", -1e-2, 1e-2);
  e->sqrt_a = n->In(10, "square root of the semi-major axis", 4000, 8000);
  e->toe_of_week_s = n->In(11, "time of ephemeris", 0, 604800);
  e->cic = n->In(12, "Cic", -1e-2, 1e-2);
  e->omega0 = n->In(13, "OMEGA0", -7, 7);
  e->cis = n->In(14, "Cis", -1e-2, 1e-2);
  e->i0 = n->In(15, "i0", -7, 7);
  e->crc = n->In(16, "Crc", -1e4, 1e4);
  e->omega = n->In(17, "omega", -7, 7);
  e->omega_dot = n->In(18, "OMEGA DOT", -1e-6, 1e-6);
  e->i_dot = n->In(19, "IDOT", -1e-6, 1e-6);
}

}  // namespace

bool IsBeidouGeo(SatelliteId satellite) {
  return satellite.system == GnssSystem::kBeidou &&
         (satellite.number <= 5 || (satellite.number >= 59 && satellite.number <= 63));
}

Result<KeplerEphemeris> MakeKeplerEphemeris(const RawNavMessage& raw, std::optional<NavMessage> message) {
  const TimeScale scale = ScaleOf(raw.satellite.system);
  const Result<TimeNs> toc = GpsTimeFromCalendar(scale, raw.epoch);
  if (!toc.ok()) {
    return Status::Input(ToString(raw.satellite) + ": epoch: " + toc.message());
  }
  if (raw.numbers.size() < kKeplerNumbers) {
    return Status::Input(ToString(raw.satellite) + Format(": holds %zu numbers, expected at least %zu",
                                                          raw.numbers.size(), kKeplerNumbers));
  }
  Numbers n(raw);
  KeplerEphemeris e;
  e.satellite = raw.satellite;
  e.toc_ns = *toc;
  ReadElements(&n, &e);
  e.data_source = raw.satellite.system == GnssSystem::kGalileo ? ToHealth(n.Optional(20)) : 0;
  e.message = message.value_or(DeriveMessage(raw.satellite, e.data_source));
  // Files disagree about the week near its end; the clock's calendar date settles it.
  e.toe_ns = NearestTimeOfWeek(scale, SecondsToNs(e.toe_of_week_s), e.toc_ns);
  e.accuracy_m = n.Optional(23, 2);
  // Galileo codes "no accuracy" as a negative number.
  e.accuracy_m = e.accuracy_m < 0 || e.accuracy_m > 8192 ? 8192 : std::max(e.accuracy_m, 0.1);
  e.health = ToHealth(n.Optional(24));
  e.group_delay_s[0] = n.Optional(25);
  if (raw.satellite.system == GnssSystem::kGalileo || raw.satellite.system == GnssSystem::kBeidou) {
    e.group_delay_s[1] = n.Optional(26);  // of GPS and QZSS the clock's issue
  }
  for (double& delay : e.group_delay_s) {
    delay = std::abs(delay) < 1e-6 ? delay : 0;
  }
  const double sent = n.Optional(27, kUnknownTime);
  e.transmission_ns =
      sent >= 0 && sent <= 604800 ? NearestTimeOfWeek(scale, SecondsToNs(sent), e.toe_ns) : e.toc_ns;
  if (!n.fault().ok()) {
    return n.fault();
  }
  return e;
}

Result<GlonassEphemeris> MakeGlonassEphemeris(const RawNavMessage& raw) {
  const Result<TimeNs> toe = GpsTimeFromCalendar(TimeScale::kUtc, raw.epoch);
  if (!toe.ok()) {
    return Status::Input(ToString(raw.satellite) + ": epoch: " + toe.message());
  }
  Numbers n(raw);
  GlonassEphemeris e;
  e.satellite = raw.satellite;
  e.toe_ns = *toe;
  e.clock_bias_s = n.In(0, "clock bias", -0.1, 0.1);
  e.clock_drift = n.In(1, "relative frequency bias", -1e-6, 1e-6);
  constexpr double kMetres = 1e3;  // the file is in kilometres
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t i = 3 + 4 * static_cast<std::size_t>(axis);
    e.position_m[axis] = kMetres * n.In(i, kAxes[axis], -3e4, 3e4);
    e.velocity_mps[axis] = kMetres * n.In(i + 1, "velocity", -10, 10);
    e.acceleration_mps2[axis] = kMetres * n.In(i + 2, "acceleration", -1e-6, 1e-6);
  }
  e.health = ToHealth(n.Optional(6));
  // Old files hold channels 1 to 24 modulo 256.
  const double channel = n.In(10, "frequency channel", -7, 256);
  e.channel = static_cast<int>(channel > 128 ? channel - 256 : channel);
  if (n.fault().ok() && (e.position_m.norm() < 2e7 || e.position_m.norm() > 3e7)) {
    return Status::Input(ToString(raw.satellite) +
                         Format(": %.0f m from the Earth's centre", e.position_m.norm()));
  }
  if (n.fault().ok() && (e.channel < -7 || e.channel > 13)) {
    return Status::Input(ToString(raw.satellite) +
                         Format(": frequency channel: found %d, expected -7 to 13", e.channel));
  }
  const double delay = n.Optional(16, kUnknownTime);
  if (std::abs(delay) < 1e-6) {
    e.l2_delay_s = delay;
  }
  // RINEX 3 gives seconds of the UTC week, RINEX 2 of the day.
  const double sent = n.Optional(2, kUnknownTime);
  e.transmission_ns = e.toe_ns;
  if (sent >= 0 && sent <= 604800) {
    const TimeNs leap = LeapSeconds(e.toe_ns) * kSecondNs;
    const TimeNs near = NearestTimeOfWeek(TimeScale::kGps, SecondsToNs(sent), e.toe_ns - leap) + leap;
    e.transmission_ns = std::abs(near - e.toe_ns) <= kDayNs / 2 ? near : e.toe_ns;
  }
  if (!n.fault().ok()) {
    return n.fault();
  }
  return e;
}

}  // namespace alidade
