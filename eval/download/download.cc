#include "eval/download/download.h"

#include <chrono>
#include <filesystem>
#include <thread>

#include "eval/download/transfer.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

std::uint64_t SizeOf(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  return error ? 0 : size;
}

std::string Of(std::uint64_t done, std::uint64_t total) {
  return std::to_string(done) + (total > 0 ? " of " + std::to_string(total) : "") + " bytes";
}

/// Checks the complete .part and gives it its name.
Status Finish(const DownloadRequest& request, const std::string& part) {
  const Status checked = CheckFile(part, request.expected);
  std::error_code error;
  if (!checked.ok()) {
    fs::remove(part, error);
    return Status::Input(request.url + ": not what is expected, removed: " + checked.message());
  }
  fs::rename(part, request.path, error);
  return error ? Status::Output(request.path + ": " + error.message()) : Status::Ok();
}

Status PrepareFolder(const std::string& path) {
  std::error_code error;
  const fs::path folder = fs::path(path).parent_path();
  if (!folder.empty()) {
    fs::create_directories(folder, error);
  }
  return error ? Status::Output(folder.string() + ": " + error.message()) : Status::Ok();
}

bool Stopped(const std::atomic<bool>* stop) {
  return stop != nullptr && stop->load();
}

/// Waits, in pieces that `stop` may end.
void Pause(double seconds, const std::atomic<bool>* stop) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < until && !Stopped(stop)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace

Status Download(const DownloadRequest& request, const DownloadProgress& progress,
                const std::atomic<bool>* stop) {
  if (!request.url.starts_with("http://") && !request.url.starts_with("https://")) {
    return Status::Usage(request.url + ": expected a URL that begins with http:// or https://");
  }
  std::error_code error;
  if (fs::exists(request.path, error)) {
    const Status checked = CheckFile(request.path, request.expected);
    return checked.ok() ? checked : Status::Input(checked.message() + "; remove it to fetch it again");
  }
  ALIDADE_RETURN_IF_ERROR(PrepareFolder(request.path));
  const std::string part = request.path + ".part";
  if (request.expected.bytes && SizeOf(part) > *request.expected.bytes) {
    fs::remove(part, error);  // of something else
  }
  for (int failures = 0;;) {
    const std::uint64_t before = SizeOf(part);
    if (request.expected.bytes && before == *request.expected.bytes && before > 0) {
      return Finish(request, part);
    }
    const TransferResult transfer = TransferOnce(request, part, before, progress, stop);
    if (transfer.outcome == TransferOutcome::kComplete) {
      return Finish(request, part);
    }
    if (transfer.outcome == TransferOutcome::kRefused) {
      return transfer.status;
    }
    const std::uint64_t after = SizeOf(part);
    const bool advances = after > before && (transfer.continued || before == 0);
    failures = advances ? 0 : failures + 1;
    if (Stopped(stop) || failures >= request.attempts) {
      return Status::Input(request.url + ": " + transfer.status.message() + " after " +
                           Of(after, transfer.total) + "; the same command continues");
    }
    Pause(request.pause_s, stop);
  }
}

}  // namespace alidade
