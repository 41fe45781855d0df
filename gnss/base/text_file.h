#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "gnss/base/gnss_time.h"

namespace alidade {

/// A file may not unpack to more than this [bytes].
inline constexpr std::size_t kMaxTextBytes = std::size_t{1} << 29;

/// The content of a plain or gzip file. Errors: missing, a folder, torn or corrupt gzip, beyond
/// kMaxTextBytes.
Result<std::string> ReadTextFile(const std::string& path);

/// Walks the lines of a text held elsewhere; LF and CRLF ends, and trailing NULs and blanks, are not part of
/// a line.
class LineReader {
 public:
  LineReader(std::string path, std::string_view text);

  /// Moves to the next line; false at the end.
  bool Next();
  /// The next line again at the following call of Next().
  void PutBack() { put_back_ = true; }
  [[nodiscard]] std::string_view line() const { return line_; }
  /// The line without blanks at its end.
  [[nodiscard]] std::string_view trimmed() const;
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// kInput "file:line: message".
  [[nodiscard]] Status Fault(const std::string& message) const;

 private:
  std::string path_;
  std::string_view text_;
  std::string_view line_;
  std::size_t position_ = 0;
  int number_ = 0;
  bool put_back_ = false;
};

/// What a tolerant reader passed over: the first few faults in words, and how many there were.
struct ReaderWarnings {
  std::vector<std::string> first;  ///< "file:line: what", at most kKept
  std::int64_t count = 0;

  static constexpr std::size_t kKept = 10;
  void Add(const Status& fault);
  void Merge(ReaderWarnings other);
  /// kInput "path: holds no <what>", with the first fault.
  [[nodiscard]] Status Nothing(const std::string& path, const std::string& what) const;
};

/// Columns [start, start + length) of a line, as far as it reaches; blanks at both ends cut.
[[nodiscard]] std::string_view Field(std::string_view line, std::size_t start, std::size_t length);
/// A whole decimal number; Fortran exponents D and d, and a leading '+', are fine. Nothing for blank,
/// trailing characters, "nan", "inf" or overflow.
[[nodiscard]] std::optional<double> ParseReal(std::string_view field);
[[nodiscard]] std::optional<int> ParseInteger(std::string_view field);
/// "12.3456789" or "12": seconds and nanoseconds, digits beyond the ninth dropped; 0..60.
bool ParseSeconds(std::string_view field, CalendarTime* time);
/// A calendar label of blank-separated fields "yyyy mm dd hh mm ss.sss" (two-digit years are 1980..2079).
/// Errors: which field is wrong.
Result<CalendarTime> ParseCalendar(std::string_view text);
/// The next run of non-blanks of `text`, which is cut; empty at its end.
[[nodiscard]] std::string_view NextWord(std::string_view* text);
/// `text` in quotes, shortened and with unprintable characters replaced, for messages.
[[nodiscard]] std::string Excerpt(std::string_view text);

}  // namespace alidade
