#include "gnss/formats/precise_products.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"

namespace alidade {
namespace {

constexpr double kBadClockUs = 999'999;

template <typename Node>
void SortNodes(std::vector<Node>* nodes) {
  std::stable_sort(nodes->begin(), nodes->end(),
                   [](const Node& a, const Node& b) { return a.stamp_ns < b.stamp_ns; });
  nodes->erase(std::unique(nodes->begin(), nodes->end(),
                           [](const Node& a, const Node& b) { return a.stamp_ns == b.stamp_ns; }),
               nodes->end());
}

template <typename Node>
void MergeNodes(std::map<SatelliteId, std::vector<Node>> more,
                std::map<SatelliteId, std::vector<Node>>* nodes) {
  for (auto& [id, list] : more) {
    std::vector<Node>& target = (*nodes)[id];
    target.insert(target.end(), list.begin(), list.end());
    SortNodes(&target);
  }
}

Result<TimeNs> ParseStamp(TimeScale scale, std::string_view text) {
  const Result<CalendarTime> label = ParseCalendar(text);
  return label.ok() ? GpsTimeFromCalendar(scale, *label) : Result<TimeNs>(label.status());
}

class Sp3Reader {
 public:
  Sp3Reader(const std::string& path, std::string_view text) : lines_(path, text) {}

  Result<PreciseProducts> Read() {
    if (!lines_.Next() || lines_.line().size() < 3 || lines_.line()[0] != '#' || lines_.line()[1] < 'a' ||
        lines_.line()[1] > 'd') {
      return lines_.Fault("found " + Excerpt(lines_.line()) + ", expected SP3 of version a to d");
    }
    while (lines_.Next() && !lines_.line().starts_with("EOF")) {
      const std::string_view line = lines_.line();
      if (line.starts_with("%c") && !scale_) {
        ALIDADE_RETURN_IF_ERROR(ReadScale());
      } else if (line.starts_with('*')) {
        ReadEpoch();
      } else if (line.starts_with('P') && stamp_) {
        ReadPosition();
      }
    }
    if (products_.orbits.empty()) {
      return products_.warnings.Nothing(lines_.path(), "satellite position");
    }
    PreciseProducts sorted;
    sorted.Merge(std::move(products_));
    return sorted;
  }

 private:
  Status ReadScale() {
    const std::string_view name = Field(lines_.line(), 9, 3);
    scale_ = name == "ccc" || name.empty() ? TimeScale::kGps : ParseTimeScale(name);
    return scale_ ? Status::Ok()
                  : lines_.Fault("time system: found " + Excerpt(name) +
                                 ", expected GPS, UTC, GAL, BDT, QZS, GLO or TAI");
  }

  void ReadEpoch() {
    const Result<TimeNs> stamp = ParseStamp(scale_.value_or(TimeScale::kGps), Field(lines_.line(), 1, 40));
    stamp_ = stamp.ok() ? std::optional(*stamp) : std::nullopt;
    if (!stamp.ok()) {
      products_.warnings.Add(lines_.Fault("epoch: " + stamp.message()));
    }
  }

  void ReadPosition() {
    const std::string_view line = lines_.line();
    const std::optional<SatelliteId> id = ParseSatellite(line.substr(1, 3));
    OrbitNode node{*stamp_, Eigen::Vector3d::Zero()};
    bool good = id.has_value();
    for (int i = 0; i < 3 && good; ++i) {
      const std::optional<double> km = ParseReal(Field(line, 4 + 14 * static_cast<std::size_t>(i), 14));
      good = km.has_value() && std::abs(*km) < 1e6;
      node.position_m[i] = 1e3 * km.value_or(0);
    }
    if (!good) {
      products_.warnings.Add(
          lines_.Fault("found " + Excerpt(line) + ", expected a satellite and its position"));
      return;
    }
    if (node.position_m.norm() > 6e6) {
      products_.orbits[*id].push_back(node);
    }
    const std::optional<double> clock_us = ParseReal(Field(line, 46, 14));
    if (clock_us && std::abs(*clock_us) < kBadClockUs) {
      products_.coarse_clocks[*id].push_back({*stamp_, 1e-6 * *clock_us});
    }
  }

  LineReader lines_;
  std::optional<TimeScale> scale_;
  std::optional<TimeNs> stamp_;
  PreciseProducts products_;
};

/// Labels stand at column 61, from version 3.04 on at column 66: they are looked for anywhere.
Status ReadClockHeader(LineReader* lines, TimeScale* scale) {
  bool is_clock = false;
  while (lines->Next()) {
    const std::string_view line = lines->line();
    if (line.find("RINEX VERSION / TYPE") != std::string_view::npos) {
      is_clock = line.substr(0, 60).find('C') != std::string_view::npos;
    } else if (line.find("TIME SYSTEM ID") != std::string_view::npos) {
      const std::string_view name = Field(line, 3, 3);
      const std::optional<TimeScale> parsed = name.empty() ? TimeScale::kGps : ParseTimeScale(name);
      if (!parsed) {
        return lines->Fault("time system: found " + Excerpt(name) +
                            ", expected GPS, UTC, GAL, BDT, QZS, GLO or TAI");
      }
      *scale = *parsed;
    } else if (line.find("END OF HEADER") != std::string_view::npos) {
      return is_clock ? Status::Ok() : lines->Fault("not a RINEX clock file");
    }
    if (!is_clock) {
      return lines->Fault("found " + Excerpt(line) + ", expected a RINEX clock file");
    }
  }
  return lines->Fault("the header has no END OF HEADER");
}

}  // namespace

void PreciseProducts::Merge(PreciseProducts other) {
  MergeNodes(std::move(other.orbits), &orbits);
  MergeNodes(std::move(other.clocks), &clocks);
  MergeNodes(std::move(other.coarse_clocks), &coarse_clocks);
  warnings.Merge(std::move(other.warnings));
}

Result<PreciseProducts> ParseSp3(const std::string& path, std::string_view text) {
  return Sp3Reader(path, text).Read();
}

Result<PreciseProducts> ReadSp3(const std::string& path) {
  const Result<std::string> text = ReadTextFile(path);
  return text.ok() ? ParseSp3(path, *text) : Result<PreciseProducts>(text.status());
}

Result<PreciseProducts> ParseRinexClock(const std::string& path, std::string_view text) {
  LineReader lines(path, text);
  TimeScale scale = TimeScale::kGps;
  ALIDADE_RETURN_IF_ERROR(ReadClockHeader(&lines, &scale));
  PreciseProducts products;
  while (lines.Next()) {
    if (!lines.line().starts_with("AS ")) {
      continue;  // receivers and discontinuities
    }
    std::string_view words = lines.line().substr(3);
    const std::optional<SatelliteId> id = ParseSatellite(words.substr(0, 3));
    words.remove_prefix(std::min<std::size_t>(words.size(), 3));
    std::string_view date = words;
    for (int i = 0; i < 6; ++i) {
      (void)NextWord(&words);
    }
    date.remove_suffix(words.size());
    const Result<TimeNs> stamp = ParseStamp(scale, date);
    const std::optional<int> count = ParseInteger(NextWord(&words));
    const std::optional<double> bias = ParseReal(NextWord(&words));
    if (!id || !stamp.ok() || count.value_or(0) < 1 || !bias || std::abs(*bias) > 1) {
      products.warnings.Add(
          lines.Fault("found " + Excerpt(lines.line()) + ", expected a satellite, a time and its clock"));
      continue;
    }
    products.clocks[*id].push_back({*stamp, *bias});
  }
  if (products.clocks.empty()) {
    return products.warnings.Nothing(path, "satellite clock");
  }
  PreciseProducts sorted;
  sorted.Merge(std::move(products));
  return sorted;
}

Result<PreciseProducts> ReadRinexClock(const std::string& path) {
  const Result<std::string> text = ReadTextFile(path);
  return text.ok() ? ParseRinexClock(path, *text) : Result<PreciseProducts>(text.status());
}

}  // namespace alidade
