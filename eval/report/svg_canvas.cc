#include "eval/report/svg_canvas.h"

#include <cmath>

#include "core/format.h"
#include "eval/files/escape_html.h"

namespace alidade {
namespace {

std::string Number(double value) {
  // "-0" and "0" are the same place but not the same bytes.
  const double rounded = std::round(value * 100) / 100;
  return Format("%g", rounded == 0 ? 0 : rounded);
}

std::string Attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + EscapeHtml(value) + "\"";
}

std::string Attribute(const char* name, double value) {
  return Attribute(name, Number(value));
}

std::string StrokeAttributes(const SvgStroke& stroke) {
  return Attribute("stroke", stroke.colour) + Attribute("stroke-width", stroke.width) +
         (stroke.dash.empty() ? "" : Attribute("stroke-dasharray", stroke.dash)) +
         (stroke.opacity < 1 ? Attribute("stroke-opacity", stroke.opacity) : "");
}

std::string PointList(const SvgCanvas::Points& points) {
  std::string text;
  for (const auto& [x, y] : points) {
    text += (text.empty() ? "" : " ") + Number(x) + "," + Number(y);
  }
  return text;
}

}  // namespace

SvgCanvas::SvgCanvas(double width, double height) : width_(width), height_(height) {
  Rect(0, 0, width, height, "#ffffff");
}

void SvgCanvas::Line(double x1, double y1, double x2, double y2, const SvgStroke& stroke) {
  body_ += "<line" + Attribute("x1", x1) + Attribute("y1", y1) + Attribute("x2", x2) + Attribute("y2", y2) +
           StrokeAttributes(stroke) + "/>\n";
}

void SvgCanvas::Polyline(const Points& points, const SvgStroke& stroke) {
  if (!points.empty()) {
    body_ += "<polyline fill=\"none\" stroke-linejoin=\"round\"" + Attribute("points", PointList(points)) +
             StrokeAttributes(stroke) + "/>\n";
  }
}

void SvgCanvas::Polygon(const Points& points, const std::string& fill, double opacity) {
  if (!points.empty()) {
    body_ += "<polygon" + Attribute("points", PointList(points)) + Attribute("fill", fill) +
             Attribute("fill-opacity", opacity) + "/>\n";
  }
}

void SvgCanvas::Rect(double x, double y, double width, double height, const std::string& fill, double opacity,
                     const SvgStroke& stroke) {
  body_ += "<rect" + Attribute("x", x) + Attribute("y", y) + Attribute("width", width) +
           Attribute("height", height) + Attribute("fill", fill) +
           (opacity < 1 ? Attribute("fill-opacity", opacity) : "") +
           (stroke.width > 0 ? StrokeAttributes(stroke) : "") + "/>\n";
}

void SvgCanvas::Circle(double x, double y, double radius, const std::string& fill, const SvgStroke& stroke) {
  body_ += "<circle" + Attribute("cx", x) + Attribute("cy", y) + Attribute("r", radius) +
           Attribute("fill", fill) + StrokeAttributes(stroke) + "/>\n";
}

void SvgCanvas::Text(double x, double y, const std::string& text, const SvgText& style) {
  const std::string place = Number(x) + " " + Number(y);
  body_ +=
      "<text" + Attribute("x", x) + Attribute("y", y) + Attribute("text-anchor", style.anchor) +
      Attribute("font-size", style.size) + Attribute("fill", style.colour) +
      (style.bold ? Attribute("font-weight", "bold") : "") +
      (style.turn_deg == 0 ? ""
                           : Attribute("transform", "rotate(" + Number(style.turn_deg) + " " + place + ")")) +
      ">" + EscapeHtml(text) + "</text>\n";
}

void SvgCanvas::BeginClip(double x, double y, double width, double height) {
  const std::string name = "clip" + std::to_string(++clips_);
  body_ += "<clipPath" + Attribute("id", name) + "><rect" + Attribute("x", x) + Attribute("y", y) +
           Attribute("width", width) + Attribute("height", height) + "/></clipPath>\n<g" +
           Attribute("clip-path", "url(#" + name + ")") + ">\n";
}

void SvgCanvas::EndClip() {
  body_ += "</g>\n";
}

std::string SvgCanvas::Finish() const {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
         "font-family=\"Liberation Sans, Arial, Helvetica, sans-serif\"" +
         Attribute("width", Number(width_) + "pt") + Attribute("height", Number(height_) + "pt") +
         Attribute("viewBox", "0 0 " + Number(width_) + " " + Number(height_)) + ">\n" + body_ + "</svg>\n";
}

double SvgTextWidth(const std::string& text, double size) {
  return 0.56 * size * static_cast<double>(text.size());
}

}  // namespace alidade
