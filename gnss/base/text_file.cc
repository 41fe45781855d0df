#include "gnss/base/text_file.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>

#include "core/format.h"
#include "core/regular_file.h"

namespace alidade {
namespace {

constexpr std::string_view kBlanks(" \t\r\0", 4);

bool IsBlank(char c) {
  return kBlanks.find(c) != std::string_view::npos;
}

}  // namespace

void TextStream::Close::operator()(void* file) const {
  gzclose(static_cast<gzFile>(file));
}

TextStream::TextStream(std::string path, void* file) : path_(std::move(path)), file_(file) {}

Result<TextStream> TextStream::Open(const std::string& path) {
  ALIDADE_RETURN_IF_ERROR(RegularFileSize(path).status());
  errno = 0;
  // zlib passes a file that is not gzip through unchanged.
  TextStream stream(path, gzopen(path.c_str(), "rb"));
  if (stream.file_ == nullptr) {
    return Status::Input(path + ": cannot be read: " + std::strerror(errno));
  }
  return stream;
}

bool TextStream::Read(std::string* text) {
  constexpr std::size_t kPart = std::size_t{1} << 17;
  const gzFile file = static_cast<gzFile>(file_.get());
  const std::size_t before = text->size();
  text->resize(before + kPart);
  errno = 0;
  const int count = gzread(file, text->data() + before, kPart);
  text->resize(before + static_cast<std::size_t>(std::max(count, 0)));
  if (count > 0) {
    return true;
  }
  int code = Z_OK;
  const char* reason = gzerror(file, &code);
  // gzread() gives what there is of a torn gzip file and reports it at the end only.
  if (count < 0 || code == Z_BUF_ERROR) {
    status_ =
        Status::Input(path_ + ": cannot be unpacked: " + (code == Z_ERRNO ? std::strerror(errno) : reason));
  }
  return false;
}

Result<std::string> ReadTextFile(const std::string& path) {
  Result<TextStream> stream = TextStream::Open(path);
  ALIDADE_RETURN_IF_ERROR(stream.status());
  std::string content;
  while (stream->Read(&content)) {
    if (content.size() > kMaxTextBytes) {
      return Status::Input(path + Format(": holds more than %zu MiB of text", kMaxTextBytes >> 20));
    }
  }
  ALIDADE_RETURN_IF_ERROR(stream->status());
  return content;
}

LineReader::LineReader(std::string path, std::string_view text) : path_(std::move(path)), text_(text) {
  if (text_.starts_with("\xEF\xBB\xBF")) {
    position_ = 3;
  }
}

LineReader::LineReader(std::string path, TextStream* stream, std::string begin)
    : LineReader(std::move(path), begin) {
  stream_ = stream;
  part_ = std::move(begin);
  text_ = part_;
}

void LineReader::Refill() {
  position_ = std::min(position_, text_.size());  // one beyond after a line without an end
  std::size_t searched = position_;
  while (text_.find('\n', searched) == std::string_view::npos && text_.size() - position_ < kMaxLine) {
    part_.erase(0, position_);
    position_ = 0;
    searched = part_.size();
    const bool more = stream_->Read(&part_);
    text_ = part_;
    if (!more) {
      return;
    }
  }
}

bool LineReader::Next() {
  if (put_back_) {
    put_back_ = false;
    return true;
  }
  if (stream_ != nullptr) {
    Refill();
  }
  if (position_ >= text_.size()) {
    line_ = {};
    return false;
  }
  const std::size_t end = std::min(text_.find('\n', position_), text_.size());
  line_ = text_.substr(position_, end - position_);
  position_ = end + 1;
  ++number_;
  while (!line_.empty() && (line_.back() == '\r' || line_.back() == '\0')) {
    line_.remove_suffix(1);
  }
  return true;
}

std::string_view LineReader::trimmed() const {
  std::string_view text = line_;
  while (!text.empty() && IsBlank(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

Status LineReader::Fault(const std::string& message) const {
  return Status::Input(path_ + Format(":%d: ", number_) + message);
}

void ReaderWarnings::Add(const Status& fault) {
  ++count;
  if (first.size() < kKept) {
    first.push_back(fault.message());
  }
}

void ReaderWarnings::Merge(ReaderWarnings other) {
  for (std::string& text : other.first) {
    if (first.size() < kKept) {
      first.push_back(std::move(text));
    }
  }
  count += other.count;
}

Status ReaderWarnings::Nothing(const std::string& path, const std::string& what) const {
  return Status::Input(path + ": holds no " + what +
                       (first.empty() ? "" : "; first fault: " + first.front()));
}

std::string_view Field(std::string_view line, std::size_t start, std::size_t length) {
  if (start >= line.size()) {
    return {};
  }
  std::string_view field = line.substr(start, length);
  while (!field.empty() && IsBlank(field.front())) {
    field.remove_prefix(1);
  }
  while (!field.empty() && IsBlank(field.back())) {
    field.remove_suffix(1);
  }
  return field;
}

std::optional<double> ParseReal(std::string_view field) {
  if (field.starts_with('+')) {
    field.remove_prefix(1);
  }
  char text[40];
  if (field.empty() || field.size() > sizeof text) {
    return std::nullopt;
  }
  std::size_t size = 0;
  for (char c : field) {
    text[size++] = c == 'D' || c == 'd' ? 'e' : c;
  }
  double value = 0;
  const auto [end, error] = std::from_chars(text, text + size, value);
  // A number too small for a double is zero.
  const bool tiny = error == std::errc::result_out_of_range && std::memchr(text, '-', size) != nullptr &&
                    std::string_view(text, size).find("e-") != std::string_view::npos;
  if (tiny && end == text + size) {
    return 0.0;
  }
  return error == std::errc() && end == text + size && std::isfinite(value) ? std::optional(value)
                                                                            : std::nullopt;
}

std::optional<int> ParseInteger(std::string_view field) {
  if (field.starts_with('+')) {
    field.remove_prefix(1);
  }
  int value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return error == std::errc() && end == field.data() + field.size() && !field.empty() ? std::optional(value)
                                                                                      : std::nullopt;
}

bool ParseSeconds(std::string_view field, CalendarTime* time) {
  const std::size_t point = std::min(field.find('.'), field.size());
  const std::optional<int> whole = point == 0 ? std::optional(0) : ParseInteger(field.substr(0, point));
  if (!whole || *whole < 0 || *whole > 60 || field.empty()) {
    return false;
  }
  std::int64_t nanoseconds = 0;
  int digits = 0;
  for (std::size_t i = point + 1; i < field.size(); ++i) {
    if (field[i] < '0' || field[i] > '9') {
      return false;
    }
    if (digits < 9) {
      nanoseconds = 10 * nanoseconds + (field[i] - '0');
      ++digits;
    }
  }
  for (; digits < 9; ++digits) {
    nanoseconds *= 10;
  }
  time->second = *whole;
  time->nanoseconds = nanoseconds;
  return true;
}

Result<CalendarTime> ParseCalendar(std::string_view text) {
  CalendarTime time;
  int* const fields[] = {&time.year, &time.month, &time.day, &time.hour, &time.minute};
  constexpr const char* kNames[] = {"year", "month", "day", "hour", "minute"};
  for (int i = 0; i < 5; ++i) {
    const std::string_view word = NextWord(&text);
    const std::optional<int> value = ParseInteger(word);
    if (!value) {
      return Status::Input(Format("%s: found ", kNames[i]) + Excerpt(word) + ", expected an integer");
    }
    *fields[i] = *value;
  }
  const std::string_view seconds = NextWord(&text);
  if (!ParseSeconds(seconds, &time)) {
    return Status::Input("second: found " + Excerpt(seconds) + ", expected 0 to 60");
  }
  if (time.year >= 0 && time.year < 100) {
    time.year += time.year < 80 ? 2000 : 1900;
  }
  return time;
}

std::string_view NextWord(std::string_view* text) {
  const std::size_t start = std::min(text->find_first_not_of(kBlanks), text->size());
  const std::size_t end = std::min(text->find_first_of(kBlanks, start), text->size());
  const std::string_view word = text->substr(start, end - start);
  text->remove_prefix(end);
  return word;
}

std::string Excerpt(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string result = "'";
  for (const char c : text.substr(0, kLongest)) {
    result.push_back(c >= ' ' && c <= '~' ? c : '?');
  }
  return result + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace alidade
