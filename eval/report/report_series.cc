#include "eval/report/report_series.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/numbers.h"
#include "eval/comparison/series_rows.h"
#include "eval/report/report_json.h"

namespace alidade {
namespace {

/// Three components of a series of vectors, scaled; empty when the series is absent.
template <typename Vectors>
Json PackComponents(const Vectors& vectors, int first, double scale, double finest) {
  Json components = Json::array();
  for (int axis = first; axis < first + 3 && !vectors.empty(); ++axis) {
    std::vector<double> values;
    values.reserve(vectors.size());
    for (const auto& vector : vectors) {
      values.push_back(vector(axis) * scale);
    }
    components.push_back(PackedJson(values, finest));
  }
  return components;
}

/// Below the floor there is rounding alone, whose digits would only lengthen the axis.
Json LeakJson(std::vector<double> leaks) {
  constexpr double kFloor = 1e-12;
  for (double& leak : leaks) {
    leak = std::isfinite(leak) ? std::max(leak, kFloor) : leak;
  }
  return RoundedJson(leaks, 3);
}

/// One character a row; empty when all rows are regular.
std::string RegularMask(const std::vector<bool>& regular) {
  std::string mask;
  for (const bool is_regular : regular) {
    mask += is_regular ? '1' : '0';
  }
  return mask.find('0') == std::string::npos ? "" : mask;
}

}  // namespace

int PointsPerSeries(size_t cells, bool audited) {
  // A point of one cell is 24 numbers: measured at 85 to 105 characters; an audit adds up to 22.
  const double budget = 4.3e6 / ((audited ? 127.0 : 105.0) * static_cast<double>(std::max<size_t>(1, cells)));
  return static_cast<int>(std::clamp(budget, 60.0, 1000.0));
}

PackedColumn PackColumn(const std::vector<double>& values, double finest) {
  double largest = 0;
  for (const double value : values) {
    largest = std::isfinite(value) ? std::max(largest, std::abs(value)) : largest;
  }
  PackedColumn column;
  column.quantum = finest;
  if (largest > 0) {
    const double fine = std::pow(10.0, std::floor(std::log10(largest / 2000)));
    const double coarse = std::pow(10.0, std::ceil(std::log10(largest / 1e15)));
    column.quantum = std::max(std::min(finest, fine), coarse);
  }
  long long last = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) {
      column.deltas.emplace_back(false, 0);
      continue;
    }
    const long long now = std::llround(value / column.quantum);
    column.deltas.emplace_back(true, now - last);
    last = now;
  }
  return column;
}

Json PackedJson(const std::vector<double>& values, double finest) {
  const PackedColumn column = PackColumn(values, finest);
  Json deltas = Json::array();
  for (const auto& [finite, delta] : column.deltas) {
    deltas.push_back(finite ? Json(delta) : Json(nullptr));
  }
  return {{"q", column.quantum}, {"d", deltas}};
}

Json SeriesJson(const CellSeries& whole, int most) {
  const bool fits = whole.time_s.size() <= static_cast<size_t>(most);
  const CellSeries thinned =
      fits ? CellSeries() : TakeRows(whole, PickRows(whole, static_cast<size_t>(most) / 2));
  const CellSeries& series = fits ? whole : thinned;
  Json sensors = Json::object();
  for (const auto& [key, ratios] : series.sensor_nis_ratio) {
    sensors[key] = RoundedJson(ratios, 3);
  }
  return {{"t", PackedJson(series.time_s, 1e-3)},
          {"regular", RegularMask(series.regular)},
          {"truth", PackComponents(series.truth_position, 0, 1.0, 1e-3)},
          {"est", PackComponents(series.position, 0, 1.0, 1e-3)},
          {"ori", PackComponents(series.error, 0, kDegreesPerRadian, 1e-3)},
          {"ori_sigma", PackComponents(series.sigma, 0, kDegreesPerRadian, 1e-3)},
          {"pos", PackComponents(series.error, 3, 1.0, 1e-3)},
          {"pos_sigma", PackComponents(series.sigma, 3, 1.0, 1e-3)},
          {"nees", RoundedJson(series.nees_pose, 3)},
          {"ms", RoundedJson(series.backend_ms, 3)},
          {"ms_quantiles", RoundedJson(BoxQuantiles(whole.backend_ms), 4)},
          {"features", RoundedJson(series.features_used, 4)},
          {"tracks", RoundedJson(series.tracks_in, 4)},
          {"nis", RoundedJson(series.nis_ratio, 3)},
          {"sensor_nis", sensors},
          {"rank", RoundedJson(series.rank, 2)},
          {"yaw_leak", LeakJson(series.yaw_leak)},
          {"position_leak", LeakJson(series.position_leak)}};
}

Json SkyJson(const std::vector<SkyTrack>& tracks) {
  Json list = Json::array();
  for (const SkyTrack& track : tracks) {
    Json t = Json::array(), x = Json::array(), y = Json::array(), r = Json::array();
    for (size_t i = 0; i < track.time_s.size(); ++i) {
      const double azimuth = track.azimuth_deg[i] / kDegreesPerRadian;
      const double down = 90 - track.elevation_deg[i];
      t.push_back(RoundedJson(track.time_s[i], 5));
      x.push_back(RoundedJson(down * std::sin(azimuth), 4));
      y.push_back(RoundedJson(down * std::cos(azimuth), 4));
      r.push_back(RoundedJson(track.residual_m[i], 4));
    }
    list.push_back({{"s", track.satellite},
                    {"t", t},
                    {"x", x},
                    {"y", y},
                    {"r", r},
                    {"used", RoundedJson(track.used_share, 4)},
                    {"rms", RoundedJson(track.rms_m, 4)}});
  }
  return list;
}

}  // namespace alidade
