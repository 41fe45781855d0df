#include "eval/rosbag/gnss_receiver_messages.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "eval/rosbag/gnss_message_time.h"
#include "eval/rosbag/ros_header.h"

namespace alidade {
namespace {

// Time systems as gnss_comm and RTKLIB number them.
constexpr std::uint32_t kSystemGps = 0x01;
constexpr std::uint32_t kSystemGlonass = 0x04;
constexpr std::uint32_t kSystemGalileo = 0x08;
constexpr std::uint32_t kSystemBeidou = 0x20;
constexpr int kGalileoWeekOffset = 1024;  // GST counts weeks from 1999-08-22

}  // namespace

std::string EncodeIonosphere(TimeNs stamp_ns, const KlobucharParameters& parameters) {
  ByteWriter out;
  PutRosHeader(stamp_ns, &out);
  std::vector<double> values(parameters.alpha.begin(), parameters.alpha.end());
  values.insert(values.end(), parameters.beta.begin(), parameters.beta.end());
  out.Array(values);
  return std::move(out.bytes());
}

Result<KlobucharParameters> DecodeIonosphere(std::string_view bytes) {
  ByteReader in(bytes);
  static_cast<void>(TakeRosHeader(&in));
  const std::vector<double> values = in.Array<double>();
  const bool finite = std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (!in.ok() || values.size() != 8 || !finite) {
    return Status::Input(Format("%zu parameters of the ionosphere, expected 8 finite ones", values.size()));
  }
  KlobucharParameters parameters;
  std::copy_n(values.begin(), 4, parameters.alpha.begin());
  std::copy_n(values.begin() + 4, 4, parameters.beta.begin());
  return parameters;
}

std::string EncodeSolution(const ReceiverSolution& s) {
  ByteWriter out;
  PutGnssTime(s.stamp_ns, &out);
  out.Write(std::uint8_t{3});  // a fix in three dimensions
  out.Write(static_cast<std::uint8_t>(s.valid));
  out.Write(static_cast<std::uint8_t>(s.carrier > 0));
  out.Write(static_cast<std::uint8_t>(s.carrier));
  out.Write(std::uint8_t{0});
  for (const double value : {s.latitude_deg, s.longitude_deg, s.height_m, s.height_m, s.horizontal_accuracy_m,
                             s.vertical_accuracy_m, 0.0, 0.0, 0.0, 0.0, 0.0}) {
    out.Write(value);
  }
  return std::move(out.bytes());
}

Result<ReceiverSolution> DecodeSolution(std::string_view bytes) {
  ByteReader in(bytes);
  const Result<TimeNs> time = TakeGnssTime(&in);
  ReceiverSolution s;
  static_cast<void>(in.Read<std::uint8_t>());
  s.valid = in.Read<std::uint8_t>() != 0;
  static_cast<void>(in.Read<std::uint8_t>());
  s.carrier = in.Read<std::uint8_t>();
  static_cast<void>(in.Read<std::uint8_t>());
  s.latitude_deg = in.Read<double>();
  s.longitude_deg = in.Read<double>();
  s.height_m = in.Read<double>();
  static_cast<void>(in.Read<double>());
  s.horizontal_accuracy_m = in.Read<double>();
  s.vertical_accuracy_m = in.Read<double>();
  static_cast<void>(in.Take(5 * sizeof(double)));
  ALIDADE_RETURN_IF_ERROR(CheckWhole(in));
  ALIDADE_RETURN_IF_ERROR(time.status());
  s.stamp_ns = *time;
  if (s.valid &&
      !(std::abs(s.latitude_deg) <= 90 && std::abs(s.longitude_deg) <= 360 && std::abs(s.height_m) < 1e5)) {
    return Status::Input(Format("latitude %g, longitude %g, height %g, expected a place on the Earth",
                                s.latitude_deg, s.longitude_deg, s.height_m));
  }
  return s;
}

std::string EncodeTimePulse(TimeNs pulse_ns) {
  ByteWriter out;
  PutGnssTime(pulse_ns, &out);
  out.Write(std::uint8_t{0});
  out.Write(kSystemGps);
  return std::move(out.bytes());
}

Result<TimeNs> DecodeTimePulse(std::string_view bytes) {
  ByteReader in(bytes);
  const Result<TimeNs> time = TakeGnssTime(&in);
  const bool utc = in.Read<std::uint8_t>() != 0;
  const auto system = in.Read<std::uint32_t>();
  ALIDADE_RETURN_IF_ERROR(CheckWhole(in));
  ALIDADE_RETURN_IF_ERROR(time.status());
  if (utc || system == kSystemGlonass) {
    return *time + LeapSeconds(*time) * kSecondNs;
  }
  if (system == kSystemGalileo) {
    return *time + kGalileoWeekOffset * kWeekNs;
  }
  if (system == kSystemBeidou) {
    return *time - GpsTimeFromWeek(TimeScale::kGps, 0, 0) + GpsTimeFromWeek(TimeScale::kBeidou, 0, 0);
  }
  return system == kSystemGps ? time
                              : Result<TimeNs>(Status::Input(Format("time system %u is unknown", system)));
}

std::string EncodeTrigger(TimeNs stamp_ns) {
  ByteWriter out;
  PutRosHeader(stamp_ns, &out);
  out.Write(std::uint32_t{0});
  out.Write(std::uint32_t{0});
  PutRosTime(stamp_ns, &out);
  return std::move(out.bytes());
}

Result<TimeNs> DecodeTrigger(std::string_view bytes) {
  ByteReader in(bytes);
  const TimeNs stamp_ns = TakeRosHeader(&in);
  static_cast<void>(in.Take(16));
  ALIDADE_RETURN_IF_ERROR(CheckWhole(in));
  return stamp_ns;
}

}  // namespace alidade
