#pragma once

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "eval/comparison/comparison.h"

namespace alidade {

/// Most points of a series on the page, so that the page of `cells` cells, audited or not, stays below about
/// 5 MB.
[[nodiscard]] int PointsPerSeries(size_t cells, bool audited = false);

/// A column of numbers as integers for the page: value = quantum * (running sum of `deltas`). Neighbouring
/// values of a trajectory differ little, so that the differences take two or three characters each.
struct PackedColumn {
  double quantum = 1;
  std::vector<std::pair<bool, long long>> deltas;  ///< {false, 0} where the value is not finite: a gap
};

/// Packs with a resolution of `finest`, or of 1/2000 of the largest magnitude where that is finer still;
/// coarser only where a diverged run's values would not fit the 53 bits of a script's integers.
[[nodiscard]] PackedColumn PackColumn(const std::vector<double>& values, double finest);
[[nodiscard]] nlohmann::ordered_json PackedJson(const std::vector<double>& values, double finest);

/// A series as the page's scripts unpack it (assets/report_data.js), thinned to about `most` rows
/// that keep every curve's extremes.
[[nodiscard]] nlohmann::ordered_json SeriesJson(const CellSeries& series, int most);

/// Directions as points of a sky plot: zenith at the centre, x east, y north, radius 90 at the horizon.
[[nodiscard]] nlohmann::ordered_json SkyJson(const std::vector<SkyTrack>& tracks);

}  // namespace alidade
