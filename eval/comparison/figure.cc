#include "eval/comparison/figure.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "core/numbers.h"
#include "eval/files/output_file.h"

namespace alidade {
namespace {

/// Share of a Gaussian inside +-3 standard deviations.
constexpr double kGaussianInside3Sigma = 0.9973002039367398;

bool HasTrajectory(const CellResult& cell) {
  return cell.frames > 0 && cell.status != "failed";
}

const RpeResult* FindRpe(const CellResult& cell, double distance_m) {
  for (const RpeResult& rpe : cell.rpe) {
    if (rpe.distance_m == distance_m && rpe.count > 0) {
      return &rpe;
    }
  }
  return nullptr;
}

using Value = std::function<double(const CellResult&)>;

Value OfTrajectory(std::optional<double> CellResult::*field) {
  return
      [field](const CellResult& cell) { return HasTrajectory(cell) ? (cell.*field).value_or(kNan) : kNan; };
}

Value OfRun(std::optional<double> CellResult::*field) {
  return [field](const CellResult& cell) { return (cell.*field).value_or(kNan); };
}

/// A run that failed before it had an estimate covered nothing.
double CompletionOf(const CellResult& cell) {
  return cell.completion.value_or(cell.status == "failed" ? 0 : kNan);
}

void AppendRpeFigures(const Comparison& comparison, std::vector<Figure>* figures) {
  std::set<double> distances;
  for (const CellResult& cell : comparison.cells) {
    for (const RpeResult& rpe : cell.rpe) {
      distances.insert(rpe.distance_m);
    }
  }
  for (const double distance : distances) {
    const std::string name = ShortestDouble(distance) + "m";
    const std::string spaced = ShortestDouble(distance) + " m";
    figures->push_back({"rpe_" + name + "_pos_m", "RPE " + spaced + " pos.", "m", Ideal::kLow, 0, 3,
                        [distance](const CellResult& cell) {
                          const RpeResult* rpe = HasTrajectory(cell) ? FindRpe(cell, distance) : nullptr;
                          return rpe == nullptr ? kNan : rpe->pos_rmse_m;
                        }});
    figures->push_back({"rpe_" + name + "_ori_deg", "RPE " + spaced + " ori.", "deg", Ideal::kLow, 0, 3,
                        [distance](const CellResult& cell) {
                          const RpeResult* rpe = HasTrajectory(cell) ? FindRpe(cell, distance) : nullptr;
                          return rpe == nullptr ? kNan : rpe->ori_rmse_deg;
                        }});
  }
}

/// Those that need what only some runs have.
void AppendFiguresOfSome(const Comparison& comparison, std::vector<Figure>* figures) {
  const auto known = [&comparison](std::optional<double> CellResult::*member) {
    return std::any_of(comparison.cells.begin(), comparison.cells.end(),
                       [member](const CellResult& cell) { return (cell.*member).has_value(); });
  };
  for (const auto& [key, label, member] :
       {std::tuple("nees_vel", "NEES vel.", &CellResult::nees_vel),
        std::tuple("nees_gyro_bias", "NEES gyro bias", &CellResult::nees_gyro_bias),
        std::tuple("nees_accel_bias", "NEES accel. bias", &CellResult::nees_accel_bias)}) {
    if (known(member)) {
      figures->push_back({key, label, "", Ideal::kTarget, 3, 2, OfTrajectory(member)});
    }
  }
  if (known(&CellResult::calibration_rotation_deg)) {
    figures->push_back({"calibration_rotation_deg", "camera rotation", "deg", Ideal::kLow, 0, 3,
                        OfRun(&CellResult::calibration_rotation_deg)});
    figures->push_back({"calibration_translation_m", "camera position", "m", Ideal::kLow, 0, 4,
                        OfRun(&CellResult::calibration_translation_m)});
    figures->push_back({"calibration_time_ms", "time offset", "ms", Ideal::kLow, 0, 3,
                        OfRun(&CellResult::calibration_time_ms)});
  }
  if (std::any_of(comparison.cells.begin(), comparison.cells.end(),
                  [](const CellResult& cell) { return cell.restarts > 0; })) {
    figures->push_back({"restarts", "restarts", "", Ideal::kLow, 0, 1,
                        [](const CellResult& cell) { return static_cast<double>(cell.restarts); }});
  }
}

}  // namespace

std::vector<Figure> ListFigures(const Comparison& comparison) {
  std::vector<Figure> figures = {
      {"rmse_pos_m", "RMSE pos.", "m", Ideal::kLow, 0, 3, OfTrajectory(&CellResult::rmse_pos_m)},
      {"rmse_ori_deg", "RMSE ori.", "deg", Ideal::kLow, 0, 3, OfTrajectory(&CellResult::rmse_ori_deg)},
      {"ate_pos_m", "ATE pos.", "m", Ideal::kLow, 0, 3, OfTrajectory(&CellResult::ate_pos_m)},
      {"ate_ori_deg", "ATE ori.", "deg", Ideal::kLow, 0, 3, OfTrajectory(&CellResult::ate_ori_deg)}};
  AppendRpeFigures(comparison, &figures);
  const std::vector<Figure> rest = {
      {"nees_pose", "NEES pose", "", Ideal::kTarget, 6, 2, OfTrajectory(&CellResult::nees_pose)},
      {"nees_ori", "NEES ori.", "", Ideal::kTarget, 3, 2, OfTrajectory(&CellResult::nees_ori)},
      {"nees_pos", "NEES pos.", "", Ideal::kTarget, 3, 2, OfTrajectory(&CellResult::nees_pos)},
      {"coverage_3sigma", "inside 3\u03c3", "", Ideal::kTarget, kGaussianInside3Sigma, 3,
       OfTrajectory(&CellResult::coverage_3sigma)},
      {"frontend_ms", "front end", "ms", Ideal::kNone, 0, 2, OfTrajectory(&CellResult::frontend_ms)},
      {"backend_ms", "back end", "ms", Ideal::kLow, 0, 2, OfTrajectory(&CellResult::backend_ms)},
      {"backend_ms_p95", "back end p95", "ms", Ideal::kLow, 0, 2, OfTrajectory(&CellResult::backend_ms_p95)},
      {"features_per_frame", "features", "1/frame", Ideal::kNone, 0, 1,
       OfTrajectory(&CellResult::features_per_frame)},
      {"gated_share", "gated", "", Ideal::kNone, 0, 3, OfTrajectory(&CellResult::gated_share)},
      {"silent_s", "silent failure", "s", Ideal::kLow, 0, 1, OfTrajectory(&CellResult::silent_s)},
      {"alarm_inside_share", "alarms inside 3\u03c3", "", Ideal::kLow, 0, 3,
       OfTrajectory(&CellResult::alarm_inside_share)}};
  figures.insert(figures.end(), rest.begin(), rest.end());
  AppendFiguresOfSome(comparison, &figures);
  figures.push_back({"completion", "completed", "", Ideal::kTarget, 1, 3, CompletionOf, true});
  figures.push_back({"realtime_factor", "x real time", "s/s", Ideal::kNone, 0, 1,
                     OfTrajectory(&CellResult::realtime_factor)});
  return figures;
}

double Badness(const Figure& figure, double value) {
  switch (figure.ideal) {
    case Ideal::kNone:
      return kNan;
    case Ideal::kLow:
      return value;
    case Ideal::kTarget:
      // Shares lie near one: distance. NEES spans decades, and half the ideal is as bad as twice: ratio.
      return figure.target <= 1 ? std::abs(value - figure.target) : std::abs(std::log(value / figure.target));
  }
  return kNan;
}

std::optional<size_t> FindFigure(const std::vector<Figure>& figures, const std::string& key) {
  for (size_t i = 0; i < figures.size(); ++i) {
    if (figures[i].key == key) {
      return i;
    }
  }
  return std::nullopt;
}

}  // namespace alidade
