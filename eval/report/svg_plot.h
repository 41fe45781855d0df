#pragma once

#include <string>
#include <utility>
#include <vector>

#include "eval/report/svg_canvas.h"

namespace alidade {

/// One axis: values to places on the canvas.
class SvgAxis {
 public:
  /// `from` is the place of `low`; a logarithmic axis needs low > 0.
  SvgAxis(double low, double high, double from, double to, bool log);
  [[nodiscard]] double At(double value) const;
  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }
  /// About `count` round values inside; decades, or 1, 2, 5 of each, where logarithmic.
  [[nodiscard]] std::vector<double> Ticks(int count) const;

 private:
  double low_, high_, from_, to_;
  bool log_;
};

/// Where a value was drawn against another; rows whose x or y is not finite are gaps.
struct SvgCurve {
  SvgStroke stroke;
  std::vector<double> x, y;
};

/// What lies between two curves.
struct SvgBand {
  std::string colour;
  double opacity = 0.12;
  std::vector<double> x, low, high;
};

/// A plot of curves in a rectangle of a canvas.
struct SvgPlot {
  std::string x_label, y_label;
  bool log_y = false;       ///< what is not positive is a gap
  bool equal_axes = false;  ///< a metre is as long in x as in y
  bool with_zero = false;   ///< y = 0 is in view and drawn
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

/// Draws axes, grid, bands and curves; "no data" where there is nothing.
void DrawPlot(const SvgPlot& plot, const SvgFrame& frame, SvgCanvas* canvas);

/// Draws boxes in groups side by side, from zero or on a logarithmic axis.
void DrawBoxes(const std::vector<SvgBoxGroup>& groups, const std::string& x_label, const std::string& y_label,
               bool log_y, const SvgFrame& frame, SvgCanvas* canvas);

/// Lines with their names in rows of the given width; returns the height they take. `canvas` null: measures
/// alone.
double DrawLegend(const std::vector<std::pair<std::string, SvgStroke>>& entries, double left, double top,
                  double width, SvgCanvas* canvas);

}  // namespace alidade
