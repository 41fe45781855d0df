#include "eval/files/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <regex>
#include <thread>

namespace alidade {
namespace {

constexpr char kTemporary[] = ".tmp";  // then process and thread: two cells never share a file

/// The process of a temporary file's name; 0 for other files.
pid_t WriterOf(const std::string& name) {
  const size_t mark = name.rfind(kTemporary);
  if (mark == std::string::npos ||
      !std::regex_match(name.substr(mark + sizeof kTemporary - 1), std::regex("[0-9]+_[0-9]+"))) {
    return 0;
  }
  pid_t process = 0;
  const char* first = name.data() + mark + sizeof kTemporary - 1;
  const auto [end, error] = std::from_chars(first, name.data() + name.size(), process);
  return error == std::errc() ? process : std::numeric_limits<pid_t>::max();
}

/// Whether another process of that number runs: it may be writing into a folder further down.
bool IsAnotherThatLives(pid_t process) {
  return process != ::getpid() && (::kill(process, 0) == 0 || errno == EPERM);
}

/// Removes the temporary file of a process that was killed; any other file stays.
void RemoveIfLeft(const std::filesystem::path& file) {
  const pid_t writer = WriterOf(file.filename().string());
  if (writer > 0 && !IsAnotherThatLives(writer)) {
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
  }
}

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

/// Removes what processes that were killed left of WriteFileAtomically(path).
void RemoveTemporariesOf(const std::string& path) {
  namespace fs = std::filesystem;
  const fs::path file(path);
  const std::string start = file.filename().string() + kTemporary;
  std::error_code error;
  for (fs::directory_iterator entry(file.has_parent_path() ? file.parent_path() : ".", error), end;
       !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    // Of "a.csv" not "a.csv.tmp1_2.tmp3_4", which is another file's.
    if (name.starts_with(start) && name.rfind(kTemporary) == start.size() - (sizeof kTemporary - 1)) {
      RemoveIfLeft(entry->path());
    }
  }
}

}  // namespace

Status WriteFileAtomically(const std::string& path, std::string_view content) {
  return WriteFileAtomically(path, [content](const AppendText& append) { return append(content); });
}

Status WriteFileAtomically(const std::string& path, const std::function<Status(const AppendText&)>& write) {
  const HeldInterrupts held;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (!parent.empty()) {
    std::error_code error;
    std::filesystem::create_directories(parent, error);
    if (error) {
      return Status::Output(parent.string() + ": folder cannot be created: " + error.message());
    }
  }
  const std::string temporary = path + kTemporary + std::to_string(::getpid()) + "_" +
                                std::to_string(std::hash<std::thread::id>()(std::this_thread::get_id()));
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    return Status::Output(path + ": cannot be written: " + SystemReason());
  }
  Status status = write([&](std::string_view content) { return WriteAll(descriptor, content, path); });
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

Status WriteLoneFileAtomically(const std::string& path, std::string_view content) {
  RemoveTemporariesOf(path);
  return WriteFileAtomically(path, content);
}

void RemoveTemporaryFiles(const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto options = fs::directory_options::skip_permission_denied;
  for (fs::recursive_directory_iterator entry(folder, options, error), end; !error && entry != end;
       entry.increment(error)) {
    RemoveIfLeft(entry->path());
  }
}

std::string ShortestDouble(double value) {
  char text[40];
  const std::to_chars_result result = std::to_chars(text, text + sizeof text, value);
  return {text, result.ptr};
}

}  // namespace alidade
