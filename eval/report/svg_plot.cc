#include "eval/report/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/format.h"
#include "eval/report/svg_axis.h"

namespace alidade {
namespace {

const char* const kInk = "#1b2430";
const char* const kSoft = "#4a5563";
const char* const kGrid = "#e3e8ed";
constexpr double kTextSize = 8;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Range {
  double low = kInfinity, high = -kInfinity;

  void Add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] bool empty() const { return !(low <= high); }
};

std::string TickText(double value) {
  const double magnitude = std::abs(value);
  const std::string text =
      magnitude >= 1e5 || (magnitude > 0 && magnitude < 1e-3) ? Format("%.0e", value) : Format("%.5g", value);
  return text[0] == '-' ? "\u2212" + text.substr(1) : text;
}

void DrawAxes(const SvgAxis& x, const SvgAxis& y, bool with_x_ticks, const SvgFrame& frame,
              SvgCanvas* canvas) {
  const double bottom = frame.top + frame.height;
  for (const double value : y.Ticks(5)) {
    canvas->Line(frame.left, y.At(value), frame.left + frame.width, y.At(value), {kGrid, 0.6});
    canvas->Text(frame.left - 4, y.At(value) + 2.8, TickText(value), {"end", kTextSize, kSoft});
  }
  for (const double value : with_x_ticks ? x.Ticks(6) : std::vector<double>()) {
    canvas->Line(x.At(value), frame.top, x.At(value), bottom, {kGrid, 0.6});
    canvas->Text(x.At(value), bottom + 10, TickText(value), {"middle", kTextSize, kSoft});
  }
  canvas->Line(frame.left, bottom, frame.left + frame.width, bottom, {kSoft, 0.6});
  canvas->Line(frame.left, frame.top, frame.left, bottom, {kSoft, 0.6});
}

void DrawLabels(const std::string& x_label, const std::string& y_label, const SvgFrame& frame,
                SvgCanvas* canvas) {
  canvas->Text(frame.left + frame.width / 2, frame.top + frame.height + 21, x_label, {"middle", kTextSize});
  canvas->Text(frame.left - 32, frame.top + frame.height / 2, y_label, {"middle", kTextSize, kInk, -90});
}

bool Drawable(const SvgPlot& plot, double x, double y) {
  return std::isfinite(x) && std::isfinite(y) && (!plot.log_y || y > 0) && (!plot.log_x || x > 0);
}

/// Ranges of what is drawn.
std::pair<Range, Range> RangesOf(const SvgPlot& plot) {
  Range x, y;
  for (const SvgCurve& curve : plot.curves) {
    for (size_t i = 0; i < curve.x.size(); ++i) {
      if (Drawable(plot, curve.x[i], curve.y[i])) {
        x.Add(curve.x[i]);
        y.Add(curve.y[i]);
      }
    }
  }
  // A band far wider than the errors would flatten them.
  const double reach = 3 * std::max(std::abs(y.low), std::abs(y.high));
  for (const SvgBand& band : plot.bands) {
    for (size_t i = 0; i < band.x.size() && !y.empty(); ++i) {
      if (std::isfinite(band.low[i]) && std::isfinite(band.high[i])) {
        y.Add(std::clamp(band.low[i], -reach, reach));
        y.Add(std::clamp(band.high[i], -reach, reach));
      }
    }
  }
  for (const auto& [low, high] : plot.y_regions) {
    y.Add(low);
    y.Add(high);
  }
  if (plot.with_zero) {
    y.Add(0);
  }
  return {x, y};
}

/// Some air around, and never an empty range.
void Widen(bool log, Range* range) {
  if (log) {
    *range = {range->low / 1.3, range->high * 1.3};
    return;
  }
  const double air = range->high > range->low ? 0.05 * (range->high - range->low)
                                              : std::max(0.1 * std::abs(range->high), 1e-3);
  *range = {range->low - air, range->high + air};
}

/// Equal scales: the range that has room to spare grows about its middle.
void Equalize(const SvgFrame& frame, Range* x, Range* y) {
  const double scale = std::max((x->high - x->low) / frame.width, (y->high - y->low) / frame.height);
  for (const auto& [range, length] : {std::pair(x, frame.width), std::pair(y, frame.height)}) {
    const double middle = 0.5 * (range->low + range->high);
    *range = {middle - 0.5 * scale * length, middle + 0.5 * scale * length};
  }
}

void DrawBand(const SvgBand& band, const SvgAxis& x, const SvgAxis& y, SvgCanvas* canvas) {
  SvgCanvas::Points outline, back;
  for (size_t i = 0; i < band.x.size(); ++i) {
    if (std::isfinite(band.low[i]) && std::isfinite(band.high[i])) {
      outline.emplace_back(x.At(band.x[i]), y.At(band.high[i]));
      back.emplace_back(x.At(band.x[i]), y.At(band.low[i]));
    }
  }
  outline.insert(outline.end(), back.rbegin(), back.rend());
  canvas->Polygon(outline, band.colour, band.opacity);
}

void DrawCurve(const SvgPlot& plot, const SvgCurve& curve, const SvgAxis& x, const SvgAxis& y,
               SvgCanvas* canvas) {
  SvgCanvas::Points piece;
  for (size_t i = 0; i < curve.x.size(); ++i) {
    if (Drawable(plot, curve.x[i], curve.y[i])) {
      piece.emplace_back(x.At(curve.x[i]), y.At(curve.y[i]));
    } else {
      canvas->Polyline(piece, curve.stroke);
      piece.clear();
    }
  }
  canvas->Polyline(piece, curve.stroke);
}

void DrawBox(const SvgBox& box, double middle, double half, const SvgAxis& y, SvgCanvas* canvas) {
  const SvgStroke thin{box.colour, 0.8};
  const auto at = [&](size_t i) { return y.At(box.quantiles[i]); };
  canvas->Line(middle, at(0), middle, at(1), thin);
  canvas->Line(middle, at(3), middle, at(4), thin);
  for (const size_t end : {size_t{0}, size_t{4}}) {
    canvas->Line(middle - half / 2, at(end), middle + half / 2, at(end), thin);
  }
  canvas->Rect(middle - half, at(3), 2 * half, std::max(0.5, at(1) - at(3)), box.colour, 0.18, thin);
  canvas->Line(middle - half, at(2), middle + half, at(2), {box.colour, 1.8});
}

void DrawNothing(const SvgFrame& frame, SvgCanvas* canvas) {
  canvas->Text(frame.left + frame.width / 2, frame.top + frame.height / 2, "no data",
               {"middle", kTextSize, kSoft});
}

}  // namespace

void DrawPlot(const SvgPlot& plot, const SvgFrame& frame, SvgCanvas* canvas) {
  auto [x_range, y_range] = RangesOf(plot);
  DrawLabels(plot.x_label, plot.y_label, frame, canvas);
  if (x_range.empty() || y_range.empty()) {
    return DrawNothing(frame, canvas);
  }
  Widen(plot.log_y, &y_range);
  if (plot.equal_axes) {
    Widen(false, &x_range);
    Equalize(frame, &x_range, &y_range);
  } else if (x_range.high == x_range.low) {
    Widen(plot.log_x, &x_range);
  }
  const SvgAxis x(x_range.low, x_range.high, frame.left, frame.left + frame.width, plot.log_x);
  const SvgAxis y(y_range.low, y_range.high, frame.top + frame.height, frame.top, plot.log_y);
  canvas->BeginClip(frame.left, frame.top, frame.width, frame.height);
  for (const auto& [low, high] : plot.y_regions) {
    canvas->Rect(frame.left, y.At(high), frame.width, y.At(low) - y.At(high), "#dfeee6");
  }
  canvas->EndClip();
  DrawAxes(x, y, true, frame, canvas);
  canvas->BeginClip(frame.left, frame.top, frame.width, frame.height);
  for (const SvgBand& band : plot.bands) {
    DrawBand(band, x, y, canvas);
  }
  if (plot.with_zero) {
    canvas->Line(frame.left, y.At(0), frame.left + frame.width, y.At(0), {kSoft, 0.5});
  }
  for (const SvgCurve& curve : plot.curves) {
    DrawCurve(plot, curve, x, y, canvas);
  }
  canvas->EndClip();
}

void DrawBoxes(const std::vector<SvgBoxGroup>& groups, const std::string& x_label, const std::string& y_label,
               bool log_y, const SvgFrame& frame, SvgCanvas* canvas) {
  Range range;
  size_t most = 1;
  for (const SvgBoxGroup& group : groups) {
    most = std::max(most, group.boxes.size());
    for (const SvgBox& box : group.boxes) {
      range.Add(box.quantiles.front());
      range.Add(box.quantiles.back());
    }
  }
  DrawLabels(x_label, y_label, frame, canvas);
  if (range.empty()) {
    return DrawNothing(frame, canvas);
  }
  const bool log = log_y && range.low > 0;
  if (!log) {
    range.Add(0);
  }
  range = log ? Range{range.low / 1.3, range.high * 1.3} : Range{range.low, 1.05 * range.high + 1e-12};
  const SvgAxis y(range.low, range.high, frame.top + frame.height, frame.top, log);
  DrawAxes(y, y, false, frame, canvas);
  const double step = frame.width / static_cast<double>(groups.size());
  const double slot = std::min(16.0, 0.86 * step / static_cast<double>(most));
  for (size_t g = 0; g < groups.size(); ++g) {
    const double middle = frame.left + step * (static_cast<double>(g) + 0.5);
    canvas->Text(middle, frame.top + frame.height + 10, groups[g].name, {"middle", kTextSize, kSoft});
    const std::vector<SvgBox>& boxes = groups[g].boxes;
    for (size_t b = 0; b < boxes.size(); ++b) {
      const double offset = static_cast<double>(b) + 0.5 - 0.5 * static_cast<double>(boxes.size());
      DrawBox(boxes[b], middle + slot * offset, 0.36 * slot, y, canvas);
    }
  }
}

double DrawLegend(const std::vector<std::pair<std::string, SvgStroke>>& entries, double left, double top,
                  double width, SvgCanvas* canvas) {
  constexpr double kSwatch = 16, kGap = 10, kRow = 11;
  double x = left, y = top;
  for (const auto& [name, stroke] : entries) {
    const double needed = kSwatch + 4 + SvgTextWidth(name, kTextSize);
    if (x > left && x + needed > left + width) {
      x = left;
      y += kRow;
    }
    if (canvas != nullptr) {
      canvas->Line(x, y + 5, x + kSwatch, y + 5, {stroke.colour, 1.6, stroke.dash});
      canvas->Text(x + kSwatch + 4, y + 8, name, {"start", kTextSize});
    }
    x += needed + kGap;
  }
  return entries.empty() ? 0 : y - top + kRow;
}

}  // namespace alidade
