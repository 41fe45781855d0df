#include <cmath>

#include "eval/comparison.h"
#include "eval/output_file.h"
#include "eval/table_layout.h"
#include "eval/tables_text.h"

namespace alidade {
namespace {

/// A field of a CSV file, quoted where RFC 4180 wants it.
std::string CsvText(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + "\"";
}

/// Empty where there is no value.
std::string CsvNumber(double value) {
  return std::isnan(value) ? "" : ShortestDouble(value);
}

std::string JoinCsv(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& field : fields) {
    line += (line.empty() ? "" : ",") + field;
  }
  return line + "\n";
}

std::string SummaryCsv(const Comparison& comparison, const std::vector<Figure>& figures) {
  std::vector<std::string> header = {"estimator",    "backend", "sequence",   "seed",  "status",
                                     "input_digest", "frames",  "duration_s", "path_m"};
  for (const Figure& figure : figures) {
    header.push_back(figure.key);
    if (figure.key == "ate_ori_deg") {
      header.push_back("align");
    }
  }
  header.push_back("message");
  std::string text = JoinCsv(header);
  for (const CellResult& cell : comparison.cells) {
    std::vector<std::string> fields = {
        CsvText(cell.estimator),     CsvText(cell.backend),      CsvText(cell.sequence),
        std::to_string(cell.seed),   CsvText(cell.status),       CsvText(cell.input_digest),
        std::to_string(cell.frames), CsvNumber(cell.duration_s), CsvNumber(cell.path_m)};
    for (const Figure& figure : figures) {
      fields.push_back(CsvNumber(figure.value(cell)));
      if (figure.key == "ate_ori_deg") {
        fields.push_back(CsvText(cell.align));
      }
    }
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
  }
  for (const char* nees : {"nees_pose", "nees_ori", "nees_pos"}) {
    header.push_back(std::string(nees) + "_band_low");
    header.push_back(std::string(nees) + "_band_high");
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
    }
    for (const auto& [low, high] : {row.nees_pose_band, row.nees_ori_band, row.nees_pos_band}) {
      fields.push_back(CsvNumber(low));
      fields.push_back(CsvNumber(high));
    }
    text += JoinCsv(fields);
  }
  return text;
}

}  // namespace

Status WriteTables(const Comparison& comparison, const std::string& folder) {
  const std::vector<Figure> figures = ListFigures(comparison);
  const std::vector<TextTable> tables = LayOutTables(comparison, " \u00b1 ");
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/summary.csv", SummaryCsv(comparison, figures)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/aggregate.csv", AggregateCsv(comparison, figures)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(folder + "/tables.md", MarkdownText(comparison, tables)));
  return WriteFileAtomically(folder + "/tables.tex", LatexText(comparison, tables));
}

}  // namespace alidade
