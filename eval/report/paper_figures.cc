#include "eval/report/paper_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "core/numbers.h"
#include "eval/comparison/aggregate.h"
#include "eval/comparison/nees_over_time.h"
#include "eval/files/output_file.h"
#include "eval/metrics/nees.h"
#include "eval/report/heat_map.h"
#include "eval/report/report_json.h"
#include "eval/report/svg_plot.h"

namespace alidade {
namespace {

constexpr double kWidth = 252;
constexpr double kLeft = 40, kRight = 10, kBelow = 26;
constexpr size_t kMostEstimators = 8;
/// The page's colours (assets/report_data.js): distinguishable with any colour vision.
constexpr std::array<const char*, kMostEstimators> kColours = {"#0072b2", "#d55e00", "#009e73", "#b5558c",
                                                               "#c98500", "#3aa0d8", "#6b2346", "#6b6b14"};
const SvgStroke kTruth{"#1b2430", 1.4, "1 2"};

/// One estimator on one sequence.
struct Entry {
  std::string label;
  SvgStroke stroke;
  std::vector<const CellResult*> ok;  ///< its runs that ended ok
};

using Legend = std::vector<std::pair<std::string, SvgStroke>>;

Legend LegendOf(const std::vector<Entry>& entries) {
  Legend legend;
  for (const Entry& entry : entries) {
    legend.emplace_back(entry.label + (entry.ok.empty() ? " (no run ok)" : ""), entry.stroke);
  }
  return legend;
}

/// A column of frames of one height below a legend.
class Sheet {
 public:
  Sheet(Legend legend, int frames, double height)
      : legend_(std::move(legend)),
        height_(height),
        top_(DrawLegend(legend_, kLeft, 0, kWidth - kLeft - kRight, nullptr) + 6),
        canvas_(kWidth, top_ + frames * (height + kBelow)) {
    DrawLegend(legend_, kLeft, 2, kWidth - kLeft - kRight, &canvas_);
  }
  [[nodiscard]] SvgFrame Frame(int i) const {
    return {kLeft, top_ + i * (height_ + kBelow), kWidth - kLeft - kRight, height_};
  }
  [[nodiscard]] SvgCanvas* canvas() { return &canvas_; }
  [[nodiscard]] std::string Finish() const { return canvas_.Finish(); }

 private:
  Legend legend_;
  double height_, top_;
  SvgCanvas canvas_;
};

std::vector<double> Component(const std::vector<Eigen::Vector3d>& vectors, int axis) {
  std::vector<double> values;
  values.reserve(vectors.size());
  for (const Eigen::Vector3d& vector : vectors) {
    values.push_back(vector(axis));
  }
  return values;
}

std::string TrajectoryFigure(const std::vector<Entry>& entries) {
  SvgPlot plot{"x [m]", "y [m]"};
  plot.equal_axes = true;
  Legend legend = LegendOf(entries);
  const CellSeries* truth = nullptr;
  for (const Entry& entry : entries) {
    if (!entry.ok.empty() && !entry.ok.front()->series.position.empty()) {
      const CellSeries& series = entry.ok.front()->series;
      plot.curves.push_back({entry.stroke, Component(series.position, 0), Component(series.position, 1)});
      truth = truth == nullptr ? &series : truth;
    }
  }
  if (truth != nullptr) {
    plot.curves.push_back({kTruth, Component(truth->truth_position, 0), Component(truth->truth_position, 1)});
    legend.emplace_back("truth", kTruth);
  }
  Sheet sheet(legend, 1, 180);
  DrawPlot(plot, sheet.Frame(0), sheet.canvas());
  return sheet.Finish();
}

/// Three frames of the error's components from `first` on.
std::string ErrorFigure(const std::vector<Entry>& entries, int first, double scale,
                        const std::array<const char*, 3>& labels) {
  Sheet sheet(LegendOf(entries), 3, 76);
  for (int axis = 0; axis < 3; ++axis) {
    SvgPlot plot{axis == 2 ? "time [s]" : "", labels[static_cast<size_t>(axis)]};
    plot.with_zero = true;
    for (const Entry& entry : entries) {
      if (entry.ok.empty()) {
        continue;
      }
      const CellSeries& series = entry.ok.front()->series;
      SvgCurve curve{entry.stroke, series.time_s, {}};
      SvgBand band{entry.stroke.colour, entries.size() > 3 ? 0.05 : 0.12, {}, {}, {}};
      for (size_t i = 0; i < series.error.size(); ++i) {
        curve.y.push_back(scale * series.error[i](first + axis));
      }
      for (size_t i = 0; i < series.sigma.size(); ++i) {
        const double reach = 3 * scale * series.sigma[i](first + axis);
        band.x.push_back(series.time_s[i]);
        band.low.push_back(-reach);
        band.high.push_back(reach);
      }
      plot.curves.push_back(std::move(curve));
      plot.bands.push_back(std::move(band));
    }
    DrawPlot(plot, sheet.Frame(axis), sheet.canvas());
  }
  return sheet.Finish();
}

std::string NeesFigure(const std::vector<Entry>& entries) {
  SvgPlot plot{"time [s]", "NEES of the pose"};
  plot.log_y = true;
  size_t most = 0;
  for (const Entry& entry : entries) {
    const NeesOverTime average = AverageNees(entry.ok);
    plot.curves.push_back({entry.stroke, average.time_s, average.mean});
    most = average.mean.empty() ? most : std::max(most, entry.ok.size());
  }
  if (most > 0) {
    plot.y_regions = {NeesBand(6, static_cast<double>(most))};
  }
  Sheet sheet(LegendOf(entries), 1, 120);
  DrawPlot(plot, sheet.Frame(0), sheet.canvas());
  return sheet.Finish();
}

std::string RpeFigure(const std::vector<Entry>& entries) {
  std::map<double, SvgBoxGroup> groups;
  for (const Entry& entry : entries) {
    std::map<double, std::vector<double>> errors;
    for (const CellResult* cell : entry.ok) {
      for (const RpeResult& rpe : cell->rpe) {
        std::vector<double>& all = errors[rpe.distance_m];
        all.insert(all.end(), rpe.pos_errors_m.begin(), rpe.pos_errors_m.end());
      }
    }
    for (auto& [distance, values] : errors) {
      SvgBoxGroup& group = groups[distance];
      group.name = ShortestDouble(distance);
      const std::vector<double> quantiles = BoxQuantiles(std::move(values));
      if (!quantiles.empty()) {
        group.boxes.push_back({entry.stroke.colour, quantiles});
      }
    }
  }
  std::vector<SvgBoxGroup> list;
  list.reserve(groups.size());
  for (auto& [distance, group] : groups) {
    list.push_back(std::move(group));
  }
  Sheet sheet(LegendOf(entries), 1, 120);
  DrawBoxes(list, "length of the sub-trajectory [m]", "position error [m]", false, sheet.Frame(0),
            sheet.canvas());
  return sheet.Finish();
}

std::string TimeFigure(const std::vector<Entry>& entries) {
  SvgBoxGroup group;
  for (const Entry& entry : entries) {
    std::vector<double> all;
    for (const CellResult* cell : entry.ok) {
      // Extremes that were kept for the plots would bias the quantiles.
      for (size_t i = 0; i < cell->series.backend_ms.size(); ++i) {
        if (cell->series.regular.empty() || cell->series.regular[i]) {
          all.push_back(cell->series.backend_ms[i]);
        }
      }
    }
    if (const std::vector<double> quantiles = BoxQuantiles(std::move(all)); !quantiles.empty()) {
      group.boxes.push_back({entry.stroke.colour, quantiles});
    }
  }
  Sheet sheet(LegendOf(entries), 1, 120);
  DrawBoxes({group}, "estimators, in the order of the legend", "back end, a frame [ms]", true, sheet.Frame(0),
            sheet.canvas());
  return sheet.Finish();
}

}  // namespace

std::vector<PaperFigure> DrawPaperFigures(const Comparison& comparison) {
  const std::vector<std::string> labels = ListLabels(Aggregate(comparison, {}));
  std::vector<std::string> sequences;
  std::map<std::string, std::vector<Entry>> by_sequence;
  for (const CellGroup& group : GroupCells(comparison)) {
    std::vector<Entry>& entries = by_sequence[group.sequence];
    if (entries.empty()) {
      sequences.push_back(group.sequence);
    }
    if (entries.size() == kMostEstimators) {
      continue;
    }
    // An estimator has one colour in all figures, as long as there are enough.
    const size_t place =
        static_cast<size_t>(std::find(labels.begin(), labels.end(), group.label) - labels.begin());
    Entry entry{
        group.label, {kColours[place % kMostEstimators], 0.9, place < kMostEstimators ? "" : "4 2"}, {}};
    std::copy_if(group.cells.begin(), group.cells.end(), std::back_inserter(entry.ok),
                 [](const CellResult* cell) { return cell->status == "ok"; });
    entries.push_back(std::move(entry));
  }
  std::vector<PaperFigure> figures;
  for (const std::string& sequence : sequences) {
    const std::vector<Entry>& entries = by_sequence[sequence];
    figures.push_back({sequence + "_trajectory", TrajectoryFigure(entries)});
    figures.push_back({sequence + "_position_error",
                       ErrorFigure(entries, 3, 1, {"x error [m]", "y error [m]", "z error [m]"})});
    figures.push_back({sequence + "_orientation_error",
                       ErrorFigure(entries, 0, kDegreesPerRadian,
                                   {"\u03c6x error [deg]", "\u03c6y error [deg]", "\u03c6z error [deg]"})});
    figures.push_back({sequence + "_nees", NeesFigure(entries)});
    figures.push_back({sequence + "_rpe", RpeFigure(entries)});
    figures.push_back({sequence + "_time", TimeFigure(entries)});
  }
  const std::vector<Figure> listed = ListFigures(comparison);
  for (const HeatMap& map : MakeHeatMaps(Aggregate(comparison, listed), listed)) {
    figures.push_back({map.key, HeatFigure(map)});
  }
  return figures;
}

}  // namespace alidade
