#include "eval/compare/external_times.h"

#include <optional>

#include "eval/files/csv.h"

namespace alidade {
namespace {

std::optional<size_t> FindColumn(const CsvReader& csv, std::string_view name) {
  for (size_t i = 0; i < csv.columns(); ++i) {
    if (csv.field(i) == name) {
      return i;
    }
  }
  return std::nullopt;
}

Result<size_t> ColumnOf(const CsvReader& csv, std::string_view name) {
  const std::optional<size_t> column = FindColumn(csv, name);
  return column ? Result<size_t>(*column)
                : Status::Input(csv.Place() + ": expected a column " + std::string(name));
}

}  // namespace

Result<ExternalTimes> ReadExternalTimes(const std::string& path) {
  Result<CsvReader> csv = CsvReader::Open(path);
  ALIDADE_RETURN_IF_ERROR(csv.status());
  csv->NextRow();
  const Result<size_t> frontend = ColumnOf(*csv, "frontend_ms");
  ALIDADE_RETURN_IF_ERROR(frontend.status());
  const Result<size_t> backend = ColumnOf(*csv, "backend_ms");
  ALIDADE_RETURN_IF_ERROR(backend.status());
  const std::optional<size_t> stamp = FindColumn(*csv, "timestamp_ns");
  const size_t columns = csv->columns();
  ExternalTimes times;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(columns));
    ALIDADE_RETURN_IF_ERROR(csv->ReadReal(*frontend, "frontend_ms", &times.frontend_ms.emplace_back()));
    if (stamp) {
      ALIDADE_RETURN_IF_ERROR(csv->ReadTime(*stamp, "timestamp_ns", &times.stamps_ns.emplace_back()));
    }
    ALIDADE_RETURN_IF_ERROR(csv->ReadReal(*backend, "backend_ms", &times.backend_ms.emplace_back()));
  }
  return times.backend_ms.empty() ? Status::Input(path + ": holds no row") : Result<ExternalTimes>(times);
}

}  // namespace alidade
