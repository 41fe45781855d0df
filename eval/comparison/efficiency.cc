#include "eval/comparison/efficiency.h"

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "eval/files/csv_text.h"

namespace alidade {
namespace {

/// Root mean square of a figure over cells; NaN when one of them does not have it.
double Pooled(const std::vector<const CellResult*>& cells, std::optional<double> CellResult::*figure) {
  double squares = 0;
  for (const CellResult* cell : cells) {
    const double value = (cell->*figure).value_or(kNan);
    squares += value * value;
  }
  return std::sqrt(squares / static_cast<double>(cells.size()));
}

const CellResult* FindPartner(const CellGroup& bound, const CellResult& cell) {
  for (const CellResult* other : bound.cells) {
    if (other->seed == cell.seed && other->input_digest == cell.input_digest && other->status == "ok") {
      return other;
    }
  }
  return nullptr;
}

Efficiency CompareWithBound(const CellGroup& group, const CellGroup& bound) {
  std::vector<const CellResult*> own, best;
  for (const CellResult* cell : group.cells) {
    const CellResult* partner = cell->status == "ok" ? FindPartner(bound, *cell) : nullptr;
    if (partner != nullptr && cell->rmse_pos_m && partner->rmse_pos_m) {
      own.push_back(cell);
      best.push_back(partner);
    }
  }
  Efficiency entry;
  entry.label = group.label;
  entry.sequence = group.sequence;
  entry.pairs = static_cast<int>(own.size());
  if (own.empty()) {
    return entry;
  }
  entry.rmse = {Pooled(own, &CellResult::rmse_ori_deg), Pooled(own, &CellResult::rmse_pos_m)};
  const auto relate = [&](std::optional<double> CellResult::*ori, std::optional<double> CellResult::*pos) {
    return Ratio{Pooled(best, ori) / entry.rmse.ori, Pooled(best, pos) / entry.rmse.pos};
  };
  entry.achieved = relate(&CellResult::rmse_ori_deg, &CellResult::rmse_pos_m);
  entry.smoothed = relate(&CellResult::sigma_ori_deg, &CellResult::sigma_pos_m);
  entry.filtered = relate(&CellResult::filtering_sigma_ori_deg, &CellResult::filtering_sigma_pos_m);
  return entry;
}

}  // namespace

std::vector<Efficiency> ComputeEfficiency(const Comparison& comparison) {
  const auto batch = std::find_if(comparison.cells.begin(), comparison.cells.end(),
                                  [](const CellResult& cell) { return cell.backend == "batch"; });
  std::vector<Efficiency> entries;
  if (batch == comparison.cells.end()) {
    return entries;
  }
  const std::string bound_label = LabelsOf(comparison)[static_cast<size_t>(batch - comparison.cells.begin())];
  const std::vector<CellGroup> groups = GroupCells(comparison);
  for (const CellGroup& group : groups) {
    for (const CellGroup& bound : groups) {
      if (bound.label == bound_label && bound.sequence == group.sequence) {
        entries.push_back(CompareWithBound(group, bound));
      }
    }
  }
  return entries;
}

std::string EfficiencyCsv(const std::vector<Efficiency>& entries) {
  std::string text =
      "estimator,sequence,pairs,rmse_ori_deg,rmse_pos_m,achieved_ori,achieved_pos,smoothed_ori,smoothed_pos,"
      "filtered_ori,filtered_pos\n";
  for (const Efficiency& entry : entries) {
    std::vector<std::string> fields = {CsvText(entry.label), CsvText(entry.sequence),
                                       std::to_string(entry.pairs)};
    for (const Ratio& ratio : {entry.rmse, entry.achieved, entry.smoothed, entry.filtered}) {
      fields.push_back(CsvNumber(ratio.ori));
      fields.push_back(CsvNumber(ratio.pos));
    }
    text += JoinCsv(fields);
  }
  return text;
}

}  // namespace alidade
