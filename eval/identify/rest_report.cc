#include "eval/identify/rest_report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/format.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/files/csv_text.h"
#include "eval/files/output_file.h"
#include "eval/report/report_json.h"
#include "eval/report/svg_plot.h"

namespace alidade {
namespace {

constexpr int kDigits = 6;

/// A coefficient in the texts of the report.
struct CoefficientName {
  NoisePowers::Index index;
  const char* key;                   ///< in identify.json
  const char* name;                  ///< in the table
  std::array<const char*, 2> units;  ///< gyroscope, accelerometer
};

constexpr std::array<CoefficientName, NoisePowers::kCount> kCoefficients = {
    {{NoisePowers::kWhite, "white_noise_density", "N", {"rad/s/sqrt(Hz)", "m/s^2/sqrt(Hz)"}},
     {NoisePowers::kFlicker, "bias_instability", "B", {"rad/s", "m/s^2"}},
     {NoisePowers::kWalk, "random_walk_density", "K", {"rad/s^2/sqrt(Hz)", "m/s^3/sqrt(Hz)"}},
     {NoisePowers::kQuantisation, "quantisation", "Q", {"rad", "m/s"}}}};

const char* UnitOf(const CoefficientName& coefficient, std::size_t axis) {
  return coefficient.units[axis < 3 ? 0 : 1];
}

std::string CoefficientText(const NoiseCoefficient& coefficient) {
  return coefficient.visible
             ? Format("%.3e (%.2e to %.2e)", coefficient.value, coefficient.low, coefficient.high)
             : Format("not visible, below %.2e", coefficient.high);
}

Json CoefficientJson(const NoiseCoefficient& coefficient, const char* unit) {
  Json json;
  json["visible"] = coefficient.visible;
  json["value"] = RoundedJson(coefficient.value, kDigits);
  json["low_95"] = RoundedJson(coefficient.low, kDigits);
  json["high_95"] = RoundedJson(coefficient.high, kDigits);
  json["unit"] = unit;
  return json;
}

Json AxisJson(const AxisNoise& axis, std::size_t index) {
  Json json;
  json["axis"] = kAxisNames[index];
  for (const CoefficientName& coefficient : kCoefficients) {
    json[coefficient.key] = CoefficientJson(axis.fit[coefficient.index], UnitOf(coefficient, index));
  }
  json["least_allan_deviation"] = RoundedJson(axis.least_deviation, kDigits);
  json["least_allan_deviation_tau_s"] = RoundedJson(axis.least_tau_s, kDigits);
  json["resolution"] = RoundedJson(axis.resolution, kDigits);
  json["chi_square"] = RoundedJson(axis.fit.chi_square, kDigits);
  json["chi_square_dof"] = axis.fit.chi_square_dof;
  return json;
}

Json SpanJson(const RestSpan& span) {
  Json json;
  json["start_ns"] = span.start_ns;
  json["end_ns"] = span.end_ns;
  json["duration_s"] = RoundedJson(span.duration_s(), kDigits);
  json["recording_s"] = RoundedJson(span.recording_s, kDigits);
  json["samples"] = span.samples();
  json["rate_hz"] = RoundedJson(1 / span.period_s, kDigits);
  json["jitter_rms_s"] = RoundedJson(span.jitter_rms_s, kDigits);
  json["gaps"] = span.gaps;
  json["samples_filled"] = span.filled;
  return json;
}

std::string RestJson(const RestNoise& noise, const std::string& dataset) {
  Json json;
  json["mode"] = "rest";
  json["dataset"] = dataset;
  json["span"] = SpanJson(noise.span);
  json["sheet"] = {
      {"gyroscope_noise_density", RoundedJson(noise.sheet.gyro_noise_density_radps_sqrthz, kDigits)},
      {"gyroscope_random_walk", RoundedJson(noise.sheet.gyro_random_walk_radps2_sqrthz, kDigits)},
      {"accelerometer_noise_density", RoundedJson(noise.sheet.accel_noise_density_mps2_sqrthz, kDigits)},
      {"accelerometer_random_walk", RoundedJson(noise.sheet.accel_random_walk_mps3_sqrthz, kDigits)}};
  json["axes"] = Json::array();
  for (std::size_t axis = 0; axis < noise.axes.size(); ++axis) {
    json["axes"].push_back(AxisJson(noise.axes[axis], axis));
  }
  json["remarks"] = noise.remarks;
  return json.dump(2) + "\n";
}

std::string AllanCsv(const RestNoise& noise) {
  std::string text = "axis,tau_s,deviation,low_95,high_95,dof,fit\n";
  for (std::size_t axis = 0; axis < noise.axes.size(); ++axis) {
    const AxisNoise& of_axis = noise.axes[axis];
    for (std::size_t i = 0; i < of_axis.curve.size(); ++i) {
      const AllanPoint& point = of_axis.curve[i];
      const auto [low, high] = VarianceInterval(of_axis.fit.dof[i]);
      text += JoinCsv({kAxisNames[axis], CsvNumber(point.tau_s), CsvNumber(std::sqrt(point.variance)),
                       CsvNumber(std::sqrt(point.variance * low)),
                       CsvNumber(std::sqrt(point.variance * high)), CsvNumber(of_axis.fit.dof[i]),
                       CsvNumber(std::sqrt(of_axis.fit.powers.VarianceAt(point.tau_s)))});
    }
  }
  return text;
}

constexpr std::array<const char*, 3> kAxisColours = {"#0072b2", "#d55e00", "#009e73"};

/// Curve, interval and fit of one sensor's axes.
SvgPlot PlotOfSensor(const RestNoise& noise, std::size_t first, const std::string& y_label) {
  SvgPlot plot{"averaging time [s]", y_label};
  plot.log_x = plot.log_y = true;
  for (std::size_t axis = first; axis < first + 3; ++axis) {
    const AxisNoise& of_axis = noise.axes[axis];
    const char* const colour = kAxisColours[axis - first];
    SvgCurve curve, fit;
    curve.stroke = {colour, 1.1};
    fit.stroke = {colour, 0.8, "4 2"};
    SvgBand band;
    band.colour = colour;
    for (std::size_t i = 0; i < of_axis.curve.size(); ++i) {
      const AllanPoint& point = of_axis.curve[i];
      const auto [low, high] = VarianceInterval(of_axis.fit.dof[i]);
      for (std::vector<double>* x : {&curve.x, &fit.x, &band.x}) {
        x->push_back(point.tau_s);
      }
      curve.y.push_back(std::sqrt(point.variance));
      fit.y.push_back(std::sqrt(of_axis.fit.powers.VarianceAt(point.tau_s)));
      band.low.push_back(std::sqrt(point.variance * low));
      band.high.push_back(std::sqrt(point.variance * high));
    }
    plot.curves.push_back(std::move(curve));
    plot.curves.push_back(std::move(fit));
    plot.bands.push_back(std::move(band));
  }
  return plot;
}

std::string AllanFigure(const RestNoise& noise) {
  constexpr double kPlotWidth = 420, kPlotHeight = 200, kLeftMargin = 44, kRightMargin = 10, kTop = 18,
                   kBelow = 34;
  SvgCanvas canvas(kPlotWidth, kTop + 2 * (kPlotHeight + kBelow));
  DrawLegend({{"x", {kAxisColours[0], 1.1}},
              {"y", {kAxisColours[1], 1.1}},
              {"z", {kAxisColours[2], 1.1}},
              {"fit", {"#1b2430", 0.8, "4 2"}},
              {"shaded: 95 % interval", {"#c3cad2", 4}}},
             kLeftMargin, 2, kPlotWidth - kLeftMargin - kRightMargin, &canvas);
  const double width = kPlotWidth - kLeftMargin - kRightMargin;
  DrawPlot(PlotOfSensor(noise, 0, "gyroscope, Allan deviation [rad/s]"),
           {kLeftMargin, kTop, width, kPlotHeight}, &canvas);
  DrawPlot(PlotOfSensor(noise, 3, "accelerometer, Allan deviation [m/s\u00b2]"),
           {kLeftMargin, kTop + kPlotHeight + kBelow, width, kPlotHeight}, &canvas);
  return canvas.Finish();
}

}  // namespace

std::string RestNoiseTable(const RestNoise& noise) {
  const RestSpan& span = noise.span;
  std::string text = Format(
      "at rest from %s to %s s: %.1f s, %zu samples at %.2f Hz; jitter of the stamps %.1f us rms, %zu gaps "
      "(%zu samples) filled\n\n",
      FormatSeconds(span.start_ns).c_str(), FormatSeconds(span.end_ns).c_str(), span.duration_s(),
      span.samples(), 1 / span.period_s, 1e6 * span.jitter_rms_s, span.gaps, span.filled);
  for (const CoefficientName& coefficient : kCoefficients) {
    for (std::size_t axis = 0; axis < noise.axes.size(); ++axis) {
      text += Format("%s  %-8s %-16s  %s\n", coefficient.name, kAxisNames[axis], UnitOf(coefficient, axis),
                     CoefficientText(noise.axes[axis].fit[coefficient.index]).c_str());
    }
  }
  for (std::size_t axis = 0; axis < noise.axes.size(); ++axis) {
    text += Format("least Allan deviation of %-8s %.3e at %.3g s\n", kAxisNames[axis],
                   noise.axes[axis].least_deviation, noise.axes[axis].least_tau_s);
  }
  text += "\nsheet (root mean square over the axes):\n" + ImuSensorYaml(noise.sheet, 1 / span.period_s);
  for (const std::string& remark : noise.remarks) {
    text += "note: " + remark + "\n";
  }
  return text;
}

Status WriteRestNoise(const RestNoise& noise, const std::string& dataset, const std::string& folder) {
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/allan.csv", AllanCsv(noise)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/allan.svg", AllanFigure(noise)));
  const double rate_hz = std::round(1e6 / noise.span.period_s) / 1e6;
  ALIDADE_RETURN_IF_ERROR(
      WriteFileAtomically(folder + "/mav0/imu0/sensor.yaml", ImuSensorYaml(noise.sheet, rate_hz)));
  return WriteFileAtomically(folder + "/identify.json", RestJson(noise, dataset));
}

}  // namespace alidade
