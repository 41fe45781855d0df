#include "eval/files/csv.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/regular_file.h"

namespace alidade {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view Trim(std::string_view text) {
  const size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string WithoutBlanks(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (kBlanks.find(c) == std::string_view::npos) {
      result.push_back(c);
    }
  }
  return result;
}

std::string HeaderText(const CsvColumn& column) {
  std::string text(column.name);
  if (!column.unit.empty()) {
    text += " [" + std::string(column.unit) + "]";
  }
  return text;
}

bool HeaderMatches(std::string_view field, const CsvColumn& column) {
  std::string found = WithoutBlanks(field.starts_with('#') ? field.substr(1) : field);
  if (found.ends_with("[]")) {  // EuRoC's mark of a quaternion, which has no unit
    found.resize(found.size() - 2);
  }
  return found == WithoutBlanks(HeaderText(column)) || (!column.unit_required && found == column.name);
}

}  // namespace

std::string Quoted(std::string_view text) {
  constexpr size_t kLongest = 60;
  return text.size() <= kLongest ? "'" + std::string(text) + "'"
                                 : "'" + std::string(text.substr(0, kLongest)) + "...'";
}

CsvReader::CsvReader(std::string path, File file, char separator)
    : path_(std::move(path)), file_(std::move(file)), separator_(separator) {}

Result<CsvReader> CsvReader::Open(const std::string& path, char separator) {
  ALIDADE_RETURN_IF_ERROR(RegularFileSize(path).status());
  File file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (file == nullptr) {
    return Status::Input(path + ": cannot be read: " + std::strerror(errno));
  }
  CsvReader reader(path, std::move(file), separator);
  reader.LoadLine();
  if (reader.block_.starts_with("\xEF\xBB\xBF")) {
    reader.begin_ = 3;
  }
  while (true) {  // blank lines count as lines, but not as text
    const size_t length = reader.LoadLine();
    ALIDADE_RETURN_IF_ERROR(reader.broken_);
    if (std::string_view(reader.block_).substr(reader.begin_, length).find_first_not_of(kBlanks) !=
        std::string_view::npos) {
      return reader;
    }
    if (reader.begin_ + length >= reader.block_.size()) {
      return Status::Input(path + ": is empty");
    }
    reader.begin_ += length + 1;
    ++reader.line_;
  }
}

size_t CsvReader::LoadLine() {
  constexpr size_t kBlock = size_t{1} << 17;
  size_t searched = begin_;
  while (true) {
    const size_t end = block_.find('\n', searched);
    if (end != std::string::npos) {
      return end - begin_;
    }
    if (at_end_) {
      return block_.size() - begin_;
    }
    block_.erase(0, begin_);
    begin_ = 0;
    searched = block_.size();
    if (searched > kMaxRowBytes) {
      broken_ = Status::Input(path_ + ": is larger than expected: holds a row of more than " +
                              std::to_string(kMaxRowBytes) + " bytes");
      return 0;
    }
    block_.resize(searched + kBlock);
    const size_t count = std::fread(block_.data() + searched, 1, kBlock, file_.get());
    block_.resize(searched + count);
    at_end_ = count < kBlock;
    if (at_end_ && std::ferror(file_.get()) != 0) {
      broken_ = Status::Input(path_ + ": cannot be read: " + std::strerror(errno));
      return 0;
    }
  }
}

bool CsvReader::NextRow() {
  while (broken_.ok()) {
    const size_t length = LoadLine();
    if (!broken_.ok()) {
      fields_.assign(1, std::string_view());
      return true;
    }
    if (begin_ >= block_.size()) {
      return false;
    }
    const std::string_view line = Trim(std::string_view(block_).substr(begin_, length));
    begin_ = std::min(begin_ + length + 1, block_.size());
    ++line_;
    if (!line.empty()) {
      Split(line);
      return true;
    }
  }
  return false;
}

void CsvReader::Split(std::string_view line) {
  fields_.clear();
  while (true) {
    const size_t end = separator_ == ' ' ? line.find_first_of(" \t") : line.find(separator_);
    fields_.push_back(Trim(line.substr(0, end)));
    if (end == std::string_view::npos) {
      return;
    }
    line.remove_prefix(end + 1);
    if (separator_ == ' ') {
      line = Trim(line);
    }
  }
}

std::string CsvReader::Place() const {
  return path_ + ":" + std::to_string(line_);
}

Status CsvReader::Fault(size_t column, std::string_view name, const std::string& expected) const {
  if (!broken_.ok()) {
    return broken_;
  }
  const std::string_view found = column < fields_.size() ? fields_[column] : std::string_view();
  return Status::Input(Place() + ": column " + std::to_string(column + 1) + " (" + std::string(name) +
                       "): found " + Quoted(found) + ", expected " + expected);
}

Status CsvReader::ExpectHeader(const std::vector<CsvColumn>& columns, bool allow_more) const {
  ALIDADE_RETURN_IF_ERROR(broken_);
  for (size_t i = 0; i < columns.size(); ++i) {
    const std::string expected = HeaderText(columns[i]);
    if (i >= fields_.size()) {
      return Status::Input(Place() + ": header ends after column " + std::to_string(i) + ", expected '" +
                           expected + "' next");
    }
    if (!HeaderMatches(fields_[i], columns[i])) {
      return Status::Input(Place() + ": header column " + std::to_string(i + 1) + ": found " +
                           Quoted(fields_[i]) + ", expected '" + (i == 0 ? "#" : "") + expected + "'");
    }
  }
  if (!allow_more && fields_.size() > columns.size()) {
    return Status::Input(Place() + ": header column " + std::to_string(columns.size() + 1) + ": found " +
                         Quoted(fields_[columns.size()]) + ", expected the header to end after " +
                         std::to_string(columns.size()) + " columns");
  }
  return Status::Ok();
}

Status CsvReader::ExpectColumns(size_t count) const {
  ALIDADE_RETURN_IF_ERROR(broken_);
  if (fields_.size() == count) {
    return Status::Ok();
  }
  const std::string found = std::to_string(fields_.size()) + " columns";
  if (fields_.size() < count) {
    return Status::Input(Place() + ": torn row: found " + found + ", expected " + std::to_string(count));
  }
  return Status::Input(Place() + ": row too long: found " + found + " (the first extra is " +
                       Quoted(fields_[count]) + "), expected " + std::to_string(count));
}

Status CsvReader::ReadInt64(size_t column, std::string_view name, std::int64_t* value) const {
  const std::string_view text = fields_[column];
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *value);
  if (error != std::errc() || end != text.data() + text.size()) {
    return Fault(column, name, "an integer of at most 64 bits");
  }
  return Status::Ok();
}

Status CsvReader::ReadReal(size_t column, std::string_view name, double* value) const {
  ALIDADE_RETURN_IF_ERROR(ReadRealOrNotFinite(column, name, value));
  return std::isfinite(*value) ? Status::Ok() : Fault(column, name, "a finite number");
}

Status CsvReader::ReadRealOrNotFinite(size_t column, std::string_view name, double* value) const {
  const std::string_view text = fields_[column];
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *value);
  return error == std::errc() && end == text.data() + text.size() ? Status::Ok()
                                                                  : Fault(column, name, "a finite number");
}

Status CsvReader::ReadTime(size_t column, std::string_view name, TimeNs* stamp) const {
  ALIDADE_RETURN_IF_ERROR(ReadInt64(column, name, stamp));
  return -kMaxStampNs <= *stamp && *stamp <= kMaxStampNs
             ? Status::Ok()
             : Fault(column, name, "a stamp within +-" + std::to_string(kMaxStampNs) + " ns");
}

Status CsvReader::ReadStamp(bool first, TimeNs previous, TimeNs* stamp) const {
  ALIDADE_RETURN_IF_ERROR(ReadTime(0, "timestamp", stamp));
  if (!first && *stamp <= previous) {
    return Fault(0, "timestamp", "a stamp later than " + std::to_string(previous) + " of the row before");
  }
  return Status::Ok();
}

}  // namespace alidade
