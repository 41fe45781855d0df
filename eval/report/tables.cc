#include "eval/report/tables.h"

#include <filesystem>
#include <limits>

#include "core/numbers.h"
#include "eval/comparison/efficiency.h"
#include "eval/comparison/nees_over_time.h"
#include "eval/files/csv_text.h"
#include "eval/files/output_file.h"
#include "eval/report/pair_tables.h"
#include "eval/report/report_data.h"
#include "eval/report/table_layout.h"
#include "eval/report/tables_text.h"
#include "eval/report/text_table.h"

namespace alidade {
namespace {

std::string SummaryCsv(const Comparison& comparison, const std::vector<Figure>& figures) {
  std::vector<std::string> header = {"estimator",    "backend", "sequence",   "seed",  "status",
                                     "input_digest", "frames",  "duration_s", "path_m"};
  for (const Figure& figure : figures) {
    header.push_back(figure.key);
    if (figure.key == "ate_ori_deg") {
      header.push_back("align");
    }
  }
  header.emplace_back("mode");
  header.emplace_back("message");
  std::string text = JoinCsv(header);
  for (const CellResult& cell : comparison.cells) {
    std::vector<std::string> fields = {CsvText(cell.estimator),
                                       CsvText(cell.backend),
                                       CsvText(cell.sequence),
                                       std::to_string(cell.seed),
                                       CsvText(cell.status),
                                       CsvText(cell.input_digest),
                                       std::to_string(cell.frames),
                                       CsvNumber(cell.duration_s.value_or(kNan)),
                                       CsvNumber(cell.path_m.value_or(kNan))};
    for (const Figure& figure : figures) {
      fields.push_back(CsvNumber(figure.value(cell)));
      if (figure.key == "ate_ori_deg") {
        fields.push_back(CsvText(cell.align));
      }
    }
    fields.push_back(ModeWord(cell.smoothed));
    fields.push_back(CsvText(cell.message));
    text += JoinCsv(fields);
  }
  return text;
}

std::string AggregateCsv(const Comparison& comparison, const std::vector<Figure>& figures) {
  std::vector<std::string> header = {"estimator", "backend",  "sequence",        "runs",
                                     "ok",        "diverged", "not_initialized", "failed"};
  for (const Figure& figure : figures) {
    header.push_back(figure.key + "_mean");
    header.push_back(figure.key + "_se");
    header.push_back(figure.key + "_max");
  }
  for (const char* nees : {"nees_pose", "nees_ori", "nees_pos"}) {
    header.push_back(std::string(nees) + "_band_low");
    header.push_back(std::string(nees) + "_band_high");
  }
  for (const char* more : {"nees_verdict", "nees_inside_share", "rmse_pos_ratio", "rmse_ori_ratio",
                           "rmse_pos_to_best", "rmse_ori_to_best", "group", "mode"}) {
    header.emplace_back(more);
  }
  std::string text = JoinCsv(header);
  for (const AggregateRow& row : Aggregate(comparison, figures)) {
    std::vector<std::string> fields = {CsvText(row.estimator), CsvText(row.backend), CsvText(row.sequence)};
    for (const int count : {row.cells, row.ok, row.diverged, row.not_initialized, row.failed}) {
      fields.push_back(std::to_string(count));
    }
    for (const Statistic& statistic : row.figures) {
      fields.push_back(CsvNumber(statistic.mean));
      fields.push_back(CsvNumber(statistic.standard_error));
      fields.push_back(CsvNumber(statistic.largest));
    }
    for (const auto& [low, high] : {row.nees_pose_band, row.nees_ori_band, row.nees_pos_band}) {
      fields.push_back(CsvNumber(low));
      fields.push_back(CsvNumber(high));
    }
    fields.push_back(row.nees_verdict);
    for (const double value : {row.nees_inside_share, row.rmse_pos_ratio, row.rmse_ori_ratio,
                               row.rmse_pos_to_best, row.rmse_ori_to_best}) {
      fields.push_back(CsvNumber(value));
    }
    fields.push_back(CsvText(row.group));
    fields.push_back(ModeWord(row.smoothed));
    text += JoinCsv(fields);
  }
  return text;
}

std::string NeesCsv(const Comparison& comparison) {
  std::string text = "estimator,sequence,time_s,runs,nees_pose,band_low,band_high\n";
  for (const NeesCurve& curve : AverageNees(comparison)) {
    for (size_t i = 0; i < curve.average.time_s.size(); ++i) {
      text += JoinCsv({CsvText(curve.label), CsvText(curve.sequence), CsvNumber(curve.average.time_s[i]),
                       std::to_string(curve.average.runs[i]), CsvNumber(curve.average.mean[i]),
                       CsvNumber(curve.average.band[i].first), CsvNumber(curve.average.band[i].second)});
    }
  }
  return text;
}

}  // namespace

Status WriteTables(const Comparison& comparison, const std::string& folder) {
  const std::vector<Figure> figures = ListFigures(comparison);
  const std::vector<TextTable> tables = LayOutTables(comparison, " \u00b1 ");
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/summary.csv", SummaryCsv(comparison, figures)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/aggregate.csv", AggregateCsv(comparison, figures)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/pairs.csv", PairsCsv(comparison, figures)));
  const std::vector<Efficiency> efficiency = ComputeEfficiency(comparison);
  std::error_code ignored;
  std::filesystem::remove(folder + "/efficiency.csv", ignored);
  if (!efficiency.empty()) {
    ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/efficiency.csv", EfficiencyCsv(efficiency)));
  }
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/nees_over_time.csv", NeesCsv(comparison)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/report.json", ReportJson(comparison)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/tables.md", MarkdownText(comparison, tables)));
  return WriteFileAtomically(folder + "/tables.tex", LatexText(comparison, tables));
}

}  // namespace alidade
