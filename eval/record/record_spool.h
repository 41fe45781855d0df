#pragma once

#include <string>

#include "eval/files/table.h"
#include "eval/record/run_record.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {

/// Without calibration, observability and filtering covariance.
void Encode(const RunRecord& record, ByteWriter* bytes);
void Decode(ByteReader* bytes, RunRecord* record);

/// The output of a long run that is not held in memory: its records, and the rows of the tables that
/// nothing later changes, as text.
class RecordSpool {
 public:
  explicit RecordSpool(const std::string& folder)
      : folder_(folder),
        records_(Table<RunRecord>::InFile(folder)),
        calibration_rows_(folder),
        satellite_rows_(folder) {}

  /// Errors of all: SpoolFile's.
  Status Add(const RunRecord& record);
  Status Add(const GnssResiduals& residuals);
  /// Turns all records into the world of `alignment`, and calls them local.
  Status Turn(const GnssAlignment& alignment);

  [[nodiscard]] const Table<RunRecord>& records() const { return records_; }
  /// CalibrationColumns of the first calibration; empty without one.
  [[nodiscard]] const std::string& calibration_columns() const { return calibration_columns_; }
  /// Rows of calibration.csv and gnss.csv.
  [[nodiscard]] const SpoolFile& calibration_rows() const { return calibration_rows_; }
  [[nodiscard]] const SpoolFile& satellite_rows() const { return satellite_rows_; }

 private:
  std::string folder_;
  Table<RunRecord> records_;
  std::string calibration_columns_;
  SpoolFile calibration_rows_;
  SpoolFile satellite_rows_;
};

}  // namespace alidade
