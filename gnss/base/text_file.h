#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "gnss/base/gnss_time.h"

namespace alidade {

/// A file may not unpack to more than this [bytes].
inline constexpr std::size_t kMaxTextBytes = std::size_t{1} << 29;

/// A plain or gzip file, read part by part.
class TextStream {
 public:
  /// Errors (kInput): missing, a folder.
  static Result<TextStream> Open(const std::string& path);

  /// Appends the next part; false at the end, and when the rest cannot be read.
  bool Read(std::string* text);
  /// Whether all that was read was whole. kInput: torn or corrupt gzip.
  [[nodiscard]] const Status& status() const { return status_; }

 private:
  struct Close {
    void operator()(void* file) const;
  };
  TextStream(std::string path, void* file);

  std::string path_;
  std::unique_ptr<void, Close> file_;  ///< zlib's gzFile
  Status status_ = Status::Ok();
};

/// The content of a plain or gzip file. Errors: TextStream's, beyond kMaxTextBytes.
Result<std::string> ReadTextFile(const std::string& path);

/// Walks the lines of a text; LF and CRLF ends, and trailing NULs and blanks, are not part of a line.
class LineReader {
 public:
  /// A line of a stream that is longer is cut into several [bytes].
  static constexpr std::size_t kMaxLine = std::size_t{1} << 20;

  /// A text held elsewhere.
  LineReader(std::string path, std::string_view text);
  /// A stream, of which a part at a time is held. `begin`: what was read of it already.
  LineReader(std::string path, TextStream* stream, std::string begin);
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// Moves to the next line; false at the end.
  bool Next();
  /// The next line again at the following call of Next().
  void PutBack() { put_back_ = true; }
  /// Valid until the next call of Next().
  [[nodiscard]] std::string_view line() const { return line_; }
  /// The line without blanks at its end.
  [[nodiscard]] std::string_view trimmed() const;
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// kInput "file:line: message".
  [[nodiscard]] Status Fault(const std::string& message) const;

 private:
  /// Reads on until the stream's next line is whole in text_.
  void Refill();

  std::string path_;
  TextStream* stream_ = nullptr;
  std::string part_;       ///< of the stream
  std::string_view text_;  ///< part_, where there is a stream
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
