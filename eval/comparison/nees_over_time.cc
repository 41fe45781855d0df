#include "eval/comparison/nees_over_time.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/numbers.h"
#include "eval/comparison/cell_group.h"
#include "eval/metrics/nees.h"

namespace alidade {
namespace {

constexpr int kPoseFreedom = 6;

/// The regular rows of a run.
struct Curve {
  std::vector<double> time_s;
  std::vector<double> nees;
};

Curve RegularCurve(const CellSeries& series) {
  Curve curve;
  for (size_t i = 0; i < series.time_s.size(); ++i) {
    if (series.regular.empty() || series.regular[i]) {
      curve.time_s.push_back(series.time_s[i]);
      curve.nees.push_back(i < series.nees_pose.size() ? series.nees_pose[i] : kNan);
    }
  }
  return curve;
}

/// The value nearest to `time_s` within `reach_s`; NaN when there is none.
double ValueNear(const Curve& curve, double time_s, double reach_s) {
  const std::vector<double>& times = curve.time_s;
  size_t at = static_cast<size_t>(std::lower_bound(times.begin(), times.end(), time_s) - times.begin());
  if (at > 0 && (at == times.size() || time_s - times[at - 1] < times[at] - time_s)) {
    --at;
  }
  const bool near = at < times.size() && std::abs(times[at] - time_s) <= reach_s;
  return near ? curve.nees[at] : kNan;
}

/// Bands by number of runs; each is worked out once.
class Bands {
 public:
  std::pair<double, double> Of(int runs) {
    const auto [entry, added] = bands_.try_emplace(runs);
    if (added) {
      entry->second = NeesBand(kPoseFreedom, runs);
    }
    return entry->second;
  }

 private:
  std::map<int, std::pair<double, double>> bands_;
};

const Curve* LongestOf(const std::vector<Curve>& all) {
  const auto longest = std::max_element(all.begin(), all.end(), [](const Curve& a, const Curve& b) {
    return a.time_s.back() < b.time_s.back();
  });
  return longest == all.end() ? nullptr : &*longest;
}

}  // namespace

NeesOverTime AverageNees(const std::vector<const CellResult*>& cells) {
  std::vector<Curve> all;
  for (const CellResult* cell : cells) {
    if (cell->status == "ok" && !cell->series.time_s.empty()) {
      all.push_back(RegularCurve(cell->series));
    }
  }
  NeesOverTime result;
  result.share_inside = kNan;
  const Curve* grid = LongestOf(all);
  if (grid == nullptr) {
    return result;
  }
  const double step_s =
      grid->time_s.size() > 1 ? grid->time_s.back() / static_cast<double>(grid->time_s.size() - 1) : 0;
  Bands bands;
  int inside = 0;
  for (const double time_s : grid->time_s) {
    double sum = 0;
    int runs = 0;
    for (const Curve& curve : all) {
      const double value = ValueNear(curve, time_s, 0.5 * step_s);
      if (std::isfinite(value)) {
        sum += value;
        ++runs;
      }
    }
    if (runs > 0) {
      const std::pair<double, double> band = bands.Of(runs);
      const double mean = sum / runs;
      inside += mean >= band.first && mean <= band.second ? 1 : 0;
      result.time_s.push_back(time_s);
      result.mean.push_back(mean);
      result.runs.push_back(runs);
      result.band.push_back(band);
    }
  }
  result.share_inside = result.mean.empty() ? kNan : inside / static_cast<double>(result.mean.size());
  return result;
}

std::vector<NeesCurve> AverageNees(const Comparison& comparison) {
  std::vector<NeesCurve> curves;
  for (const CellGroup& group : GroupCells(comparison)) {
    curves.push_back({group.label, group.sequence, AverageNees(group.cells)});
  }
  return curves;
}

std::string NeesVerdict(double mean, const std::pair<double, double>& band) {
  if (std::isnan(mean) || std::isnan(band.first)) {
    return "";
  }
  return mean > band.second ? "overconfident" : mean < band.first ? "cautious" : "consistent";
}

}  // namespace alidade
