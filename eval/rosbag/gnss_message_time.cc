#include "eval/rosbag/gnss_message_time.h"

#include "core/format.h"

namespace alidade {
namespace {

constexpr std::uint32_t kMaxWeek = 5000;

}  // namespace

void PutGnssTime(TimeNs gpst_ns, ByteWriter* out) {
  const WeekTime week = WeekFromGpsTime(gpst_ns);
  out->Write(static_cast<std::uint32_t>(week.week));
  out->Write(static_cast<double>(week.of_week_ns) / 1e9);  // nearest double, unlike a product with 1e-9
}

Result<TimeNs> TakeGnssTime(ByteReader* in) {
  const auto week = in->Read<std::uint32_t>();
  const auto second = in->Read<double>();
  if (week > kMaxWeek || !(second >= 0 && second <= 604800)) {
    return Status::Input(
        Format("week %u, second %g, expected a week up to %u and a second of it", week, second, kMaxWeek));
  }
  return GpsTimeFromWeek(TimeScale::kGps, static_cast<int>(week), SecondsToNs(second));
}

Status CheckWhole(const ByteReader& in) {
  return in.ok() ? Status::Ok() : Status::Input("is torn");
}

}  // namespace alidade
