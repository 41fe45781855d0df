#include "gnss/formats/ephemeris.h"

#include <algorithm>
#include <tuple>

namespace alidade {
namespace {

auto Key(const KeplerEphemeris& e) {
  return std::tuple(e.toe_ns, e.message, e.transmission_ns, e.toc_ns, e.issue, e.data_source, e.health,
                    e.af0);
}

auto Key(const GlonassEphemeris& e) {
  return std::tuple(e.toe_ns, e.transmission_ns, e.health, e.clock_bias_s);
}

template <typename Ephemeris>
void MergeLists(std::vector<Ephemeris> more, std::vector<Ephemeris>* list) {
  list->insert(list->end(), more.begin(), more.end());
  std::stable_sort(list->begin(), list->end(), [](const auto& a, const auto& b) { return Key(a) < Key(b); });
  list->erase(
      std::unique(list->begin(), list->end(), [](const auto& a, const auto& b) { return Key(a) == Key(b); }),
      list->end());
}

}  // namespace

std::string_view ToString(NavMessage message) {
  switch (message) {
    case NavMessage::kLnav:
      return "LNAV";
    case NavMessage::kInav:
      return "INAV";
    case NavMessage::kFnav:
      return "FNAV";
    case NavMessage::kD1:
      return "D1";
    case NavMessage::kD2:
      return "D2";
    case NavMessage::kFdma:
      break;
  }
  return "FDMA";
}

std::size_t NavigationData::ephemerides() const {
  std::size_t count = 0;
  for (const auto& [id, list] : kepler) {
    count += list.size();
  }
  for (const auto& [number, list] : glonass) {
    count += list.size();
  }
  return count;
}

void NavigationData::Merge(NavigationData other) {
  for (auto& [id, list] : other.kepler) {
    MergeLists(std::move(list), &kepler[id]);
  }
  for (auto& [number, list] : other.glonass) {
    MergeLists(std::move(list), &glonass[number]);
  }
  gps_ionosphere = gps_ionosphere ? gps_ionosphere : other.gps_ionosphere;
  beidou_ionosphere = beidou_ionosphere ? beidou_ionosphere : other.beidou_ionosphere;
  galileo_ionosphere = galileo_ionosphere ? galileo_ionosphere : other.galileo_ionosphere;
  leap_seconds = leap_seconds ? leap_seconds : other.leap_seconds;
  passed_over += other.passed_over;
  warnings.Merge(std::move(other.warnings));
}

}  // namespace alidade
