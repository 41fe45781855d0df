#include "eval/download/transfer.h"

#include <curl/curl.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>

namespace alidade {
namespace {

constexpr long kConnectTimeoutS = 30;
constexpr long kHttpOk = 200, kHttpPartial = 206, kHttpRangeWrong = 416;

void InitializeCurl() {
  static const CURLcode once = curl_global_init(CURL_GLOBAL_DEFAULT);
  (void)once;
}

std::optional<std::uint64_t> ParseCount(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// "bytes 100-199/200" or "bytes */200".
struct ContentRange {
  std::optional<std::uint64_t> first, total;
};

ContentRange ParseContentRange(std::string_view value) {
  ContentRange range = {};
  const std::size_t space = value.find(' ');
  const std::size_t slash = value.find('/');
  if (space == std::string_view::npos || slash == std::string_view::npos || slash < space) {
    return range;
  }
  const std::string_view span = value.substr(space + 1, slash - space - 1);
  range.first = ParseCount(span.substr(0, span.find('-')));
  range.total = ParseCount(value.substr(slash + 1));
  return range;
}

/// One request under way.
struct Transfer {
  const DownloadRequest& request;
  const std::string& part;
  std::uint64_t offset;
  const DownloadProgress& progress;
  const std::atomic<bool>* stop;

  CURL* curl = nullptr;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file{nullptr, &std::fclose};
  ContentRange range = {};
  std::optional<std::uint64_t> length = {};  ///< of the body
  std::uint64_t written = 0;                 ///< of the whole file
  std::uint64_t total = 0;
  bool continued = false;
  bool useless_part = false;  ///< to this server
  Status fault = {};          ///< why the body is not taken

  [[nodiscard]] long Code() const {
    long code = 0;
    curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &code);
    return code;
  }

  Status Open(bool anew) {
    file.reset(std::fopen(part.c_str(), anew ? "wb" : "ab"));
    written = anew ? 0 : offset;
    return file ? Status::Ok() : Status::Output(part + ": " + std::strerror(errno));
  }

  /// Before the first byte of a body: what it is a part of, and whether that is the expected file.
  Status Begin() {
    const bool continues = Code() == kHttpPartial && range.first == offset;
    if (Code() == kHttpPartial && !continues) {
      useless_part = true;
      return Status::Input(request.url + ": the server answers with another range than requested");
    }
    total = continues ? range.total.value_or(0) : length.value_or(0);
    if (request.expected.bytes && total > 0 && total != *request.expected.bytes) {
      return Status::Input(request.url + ": size: the server offers " + std::to_string(total) +
                           " bytes, expected " + std::to_string(*request.expected.bytes));
    }
    continued = continues;
    return Open(!continues);
  }

  Status Take(const char* data, std::size_t size) {
    if (!file) {
      ALIDADE_RETURN_IF_ERROR(Begin());
    }
    if (request.expected.bytes && written + size > *request.expected.bytes) {
      return Status::Input(request.url + ": the server sends more than the expected " +
                           std::to_string(*request.expected.bytes) + " bytes");
    }
    if (std::fwrite(data, 1, size, file.get()) != size) {
      return Status::Output(part + ": " + std::strerror(errno));
    }
    written += size;
    return Status::Ok();
  }
};

std::size_t OnHeader(char* data, std::size_t unit, std::size_t count, void* user) {
  Transfer& transfer = *static_cast<Transfer*>(user);
  const std::string_view line(data, unit * count);
  const auto value_of = [&](std::string_view name) -> std::optional<std::string_view> {
    if (line.size() <= name.size() || curl_strnequal(line.data(), name.data(), name.size()) == 0) {
      return std::nullopt;
    }
    const std::string_view value = line.substr(name.size());
    const std::size_t begin = value.find_first_not_of(' ');
    const std::size_t end = value.find_last_not_of(" \r\n");
    return begin == std::string_view::npos ? "" : value.substr(begin, end - begin + 1);
  };
  if (line.starts_with("HTTP/")) {  // of a redirection before
    transfer.range = {};
    transfer.length.reset();
  } else if (const auto range = value_of("content-range:")) {
    transfer.range = ParseContentRange(*range);
  } else if (const auto length = value_of("content-length:")) {
    transfer.length = ParseCount(*length);
  }
  return unit * count;
}

std::size_t OnBody(char* data, std::size_t unit, std::size_t count, void* user) {
  Transfer& transfer = *static_cast<Transfer*>(user);
  const std::size_t size = unit * count;
  const long code = transfer.Code();
  if (code != kHttpOk && code != kHttpPartial) {
    return size;  // the page of an error
  }
  transfer.fault = transfer.Take(data, size);
  return transfer.fault.ok() ? size : size + 1;
}

int OnProgress(void* user, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  const Transfer& transfer = *static_cast<const Transfer*>(user);
  if (transfer.progress && transfer.file) {
    transfer.progress(transfer.written, transfer.total);
  }
  return transfer.stop != nullptr && transfer.stop->load() ? 1 : 0;
}

template <typename Value>
void Set(CURL* curl, CURLoption option, Value value) {
  curl_easy_setopt(curl, option, value);
}

void SetOptions(Transfer* transfer, char* reason) {
  CURL* curl = transfer->curl;
  Set(curl, CURLOPT_URL, transfer->request.url.c_str());
  Set(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  Set(curl, CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
  Set(curl, CURLOPT_FOLLOWLOCATION, 1L);
  Set(curl, CURLOPT_MAXREDIRS, 10L);
  Set(curl, CURLOPT_USERAGENT, "alidade/" ALIDADE_VERSION);
  Set(curl, CURLOPT_NOSIGNAL, 1L);
  Set(curl, CURLOPT_CONNECTTIMEOUT, kConnectTimeoutS);
  Set(curl, CURLOPT_LOW_SPEED_LIMIT, 1L);
  Set(curl, CURLOPT_LOW_SPEED_TIME, transfer->request.stall_timeout_s);
  Set(curl, CURLOPT_ERRORBUFFER, reason);
  Set(curl, CURLOPT_HEADERFUNCTION, OnHeader);
  Set(curl, CURLOPT_HEADERDATA, transfer);
  Set(curl, CURLOPT_WRITEFUNCTION, OnBody);
  Set(curl, CURLOPT_WRITEDATA, transfer);
  Set(curl, CURLOPT_NOPROGRESS, 0L);
  Set(curl, CURLOPT_XFERINFOFUNCTION, OnProgress);
  Set(curl, CURLOPT_XFERINFODATA, transfer);
}

/// The server's answer to a request that curl found no fault with.
TransferResult ResultOf(Transfer* transfer) {
  const long code = transfer->Code();
  if (code == kHttpRangeWrong && transfer->offset > 0) {
    if (transfer->range.total == transfer->offset) {
      return {TransferOutcome::kComplete, Status::Ok(), transfer->offset, true};  // nothing was missing
    }
    std::remove(transfer->part.c_str());
    return {TransferOutcome::kInterrupted, Status::Input("the server has no such range"), 0, false};
  }
  if (code != kHttpOk && code != kHttpPartial) {
    // Codes from 500 on, and 408 and 429, mean: later.
    const bool later = code >= 500 || code == 408 || code == 429;
    const std::string answer = "the server answers " + std::to_string(code);
    return {later ? TransferOutcome::kInterrupted : TransferOutcome::kRefused,
            Status::Input(later ? answer : transfer->request.url + ": " + answer), 0, false};
  }
  Status opened = transfer->file ? Status::Ok() : transfer->Begin();  // an empty body
  if (opened.ok() && (std::fflush(transfer->file.get()) != 0)) {
    opened = Status::Output(transfer->part + ": " + std::strerror(errno));
  }
  if (opened.ok() && transfer->written < transfer->request.expected.bytes.value_or(0)) {
    return {TransferOutcome::kInterrupted, Status::Input("the connection ended"), transfer->total,
            transfer->continued};
  }
  return {opened.ok() ? TransferOutcome::kComplete : TransferOutcome::kRefused, opened, transfer->total,
          transfer->continued};
}

}  // namespace

TransferResult TransferOnce(const DownloadRequest& request, const std::string& part, std::uint64_t offset,
                            const DownloadProgress& progress, const std::atomic<bool>* stop) {
  InitializeCurl();
  const std::unique_ptr<CURL, void (*)(CURL*)> curl{curl_easy_init(), &curl_easy_cleanup};
  if (!curl) {
    return {TransferOutcome::kRefused, Status::Input(request.url + ": libcurl cannot be initialised"), 0,
            false};
  }
  Transfer transfer{.request = request, .part = part, .offset = offset, .progress = progress, .stop = stop};
  transfer.curl = curl.get();
  char reason[CURL_ERROR_SIZE] = "";
  SetOptions(&transfer, reason);
  // Not CURLOPT_RESUME_FROM: with it, curl gives up on a server that sends the whole file.
  const std::string range = std::to_string(offset) + "-";
  if (offset > 0) {
    Set(curl.get(), CURLOPT_RANGE, range.c_str());
  }
  const CURLcode code = curl_easy_perform(curl.get());
  if (transfer.useless_part) {
    std::remove(part.c_str());
    return {TransferOutcome::kInterrupted, transfer.fault, 0, false};
  }
  if (!transfer.fault.ok()) {
    return {TransferOutcome::kRefused, transfer.fault, transfer.total, false};
  }
  if (code == CURLE_OK) {
    return ResultOf(&transfer);
  }
  const std::string text = *reason != '\0' ? reason : curl_easy_strerror(code);
  const bool hopeless = code == CURLE_URL_MALFORMAT || code == CURLE_UNSUPPORTED_PROTOCOL ||
                        code == CURLE_TOO_MANY_REDIRECTS || code == CURLE_PEER_FAILED_VERIFICATION;
  return {hopeless ? TransferOutcome::kRefused : TransferOutcome::kInterrupted,
          Status::Input(hopeless ? request.url + ": " + text : text), transfer.total, transfer.continued};
}

}  // namespace alidade
