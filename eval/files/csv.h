#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "core/time.h"

namespace alidade {

/// A column a header must have: "name [unit]". A header may leave the unit out unless it is required.
struct CsvColumn {
  std::string_view name;
  std::string_view unit = {};
  bool unit_required = false;
};

/// Walks the rows of a delimited text file, of which it holds one block at a time. Numbers are parsed from
/// whole fields: trailing characters, "nan", "inf" and overflow are faults. CRLF line ends, blank lines and a
/// byte order mark are accepted. Every fault is kInput "file:line: column N (name): found 'text', expected
/// ...".
class CsvReader {
 public:
  /// No table has a longer row.
  static constexpr std::size_t kMaxRowBytes = std::size_t{1} << 20;

  /// `separator` ' ' means any run of spaces and tabs. Errors: the file cannot be read or holds no text.
  static Result<CsvReader> Open(const std::string& path, char separator = ',');

  /// Moves to the next row that is not blank; false at the end of the file. A row that cannot be read, or is
  /// longer than kMaxRowBytes, is a row of one empty field, and the last one: whatever is asked of it gives
  /// its fault.
  bool NextRow();
  [[nodiscard]] size_t columns() const { return fields_.size(); }
  [[nodiscard]] std::string_view field(size_t column) const { return fields_[column]; }
  /// "file:line" of the current row.
  [[nodiscard]] std::string Place() const;

  /// The current row is a header of these columns (a leading '#' and blanks aside); more may follow if
  /// `allow_more`.
  [[nodiscard]] Status ExpectHeader(const std::vector<CsvColumn>& columns, bool allow_more = false) const;
  /// The current row has exactly `count` fields; fewer is a torn row.
  [[nodiscard]] Status ExpectColumns(size_t count) const;

  Status ReadInt64(size_t column, std::string_view name, std::int64_t* value) const;
  Status ReadReal(size_t column, std::string_view name, double* value) const;
  /// ReadReal that also takes "nan" and "inf", of either sign and case.
  Status ReadRealOrNotFinite(size_t column, std::string_view name, double* value) const;
  /// A stamp [ns] of at most kMaxStampNs either way.
  Status ReadTime(size_t column, std::string_view name, TimeNs* stamp) const;
  /// A stamp (ReadTime) in column 0 that must be later than `previous` unless `first`.
  Status ReadStamp(bool first, TimeNs previous, TimeNs* stamp) const;
  /// The fault of a column of the current row.
  [[nodiscard]] Status Fault(size_t column, std::string_view name, const std::string& expected) const;

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

  CsvReader(std::string path, File file, char separator);
  void Split(std::string_view line);
  /// Brings all of the line at begin_ into the block and returns its length; at the end of the file what is
  /// left.
  size_t LoadLine();

  std::string path_;
  File file_;
  char separator_ = ',';
  std::string block_;
  size_t begin_ = 0;  ///< of what is unread in block_
  bool at_end_ = false;
  int line_ = 0;
  Status broken_;
  std::vector<std::string_view> fields_;  ///< views into block_, valid while the reader is not moved
};

/// `text` in quotes, shortened for messages.
[[nodiscard]] std::string Quoted(std::string_view text);

}  // namespace alidade
