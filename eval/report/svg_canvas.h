#pragma once

#include <string>
#include <utility>
#include <vector>

namespace alidade {

/// Style of a line. Lengths are in points of 1/72 inch.
struct SvgStroke {
  std::string colour = "#1b2430";
  double width = 1;
  std::string dash = {};  ///< "6 3"; empty: solid
  double opacity = 1;
};

struct SvgText {
  const char* anchor = "start";  ///< start | middle | end
  double size = 8;
  std::string colour = "#1b2430";
  double turn_deg = 0;  ///< about its place, clockwise
  bool bold = false;
};

/// An SVG image for files: self-contained, texts escaped, equal calls give equal bytes. x goes right and y
/// down, from the upper left corner.
class SvgCanvas {
 public:
  using Points = std::vector<std::pair<double, double>>;

  SvgCanvas(double width, double height);

  void Line(double x1, double y1, double x2, double y2, const SvgStroke& stroke);
  void Polyline(const Points& points, const SvgStroke& stroke);
  void Polygon(const Points& points, const std::string& fill, double opacity);
  void Rect(double x, double y, double width, double height, const std::string& fill, double opacity = 1,
            const SvgStroke& stroke = {"none", 0});
  void Circle(double x, double y, double radius, const std::string& fill, const SvgStroke& stroke);
  void Text(double x, double y, const std::string& text, const SvgText& style = {});

  /// Elements drawn until EndClip are clipped to the rectangle.
  void BeginClip(double x, double y, double width, double height);
  void EndClip();

  [[nodiscard]] double width() const { return width_; }
  [[nodiscard]] double height() const { return height_; }
  [[nodiscard]] std::string Finish() const;

 private:
  double width_, height_;
  int clips_ = 0;
  std::string body_;
};

/// Approximate width of a text in a sans-serif font; the font is unknown until the file is displayed.
[[nodiscard]] double SvgTextWidth(const std::string& text, double size);

}  // namespace alidade
