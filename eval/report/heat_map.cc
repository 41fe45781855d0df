#include "eval/report/heat_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/format.h"
#include "core/numbers.h"
#include "eval/report/report_json.h"

namespace alidade {
namespace {

using HeatRgb = std::array<double, 3>;

/// From white to the darkest colour of each side; orange and violet are distinguishable with any colour
/// vision.
constexpr std::array<HeatRgb, 4> kWarmRamp = {
    {{255, 255, 255}, {253, 208, 149}, {236, 132, 44}, {158, 62, 4}}};
constexpr std::array<HeatRgb, 4> kColdRamp = {
    {{255, 255, 255}, {205, 200, 228}, {139, 125, 186}, {76, 34, 130}}};

/// Where the value lies between white (0) and the darkest colours (1 above, -1 below).
double Shade(const HeatMap& map, double value) {
  const double shade = std::clamp(std::log(value) / std::log(map.darkest), -1.0, 1.0);
  return map.two_sided ? shade : std::max(0.0, shade);
}

HeatRgb Blend(const HeatMap& map, double value) {
  const double shade = Shade(map, value);
  const std::array<HeatRgb, 4>& stops = shade < 0 ? kColdRamp : kWarmRamp;
  const double place = std::abs(shade) * static_cast<double>(stops.size() - 1);
  const size_t before = std::min(static_cast<size_t>(place), stops.size() - 2);
  const double part = place - static_cast<double>(before);
  HeatRgb colour;
  for (size_t i = 0; i < 3; ++i) {
    colour[i] = std::round((1 - part) * stops[before][i] + part * stops[before + 1][i]);
  }
  return colour;
}

/// Three digits at most: 0.083, 0.83, 1.02, 12.3, 123.
std::string HeatNumber(double value) {
  return value >= 99.95 ? Format("%.3g", value) : Format(value >= 9.995 ? "%.1f" : "%.2f", value);
}

std::string WhyLost(const AggregateRow& row) {
  const int most = std::max({row.diverged, row.not_initialized, row.failed});
  return most == row.diverged ? "diverged" : most == row.not_initialized ? "no start" : "failed";
}

/// What a map shows of a row.
struct HeatSource {
  HeatMap map;
  size_t figure = 0;
  HeatCell (*cell)(const AggregateRow& row, const Statistic& statistic, const Figure& figure) = nullptr;
};

HeatCell NeesCell(const AggregateRow& row, const Statistic& statistic, const Figure& figure) {
  const double ratio = statistic.mean / figure.target;
  return {ratio, HeatNumber(ratio),
          row.ok > 1 ? "worst " + HeatNumber(statistic.largest / figure.target) : "",
          row.nees_verdict == "consistent"};
}

HeatCell RatioCell(double ratio, const Statistic& statistic, const Figure& figure) {
  return {ratio, HeatNumber(ratio), FormatValue(statistic.mean, figure.decimals) + " " + figure.unit,
          ratio == 1};
}

HeatCell PositionCell(const AggregateRow& row, const Statistic& statistic, const Figure& figure) {
  return RatioCell(row.rmse_pos_to_best, statistic, figure);
}

HeatCell OrientationCell(const AggregateRow& row, const Statistic& statistic, const Figure& figure) {
  return RatioCell(row.rmse_ori_to_best, statistic, figure);
}

HeatCell CellOf(const HeatSource& source, const AggregateRow& row, const Figure& figure) {
  if (row.ok == 0) {
    return {kNan, WhyLost(row)};
  }
  HeatCell cell = source.cell(row, row.figures[source.figure], figure);
  if (std::isnan(cell.value)) {
    return {kNan, kDash};
  }
  if (row.ok < row.cells) {
    cell.detail = std::to_string(row.ok) + "/" + std::to_string(row.cells) + " ok";
    cell.strong = false;
  }
  return cell;
}

/// Fills the rows; false when there is not one value.
bool FillHeatMap(const std::vector<AggregateRow>& rows, const Figure& figure, HeatSource* source) {
  HeatMap& map = source->map;
  bool any = false;
  for (const std::string& sequence : ListSequences(rows)) {
    HeatRow line{sequence, {}, {}};
    for (const std::string& label : map.labels) {
      const auto row = std::find_if(rows.begin(), rows.end(), [&](const AggregateRow& candidate) {
        return candidate.sequence == sequence && candidate.label == label;
      });
      line.cells.push_back(row == rows.end() ? HeatCell{kNan, kDash} : CellOf(*source, *row, figure));
      line.group = row == rows.end() ? line.group : row->group;
      any = any || !std::isnan(line.cells.back().value);
    }
    map.rows.push_back(std::move(line));
  }
  return any;
}

std::string HexColour(const HeatRgb& colour) {
  return Format("#%02x%02x%02x", static_cast<int>(colour[0]), static_cast<int>(colour[1]),
                static_cast<int>(colour[2]));
}

}  // namespace

std::vector<HeatMap> MakeHeatMaps(const std::vector<AggregateRow>& rows, const std::vector<Figure>& figures) {
  std::vector<HeatMap> maps;
  if (ListSequences(rows).size() < 2) {
    return maps;
  }
  const std::vector<std::string> labels = ListLabels(rows);
  const std::vector<std::pair<const char*, HeatSource>> sources = {
      {"nees_pose",
       {{"nees_map",
         "Pose NEES / 6",
         "1 is consistent, above it the covariance is too small, below it too large; second line: the worst "
         "run; bold: within the 95 % band of that many runs",
         true,
         4,
         labels,
         {}},
        0,
        NeesCell}},
      {"rmse_pos_m",
       {{"rmse_pos_map",
         "Position RMSE / lowest of the row",
         "second line: the RMSE; bold: the lowest",
         false,
         3,
         labels,
         {}},
        0,
        PositionCell}},
      {"rmse_ori_deg",
       {{"rmse_ori_map",
         "Orientation RMSE / lowest of the row",
         "second line: the RMSE; bold: the lowest",
         false,
         3,
         labels,
         {}},
        0,
        OrientationCell}}};
  for (auto [key, source] : sources) {
    const std::optional<size_t> figure = FindFigure(figures, key);
    source.figure = figure.value_or(0);
    if (figure && FillHeatMap(rows, figures[*figure], &source)) {
      maps.push_back(std::move(source.map));
    }
  }
  return maps;
}

std::string HeatColour(const HeatMap& map, double value) {
  return std::isnan(value) ? "#f0f2f4" : HexColour(Blend(map, value));
}

std::string HeatInk(const HeatMap& map, double value) {
  return !std::isnan(value) && std::abs(Shade(map, value)) > 0.72 ? "#ffffff" : "#1b2430";
}

std::vector<std::pair<double, std::string>> HeatLegend(const HeatMap& map) {
  std::vector<std::pair<double, std::string>> legend;
  const int steps = 3;
  for (int i = map.two_sided ? -steps : 0; i <= steps; ++i) {
    const double value = std::pow(map.darkest, static_cast<double>(i) / steps);
    const char* bound = i == steps ? "\u2265 " : i == -steps ? "\u2264 " : "";
    legend.emplace_back(value, bound + Format("%.2g", value));
  }
  return legend;
}

TextTable HeatTable(const HeatMap& map) {
  const bool grouped =
      std::any_of(map.rows.begin(), map.rows.end(), [](const HeatRow& row) { return !row.group.empty(); });
  TextTable table{"Map: " + map.title + " (" + map.reading + ")", {"sequence"}, {}};
  if (grouped) {
    table.header.emplace_back("group");
  }
  table.header.insert(table.header.end(), map.labels.begin(), map.labels.end());
  for (const HeatRow& row : map.rows) {
    TextRow text{{{row.sequence}}};
    if (grouped) {
      text.cells.push_back({row.group.empty() ? kDash : row.group});
    }
    for (const HeatCell& cell : row.cells) {
      text.cells.push_back(
          {cell.number + (cell.detail.empty() ? "" : " (" + cell.detail + ")"), cell.strong});
    }
    table.rows.push_back(std::move(text));
  }
  return table;
}

nlohmann::ordered_json HeatMapsJson(const std::vector<HeatMap>& maps) {
  Json list = Json::array();
  for (const HeatMap& map : maps) {
    Json legend = Json::array();
    for (const auto& [value, text] : HeatLegend(map)) {
      legend.push_back({HeatColour(map, value), HeatInk(map, value), text});
    }
    Json rows = Json::array();
    for (const HeatRow& row : map.rows) {
      Json cells = Json::array();
      for (const HeatCell& cell : row.cells) {
        cells.push_back({cell.number, cell.detail, cell.strong ? 1 : 0, HeatColour(map, cell.value),
                         HeatInk(map, cell.value)});
      }
      rows.push_back({{"sequence", row.sequence}, {"group", row.group}, {"cells", cells}});
    }
    list.push_back({{"title", map.title},
                    {"reading", map.reading},
                    {"labels", map.labels},
                    {"legend", legend},
                    {"rows", rows}});
  }
  return list;
}

}  // namespace alidade
