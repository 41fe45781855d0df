#include "eval/rosbag/gnss_navigation_messages.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/format.h"
#include "eval/rosbag/gnss_message_time.h"
#include "eval/rosbag/gnss_messages.h"
#include "eval/rosbag/ros_header.h"
#include "gnss/formats/glonass_accuracy.h"
#include "gnss/formats/navigation_message.h"

namespace alidade {
namespace {

TimeScale ScaleOf(GnssSystem system) {
  return system == GnssSystem::kBeidou ? TimeScale::kBeidou : TimeScale::kGps;
}

double SecondsOfWeek(TimeScale scale, TimeNs gpst_ns) {
  return static_cast<double>((gpst_ns - GpsTimeFromWeek(scale, 0, 0)) % kWeekNs) / 1e9;
}

/// What the bytes hold beside the satellite.
struct KeplerMessage {
  TimeNs sent_ns = 0, toe_ns = 0, toc_ns = 0;
  std::uint32_t issue = 0, health = 0, code = 0;
  std::array<double, 21> values{};
};

/// The numbers in the order of a RINEX message, whose reader checks them against the bounds of the messages.
RawNavMessage RawMessage(const KeplerMessage& message, SatelliteId satellite) {
  const TimeScale scale = ScaleOf(satellite.system);
  const auto& v = message.values;
  RawNavMessage raw{satellite, CalendarFromGpsTime(scale, message.toc_ns), {}};
  raw.numbers = {v[16],
                 v[17],
                 v[18],
                 message.issue,
                 v[13],
                 v[7],
                 v[6],
                 v[10],
                 v[2],
                 v[11],
                 std::sqrt(v[1]),
                 SecondsOfWeek(scale, message.toe_ns),
                 v[14],
                 v[5],
                 v[15],
                 v[3],
                 v[12],
                 v[4],
                 v[8],
                 v[9],
                 message.code,
                 0,
                 0,
                 v[0],
                 message.health,
                 v[19],
                 v[20],
                 SecondsOfWeek(scale, message.sent_ns)};
  return raw;
}

}  // namespace

std::optional<std::string> EncodeEphemeris(const KeplerEphemeris& e) {
  const std::optional<std::uint32_t> number = GnssCommNumber(e.satellite);
  if (!number) {
    return std::nullopt;
  }
  ByteWriter out;
  out.Write(*number);
  PutGnssTime(e.transmission_ns, &out);
  PutGnssTime(e.toe_ns, &out);
  PutGnssTime(e.toc_ns, &out);
  const WeekTime toe = WeekFromGpsTime(e.toe_ns);
  out.Write(static_cast<double>(toe.of_week_ns) / 1e9);
  for (const int value : {toe.week, e.issue, e.issue, e.health, e.data_source}) {
    out.Write(static_cast<std::uint32_t>(value));
  }
  for (const double value : {e.accuracy_m,
                             e.sqrt_a * e.sqrt_a,
                             e.eccentricity,
                             e.i0,
                             e.omega,
                             e.omega0,
                             e.m0,
                             e.delta_n,
                             e.omega_dot,
                             e.i_dot,
                             e.cuc,
                             e.cus,
                             e.crc,
                             e.crs,
                             e.cic,
                             e.cis,
                             e.af0,
                             e.af1,
                             e.af2,
                             e.group_delay_s[0],
                             e.group_delay_s[1],
                             0.0,
                             0.0}) {
    out.Write(value);
  }
  return std::move(out.bytes());
}

Result<KeplerEphemeris> DecodeKeplerEphemeris(std::string_view bytes) {
  ByteReader in(bytes);
  const std::optional<SatelliteId> satellite = SatelliteOfGnssCommNumber(in.Read<std::uint32_t>());
  const Result<TimeNs> sent = TakeGnssTime(&in);
  const Result<TimeNs> toe = TakeGnssTime(&in);
  const Result<TimeNs> toc = TakeGnssTime(&in);
  KeplerMessage message;
  // toe_tow and week: the same as toe, in a scale on which writers do not agree.
  static_cast<void>(in.Take(sizeof(double) + sizeof(std::uint32_t)));
  message.issue = in.Read<std::uint32_t>();
  static_cast<void>(in.Read<std::uint32_t>());
  message.health = in.Read<std::uint32_t>();
  message.code = in.Read<std::uint32_t>();
  for (double& value : message.values) {
    value = in.Read<double>();
  }
  static_cast<void>(in.Take(2 * sizeof(double)));
  ALIDADE_RETURN_IF_ERROR(CheckWhole(in));
  for (const Result<TimeNs>* time : {&sent, &toe, &toc}) {
    ALIDADE_RETURN_IF_ERROR(time->status());
  }
  if (!satellite || satellite->system == GnssSystem::kGlonass) {
    return Status::Input("a satellite number outside GPS, Galileo and BeiDou");
  }
  message.sent_ns = *sent;
  message.toe_ns = *toe;
  message.toc_ns = *toc;
  return MakeKeplerEphemeris(RawMessage(message, *satellite), std::nullopt);
}

std::optional<std::string> EncodeEphemeris(const GlonassEphemeris& e) {
  const std::optional<std::uint32_t> number = GnssCommNumber(e.satellite);
  if (!number) {
    return std::nullopt;
  }
  ByteWriter out;
  out.Write(*number);
  PutGnssTime(e.transmission_ns, &out);
  PutGnssTime(e.toe_ns, &out);
  out.Write(static_cast<std::int32_t>(e.channel));
  constexpr TimeNs kQuarterHourNs = 900 * kSecondNs;
  constexpr TimeNs kMoscowNs = 3 * 3600 * kSecondNs;
  const TimeNs moscow_ns = e.toe_ns - LeapSeconds(e.toe_ns) * kSecondNs + kMoscowNs;
  out.Write(static_cast<std::uint32_t>(moscow_ns % kDayNs / kQuarterHourNs));
  out.Write(static_cast<std::uint32_t>(e.health));
  out.Write(std::uint32_t{0});
  out.Write(kGlonassAccuracyM);
  for (const Eigen::Vector3d* vector : {&e.position_m, &e.velocity_mps, &e.acceleration_mps2}) {
    for (int i = 0; i < 3; ++i) {
      out.Write((*vector)[i]);
    }
  }
  for (const double value : {-e.clock_bias_s, e.clock_drift, e.l2_delay_s.value_or(0)}) {
    out.Write(value);
  }
  return std::move(out.bytes());
}

Result<GlonassEphemeris> DecodeGlonassEphemeris(std::string_view bytes) {
  ByteReader in(bytes);
  const std::optional<SatelliteId> satellite = SatelliteOfGnssCommNumber(in.Read<std::uint32_t>());
  const Result<TimeNs> sent = TakeGnssTime(&in);
  const Result<TimeNs> toe = TakeGnssTime(&in);
  const auto channel = in.Read<std::int32_t>();
  static_cast<void>(in.Read<std::uint32_t>());
  const auto health = in.Read<std::uint32_t>();
  static_cast<void>(in.Take(sizeof(std::uint32_t) + sizeof(double)));
  Eigen::Vector3d vectors[3];
  for (Eigen::Vector3d& vector : vectors) {
    for (int i = 0; i < 3; ++i) {
      vector[i] = in.Read<double>();
    }
  }
  const auto tau = in.Read<double>();
  const auto gamma = in.Read<double>();
  const auto l2_delay = in.Read<double>();
  ALIDADE_RETURN_IF_ERROR(CheckWhole(in));
  ALIDADE_RETURN_IF_ERROR(sent.status());
  ALIDADE_RETURN_IF_ERROR(toe.status());
  if (!satellite || satellite->system != GnssSystem::kGlonass) {
    return Status::Input("a satellite number outside GLONASS");
  }
  constexpr double kKilometre = 1e-3;
  RawNavMessage raw{*satellite, CalendarFromGpsTime(TimeScale::kUtc, *toe), {-tau, gamma, std::nullopt}};
  for (int axis = 0; axis < 3; ++axis) {
    for (const Eigen::Vector3d& vector : vectors) {
      raw.numbers.push_back(kKilometre * vector[axis]);
    }
    raw.numbers.push_back(axis == 0   ? static_cast<double>(health)
                          : axis == 1 ? static_cast<double>(channel)
                                      : 0.0);
  }
  Result<GlonassEphemeris> made = MakeGlonassEphemeris(raw);
  if (made.ok()) {
    // As sent, without the way through kilometres.
    made->position_m = vectors[0];
    made->velocity_mps = vectors[1];
    made->acceleration_mps2 = vectors[2];
    made->transmission_ns = *sent;
    made->l2_delay_s = l2_delay != 0 && std::abs(l2_delay) < 1e-6 ? std::optional(l2_delay) : std::nullopt;
  }
  return made;
}

}  // namespace alidade
