#pragma once

#include <string>
#include <utility>
#include <vector>

#include "eval/report/svg_canvas.h"

namespace alidade {

/// Points of a curve; rows whose x or y is not finite are gaps.
struct SvgCurve {
  SvgStroke stroke;
  std::vector<double> x, y;
};

/// The area between two curves.
struct SvgBand {
  std::string colour;
  double opacity = 0.12;
  std::vector<double> x, low, high;
};

/// A plot of curves in a rectangle of a canvas.
struct SvgPlot {
  std::string x_label, y_label;
  bool log_y = false;       ///< values that are not positive are gaps
  bool equal_axes = false;  ///< a metre is as long in x as in y
  bool with_zero = false;   ///< y = 0 is included and drawn
  bool log_x = false;       ///< likewise in x
  std::vector<SvgCurve> curves = {};
  std::vector<SvgBand> bands = {};                        ///< cut at three times the curves' range
  std::vector<std::pair<double, double>> y_regions = {};  ///< shaded over the whole width
};

/// Values at 5, 25, 50, 75 and 95 %.
struct SvgBox {
  std::string colour;
  std::vector<double> quantiles;
};
struct SvgBoxGroup {
  std::string name;
  std::vector<SvgBox> boxes;
};

struct SvgFrame {
  double left = 0, top = 0, width = 0, height = 0;  ///< of the axes, labels outside
};

/// Draws axes, grid, bands and curves; "no data" when there are no curves.
void DrawPlot(const SvgPlot& plot, const SvgFrame& frame, SvgCanvas* canvas);

/// Draws boxes in groups side by side, from zero or on a logarithmic axis.
void DrawBoxes(const std::vector<SvgBoxGroup>& groups, const std::string& x_label, const std::string& y_label,
               bool log_y, const SvgFrame& frame, SvgCanvas* canvas);

/// Lines with their names in rows of the given width; returns the height they take. `canvas` null: only
/// measures.
double DrawLegend(const std::vector<std::pair<std::string, SvgStroke>>& entries, double left, double top,
                  double width, SvgCanvas* canvas);

}  // namespace alidade
