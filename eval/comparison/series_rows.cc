#include "eval/comparison/series_rows.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace alidade {
namespace {

/// Deviations smaller than this share of a column's range are not seen on a plot.
constexpr double kVisible = 0.01;

/// A column whose extremes must be kept, and where they are.
struct Column {
  std::vector<double> values;
  double range = 0;
  size_t lowest = 0, highest = 0;
};

Column MakeColumn(std::vector<double> values) {
  Column column{std::move(values), 0, 0, 0};
  bool any = false;
  for (size_t i = 0; i < column.values.size(); ++i) {
    if (std::isfinite(column.values[i])) {
      column.lowest = any && column.values[column.lowest] <= column.values[i] ? column.lowest : i;
      column.highest = any && column.values[column.highest] >= column.values[i] ? column.highest : i;
      any = true;
    }
  }
  column.range = any ? column.values[column.highest] - column.values[column.lowest] : 0;
  return column;
}

std::vector<Column> ListColumns(const CellSeries& series) {
  std::vector<Column> columns;
  for (int axis = 0; axis < 6; ++axis) {
    std::vector<double> values;
    for (const Vector6d& error : series.error) {
      values.push_back(error(axis));
    }
    columns.push_back(MakeColumn(std::move(values)));
  }
  for (const std::vector<double>* values : {&series.nees_pose, &series.backend_ms, &series.nis_ratio}) {
    columns.push_back(MakeColumn(*values));
  }
  for (const auto& [key, values] : series.sensor_nis_ratio) {
    columns.push_back(MakeColumn(values));
  }
  columns.erase(
      std::remove_if(columns.begin(), columns.end(), [](const Column& c) { return !(c.range > 0); }),
      columns.end());
  return columns;
}

/// How far row `at` is off the line between rows `from` and `to`, as the largest share of a column's range.
double Deviation(const std::vector<Column>& columns, size_t from, size_t at, size_t to) {
  double largest = 0;
  const double part = static_cast<double>(at - from) / static_cast<double>(to - from);
  for (const Column& column : columns) {
    const double line = column.values[from] + part * (column.values[to] - column.values[from]);
    const double off = std::abs(column.values[at] - line) / column.range;
    largest = off > largest ? off : largest;  // false for NaN
  }
  return largest;
}

std::vector<size_t> RegularRows(const CellSeries& series, size_t most) {
  std::vector<size_t> regular;
  for (size_t i = 0; i < series.time_s.size(); ++i) {
    if (series.regular.empty() || series.regular[i]) {
      regular.push_back(i);
    }
  }
  const size_t step = std::max<size_t>(1, (regular.size() + most - 1) / std::max<size_t>(1, most));
  std::vector<size_t> picked;
  for (size_t i = 0; i < regular.size(); i += step) {
    picked.push_back(regular[i]);
  }
  return picked;
}

/// The rows of a column that has one a row of the series; a column that is absent stays so.
template <typename Values>
Values Take(const Values& values, const std::vector<size_t>& kept) {
  Values taken;
  for (const size_t i : kept) {
    if (i < values.size()) {
      taken.push_back(values[i]);
    }
  }
  return taken;
}

}  // namespace

SeriesRows PickRows(const CellSeries& series, size_t most) {
  const std::vector<size_t> regular = RegularRows(series, most);
  std::set<size_t> kept(regular.begin(), regular.end());
  if (!series.time_s.empty()) {
    const std::vector<Column> columns = ListColumns(series);
    const size_t last = series.time_s.size() - 1;
    kept.insert(last);
    for (const Column& column : columns) {
      kept.insert(column.lowest);
      kept.insert(column.highest);
    }
    for (size_t k = 0; k < regular.size(); ++k) {
      const size_t from = regular[k], to = k + 1 < regular.size() ? regular[k + 1] : last;
      size_t furthest = from;
      double deviation = kVisible;
      for (size_t at = from + 1; at < to; ++at) {
        if (const double off = Deviation(columns, from, at, to); off >= deviation) {
          furthest = at;
          deviation = off;
        }
      }
      kept.insert(furthest);
    }
  }
  SeriesRows rows;
  for (const size_t i : kept) {
    rows.kept.push_back(i);
    rows.regular.push_back(std::binary_search(regular.begin(), regular.end(), i));
  }
  return rows;
}

CellSeries TakeRows(const CellSeries& series, const SeriesRows& rows) {
  const std::vector<size_t>& kept = rows.kept;
  CellSeries taken;
  taken.regular = rows.regular;
  taken.truth_position = Take(series.truth_position, kept);
  taken.position = Take(series.position, kept);
  taken.error = Take(series.error, kept);
  taken.sigma = Take(series.sigma, kept);
  for (std::vector<double> CellSeries::*column :
       {&CellSeries::time_s, &CellSeries::nees_pose, &CellSeries::backend_ms, &CellSeries::features_used,
        &CellSeries::tracks_in, &CellSeries::nis_ratio, &CellSeries::rank, &CellSeries::yaw_leak,
        &CellSeries::position_leak}) {
    taken.*column = Take(series.*column, kept);
  }
  for (const auto& [key, values] : series.sensor_nis_ratio) {
    taken.sensor_nis_ratio[key] = Take(values, kept);
  }
  return taken;
}

}  // namespace alidade
