#pragma once

#include <string>
#include <vector>

#include "eval/comparison/comparison.h"

namespace alidade {

/// A figure of a comparison for a paper, 252 points (a column of a two-column page) wide.
struct PaperFigure {
  std::string name;  ///< of its file, without extension
  std::string svg;
};

/// Of each sequence: <sequence>_trajectory, _position_error and _orientation_error (with +-3 sigma) of each
/// estimator's first run that ended ok; _nees averaged over the runs with its 95 % band, _rpe and _time over
/// all runs that ended ok. Of several sequences together nees_map, rmse_pos_map and rmse_ori_map
/// (eval/report/heat_map.h). At most eight estimators, in the order of the comparison, as on the page; one
/// that lost all runs is named in the legend as such; the maps have all.
[[nodiscard]] std::vector<PaperFigure> DrawPaperFigures(const Comparison& comparison);

}  // namespace alidade
