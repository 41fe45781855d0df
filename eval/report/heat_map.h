#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/comparison/aggregate.h"
#include "eval/report/text_table.h"

namespace alidade {

/// One estimator on one sequence in a map.
struct HeatCell {
  double value = 0;         ///< what is coloured; NaN: nothing to colour
  std::string number;       ///< the value as it is printed; why there is none; a dash where it did not run
  std::string detail = {};  ///< a second line, such as the worst run; may be empty
  bool strong = false;      ///< printed bold
};

struct HeatRow {
  std::string sequence;
  std::string group;  ///< of the sequence; may be empty
  std::vector<HeatCell> cells;
};

/// A figure of all estimators (columns) on all sequences (rows) whose ideal is 1. Its colours are a
/// logarithmic scale: white at 1 and below, or, of a map with two sides, violet below; the number gives what
/// the colour does, for prints without colours.
struct HeatMap {
  std::string key;      ///< name of its file
  std::string title;    ///< what the number is
  std::string reading;  ///< what the detail is and what is bold
  bool two_sided = false;
  double darkest = 4;  ///< the value of the darkest colour; with two sides its inverse too
  std::vector<std::string> labels;
  std::vector<HeatRow> rows;
};

/// Maps of the pose NEES over 6 and of the RMSEs over the lowest of each sequence, of the figures and rows of
/// ListFigures and Aggregate. Empty with fewer than two sequences; a map without any value is left out.
[[nodiscard]] std::vector<HeatMap> MakeHeatMaps(const std::vector<AggregateRow>& rows,
                                                const std::vector<Figure>& figures);

/// "#rrggbb" of a value's background, and of the text on it.
[[nodiscard]] std::string HeatColour(const HeatMap& map, double value);
[[nodiscard]] std::string HeatInk(const HeatMap& map, double value);

/// Values of the legend with their texts, from low to high.
[[nodiscard]] std::vector<std::pair<double, std::string>> HeatLegend(const HeatMap& map);

/// The map as a table of text: a row a sequence, the detail in brackets.
[[nodiscard]] TextTable HeatTable(const HeatMap& map);
/// What the page draws.
[[nodiscard]] nlohmann::ordered_json HeatMapsJson(const std::vector<HeatMap>& maps);
/// The map as an SVG image, a column of a page wide; wider with more than six estimators.
[[nodiscard]] std::string HeatFigure(const HeatMap& map);

}  // namespace alidade
