#include "eval/files/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <functional>
#include <thread>

namespace alidade {
namespace {

std::string SystemReason() {
  return std::strerror(errno);
}

Status WriteAll(int descriptor, std::string_view content, const std::string& path) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0) {
      if (errno == EINTR) {
        continue;
      }
      return Status::Output(path + ": cannot be written: " + SystemReason());
    }
    content.remove_prefix(static_cast<size_t>(written));
  }
  return Status::Ok();
}

/// Delivers SIGINT and SIGTERM to this thread later: a handler that ends the program must leave no temporary
/// file.
class HeldInterrupts {
 public:
  HeldInterrupts() {
    sigset_t interrupts;
    sigemptyset(&interrupts);
    sigaddset(&interrupts, SIGINT);
    sigaddset(&interrupts, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &interrupts, &before_);
  }
  ~HeldInterrupts() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  HeldInterrupts(const HeldInterrupts&) = delete;
  HeldInterrupts& operator=(const HeldInterrupts&) = delete;

 private:
  sigset_t before_;
};

}  // namespace

Status WriteFileAtomically(const std::string& path, std::string_view content) {
  const HeldInterrupts held;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (!parent.empty()) {
    std::error_code error;
    std::filesystem::create_directories(parent, error);
    if (error) {
      return Status::Output(parent.string() + ": folder cannot be created: " + error.message());
    }
  }
  // Process and thread in the name: two cells of a comparison never share a temporary file.
  const std::string temporary = path + ".tmp" + std::to_string(::getpid()) + "_" +
                                std::to_string(std::hash<std::thread::id>()(std::this_thread::get_id()));
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    return Status::Output(path + ": cannot be written: " + SystemReason());
  }
  Status status = WriteAll(descriptor, content, path);
  if (::close(descriptor) != 0 && status.ok()) {
    status = Status::Output(path + ": cannot be written: " + SystemReason());
  }
  if (status.ok() && ::rename(temporary.c_str(), path.c_str()) != 0) {
    status = Status::Output(path + ": cannot be replaced: " + SystemReason());
  }
  if (!status.ok()) {
    ::unlink(temporary.c_str());
  }
  return status;
}

std::string ShortestDouble(double value) {
  char text[40];
  const std::to_chars_result result = std::to_chars(text, text + sizeof text, value);
  return {text, result.ptr};
}

}  // namespace alidade
