#include <algorithm>

#include "eval/report/heat_map.h"
#include "eval/report/svg_canvas.h"

namespace alidade {
namespace {

constexpr double kHeatText = 7, kHeatSmallText = 5;
constexpr double kHeatRowHeight = 17, kHeatGroupHeight = 14;
constexpr double kHeatLeastWidth = 252, kHeatLeastColumn = 28, kHeatMargin = 4;

/// Where everything of a map is.
struct HeatLayout {
  double left = 0, top = 0, column = 0, width = 0, height = 0;

  explicit HeatLayout(const HeatMap& map) {
    double head = 0;
    for (const HeatRow& row : map.rows) {
      left = std::max(left, SvgTextWidth(row.sequence, kHeatText));
    }
    for (const std::string& label : map.labels) {
      head = std::max(head, SvgTextWidth(label, kHeatText));
    }
    left += 2 * kHeatMargin;
    top = 14 + head + kHeatMargin;
    const auto columns = static_cast<double>(map.labels.size());
    column = std::max(kHeatLeastColumn, (kHeatLeastWidth - left - kHeatMargin) / columns);
    width = left + columns * column + kHeatMargin;
    std::string group;
    height = top + 30;
    for (const HeatRow& row : map.rows) {
      height += kHeatRowHeight + (row.group == group ? 0 : kHeatGroupHeight);
      group = row.group;
    }
  }
};

void DrawHeatCell(const HeatMap& map, const HeatCell& cell, double left, double top, double width,
                  SvgCanvas* canvas) {
  canvas->Rect(left, top, width, kHeatRowHeight, HeatColour(map, cell.value), 1, {"#ffffff", 0.6});
  const std::string ink = HeatInk(map, cell.value);
  const double middle = left + width / 2;
  const bool one_line = cell.detail.empty();
  const double fitting = std::min(kHeatText, kHeatText * (width - 2) / SvgTextWidth(cell.number, kHeatText));
  canvas->Text(middle, top + (one_line ? 11 : 8), cell.number, {"middle", fitting, ink, 0, cell.strong});
  if (!one_line) {
    const double small =
        std::min(kHeatSmallText, kHeatSmallText * (width - 2) / SvgTextWidth(cell.detail, kHeatSmallText));
    canvas->Text(middle, top + 14.5, cell.detail, {"middle", small, ink});
  }
}

void DrawHeatLegend(const HeatMap& map, const HeatLayout& layout, double top, SvgCanvas* canvas) {
  const auto legend = HeatLegend(map);
  const double step = std::min(28.0, (layout.width - 2 * kHeatMargin) / static_cast<double>(legend.size()));
  double left = layout.width - kHeatMargin - step * static_cast<double>(legend.size());
  for (const auto& [value, text] : legend) {
    canvas->Rect(left, top, step, 11, HeatColour(map, value), 1, {"#c3cad2", 0.4});
    canvas->Text(left + step / 2, top + 8, text, {"middle", 6, HeatInk(map, value)});
    left += step;
  }
}

}  // namespace

std::string HeatFigure(const HeatMap& map) {
  const HeatLayout layout(map);
  SvgCanvas canvas(layout.width, layout.height);
  canvas.Text(kHeatMargin, 10, map.title, {"start", 8, "#1b2430", 0, true});
  for (size_t i = 0; i < map.labels.size(); ++i) {
    const double middle = layout.left + (static_cast<double>(i) + 0.5) * layout.column;
    canvas.Text(middle + 2.5, layout.top - kHeatMargin, map.labels[i], {"start", kHeatText, "#1b2430", -90});
  }
  double top = layout.top;
  std::string group;
  for (const HeatRow& row : map.rows) {
    if (row.group != group) {
      group = row.group;
      canvas.Text(kHeatMargin, top + 10, group, {"start", kHeatText, "#4a5563", 0, true});
      top += kHeatGroupHeight;
    }
    canvas.Text(layout.left - kHeatMargin, top + 10.5, row.sequence, {"end", kHeatText});
    for (size_t i = 0; i < row.cells.size(); ++i) {
      DrawHeatCell(map, row.cells[i], layout.left + static_cast<double>(i) * layout.column, top,
                   layout.column, &canvas);
    }
    top += kHeatRowHeight;
  }
  DrawHeatLegend(map, layout, top + 10, &canvas);
  return canvas.Finish();
}

}  // namespace alidade
