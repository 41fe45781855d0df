#include "eval/identify/motion_report.h"

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

using MotionJson = nlohmann::ordered_json;

constexpr int kMotionDigits = 6;

/// A sensor whose innovations count.
struct InnovationSensor {
  RowSource source;
  const char* name;
  const char* colour;
};

const std::array<InnovationSensor, 3>& InnovationSensors() {
  static const std::array<InnovationSensor, 3> sensors = {
      {{RowSource::kVision, "vision", "#0072b2"},
       {RowSource::kGnss, "gnss", "#d55e00"},
       {RowSource::kMeasurement, MeasurementKeys().c_str(), "#009e73"}}};
  return sensors;
}

std::size_t Row(RowSource source) {
  return static_cast<std::size_t>(source);
}

bool HasRows(const MotionNoise& noise, RowSource source) {
  return noise.halves[0].dof[Row(source)] + noise.halves[1].dof[Row(source)] > 0;
}

/// Keys of the configuration that carry what the sensor sheet does not.
std::vector<std::string> SettingsOf(const MotionNoise& noise) {
  std::vector<std::string> settings = {"imu.noise_scale=1", "imu.random_walk_scale=1"};
  for (const IdentifiedNoise& one : noise.noises) {
    if (one.source == NoiseSource::kPixel) {
      settings.push_back(Format("vision.pixel_noise_px=%.4g", one.value));
    }
  }
  return settings;
}

std::string Joined(const std::vector<std::string>& settings) {
  std::string text;
  for (const std::string& setting : settings) {
    text += (text.empty() ? "" : ",") + setting;
  }
  return text;
}

MotionJson NoiseJson(const IdentifiedNoise& noise) {
  MotionJson json;
  json["noise"] = NameOf(noise.source);
  json["unit"] = UnitOf(noise.source);
  json["assumed"] = RoundedJson(noise.assumed, kMotionDigits);
  json["value"] = RoundedJson(noise.value, kMotionDigits);
  json["low_95"] = RoundedJson(noise.low, kMotionDigits);
  json["high_95"] = RoundedJson(noise.high, kMotionDigits);
  json["weak"] = noise.weak;
  return json;
}

std::string MotionNoiseJson(const MotionNoise& noise, const std::string& dataset) {
  MotionJson json;
  json["mode"] = "motion";
  json["dataset"] = dataset;
  json["frames"] = noise.frames.size();
  json["rounds"] = noise.rounds;
  json["likelihood_evaluations"] = noise.runs;
  json["converged"] = noise.converged;
  json["noises"] = MotionJson::array();
  for (const IdentifiedNoise& one : noise.noises) {
    json["noises"].push_back(NoiseJson(one));
  }
  json["settings"] = SettingsOf(noise);
  json["unused_halves"] = MotionJson::array();
  for (const HalfFit& half : noise.halves) {
    MotionJson entry;
    entry["half"] = half.name;
    for (const InnovationSensor& sensor : InnovationSensors()) {
      if (HasRows(noise, sensor.source)) {
        entry[sensor.name] = {
            {"nis_over_dof", RoundedJson(half.nis_ratio[Row(sensor.source)], kMotionDigits)},
            {"dof", half.dof[Row(sensor.source)]}};
      }
    }
    json["unused_halves"].push_back(entry);
  }
  json["remarks"] = noise.remarks;
  return json.dump(2) + "\n";
}

std::string InnovationsCsv(const MotionNoise& noise) {
  std::string text = "timestamp_ns,log_likelihood";
  for (const InnovationSensor& sensor : InnovationSensors()) {
    text += std::string(",") + sensor.name + "_nis," + sensor.name + "_dof";
  }
  text += "\n";
  for (const FrameFit& frame : noise.frames) {
    std::vector<std::string> fields = {std::to_string(frame.stamp_ns), CsvNumber(frame.log_likelihood)};
    for (const InnovationSensor& sensor : InnovationSensors()) {
      fields.push_back(CsvNumber(frame.nis[Row(sensor.source)]));
      fields.push_back(std::to_string(frame.dof[Row(sensor.source)]));
    }
    text += JoinCsv(fields);
  }
  return text;
}

/// NIS over its rows, in spans of a fortieth of the recording.
SvgCurve NisCurve(const MotionNoise& noise, const InnovationSensor& sensor) {
  constexpr std::size_t kSpans = 40;
  SvgCurve curve;
  curve.stroke = {sensor.colour, 1.1};
  const std::size_t frames = noise.frames.size();
  for (std::size_t span = 0; span < kSpans; ++span) {
    double nis = 0, dof = 0, time_s = 0, count = 0;
    for (std::size_t k = span * frames / kSpans; k < (span + 1) * frames / kSpans; ++k) {
      nis += noise.frames[k].nis[Row(sensor.source)];
      dof += noise.frames[k].dof[Row(sensor.source)];
      time_s += SecondsBetween(noise.frames.front().stamp_ns, noise.frames[k].stamp_ns);
      ++count;
    }
    if (dof > 0) {
      curve.x.push_back(time_s / count);
      curve.y.push_back(nis / dof);
    }
  }
  return curve;
}

std::string NisFigure(const MotionNoise& noise) {
  constexpr double kFigureWidth = 420, kFigureHeight = 150, kFigureLeft = 44, kFigureRight = 10,
                   kFigureTop = 18;
  SvgCanvas canvas(kFigureWidth, kFigureTop + kFigureHeight + 34);
  SvgPlot plot{"time [s]", "NIS / rows"};
  std::vector<std::pair<std::string, SvgStroke>> legend;
  for (const InnovationSensor& sensor : InnovationSensors()) {
    if (HasRows(noise, sensor.source)) {
      plot.curves.push_back(NisCurve(noise, sensor));
      legend.emplace_back(sensor.name, plot.curves.back().stroke);
    }
  }
  legend.emplace_back("shaded: within 5 % of 1", SvgStroke{"#dfeee6", 4});
  plot.y_regions.emplace_back(0.95, 1.05);
  const double width = kFigureWidth - kFigureLeft - kFigureRight;
  DrawLegend(legend, kFigureLeft, 2, width, &canvas);
  DrawPlot(plot, {kFigureLeft, kFigureTop, width, kFigureHeight}, &canvas);
  return canvas.Finish();
}

}  // namespace

std::string MotionNoiseTable(const MotionNoise& noise) {
  std::string text = Format(
      "%zu frames, %d rounds, %d evaluations of the likelihood\n\n%-28s %-15s %10s %10s  %s\n",
      noise.frames.size(), noise.rounds, noise.runs, "noise", "unit", "assumed", "found", "95 % interval");
  for (const IdentifiedNoise& one : noise.noises) {
    text += Format("%-28s %-15s %10.3g %10.3g  %.3g to %.3g%s\n", NameOf(one.source), UnitOf(one.source),
                   one.assumed, one.value, one.low, one.high, one.weak ? " (weak)" : "");
  }
  text += "\nNIS over rows of a half, with the noises of the other half:\n";
  for (const HalfFit& half : noise.halves) {
    text += Format("%-8s", half.name.c_str());
    for (const InnovationSensor& sensor : InnovationSensors()) {
      if (HasRows(noise, sensor.source)) {
        text += Format("  %s %.3f (%d rows)", sensor.name, half.nis_ratio[Row(sensor.source)],
                       half.dof[Row(sensor.source)]);
      }
    }
    text += "\n";
  }
  text += "\nuse with the written sheet: --set=" + Joined(SettingsOf(noise)) + "\n";
  for (const std::string& remark : noise.remarks) {
    text += "note: " + remark + "\n";
  }
  return text;
}

Status WriteMotionNoise(const MotionNoise& noise, const std::string& dataset, double rate_hz,
                        const std::string& folder) {
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/innovations.csv", InnovationsCsv(noise)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/nis.svg", NisFigure(noise)));
  ALIDADE_RETURN_IF_ERROR(
      WriteFileAtomically(folder + "/mav0/imu0/sensor.yaml", ImuSensorYaml(noise.sheet, rate_hz)));
  return WriteFileAtomically(folder + "/identify.json", MotionNoiseJson(noise, dataset));
}

}  // namespace alidade
