#include "eval/dataset/sensor_table.h"

#include <charconv>

#include "eval/files/output_file.h"

namespace alidade {

Result<CsvReader> OpenTable(const std::string& path, const std::vector<CsvColumn>& header) {
  Result<CsvReader> csv = CsvReader::Open(path);
  if (csv.ok()) {
    csv->NextRow();
    if (Status matches = csv->ExpectHeader(header); !matches.ok()) {
      return matches;
    }
  }
  return csv;
}

void AppendField(double value, std::string* row) {
  char buffer[40];
  const std::to_chars_result result = std::to_chars(buffer, buffer + sizeof buffer, value);
  row->push_back(',');
  row->append(buffer, result.ptr);
}

void AppendFields(const Eigen::Vector3d& vector, std::string* row) {
  for (int i = 0; i < 3; ++i) {
    AppendField(vector[i], row);
  }
}

Status CheckStampWithOffset(const std::string& sheet, TimeNs stamp_ns, double offset_s) {
  return IsStampWithOffset(stamp_ns, offset_s)
             ? Status::Ok()
             : Status::Input(sheet + ": time_offset_s: found " + ShortestDouble(offset_s) +
                             " s with the stamp " + std::to_string(stamp_ns) +
                             " ns, expected a sum within +-" + std::to_string(kMaxStampNs) + " ns");
}

double MeasuredRate(TimeNs first, TimeNs last, size_t count) {
  return count < 2 ? 0 : static_cast<double>(count - 1) / SecondsBetween(first, last);
}

}  // namespace alidade
