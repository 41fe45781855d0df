#include "eval/compare/worker_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>

#include "core/format.h"
#include "eval/compare/process_tree.h"

namespace alidade {
namespace {

using Clock = std::chrono::steady_clock;

// Of a process that was asked to end. Its outputs are renamed when they are whole, so being killed does them
// no harm.
constexpr std::chrono::seconds kGrace{5};

}  // namespace

Result<WorkerProcess> WorkerProcess::Start(const std::vector<std::string>& words) {
  std::array<int, 2> in{-1, -1}, out{-1, -1};
  if (::pipe2(in.data(), O_CLOEXEC) != 0 || ::pipe2(out.data(), O_CLOEXEC) != 0) {
    const std::string reason = std::strerror(errno);
    for (const int descriptor : in) {
      ::close(descriptor);
    }
    return Status::Output("a worker cannot be started: " + reason);
  }
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, in[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, out[1], STDOUT_FILENO);
  std::vector<std::string> arguments = words;
  std::vector<char*> pointers;
  pointers.reserve(arguments.size() + 1);
  for (std::string& word : arguments) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  pid_t process = 0;
  const int error = posix_spawn(&process, words.front().c_str(), &files, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  ::close(in[0]);
  ::close(out[1]);
  if (error != 0) {
    ::close(in[1]);
    ::close(out[0]);
    return Status::Output(words.front() + ": a worker cannot be started: " + std::strerror(error));
  }
  return WorkerProcess(process, in[1], out[0]);
}

WorkerProcess::WorkerProcess(WorkerProcess&& other) noexcept
    : process_(other.process_),
      to_(other.to_),
      from_(other.from_),
      interrupted_(other.interrupted_),
      text_(std::move(other.text_)) {
  other.process_ = 0;
  other.to_ = -1;
  other.from_ = -1;
}

WorkerProcess::~WorkerProcess() {
  if (process_ <= 0) {
    return;
  }
  Interrupt();
  ::close(std::exchange(to_, -1));
  siginfo_t ended{};
  while (ended.si_pid == 0 && Clock::now() < *interrupted_ + kGrace &&
         ::waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(ended.si_pid == 0 ? 5 : 0));
  }
  if (ended.si_pid == 0) {
    Kill();
  }
  Join();
}

void WorkerProcess::Send(const std::string& line) const {
  const std::string text = line + "\n";
  // Shorter than a pipe's buffer: written at once or not at all. SIGPIPE of an ended worker is ignored.
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  const ssize_t written = ::write(to_, text.data(), text.size());
  std::signal(SIGPIPE, before);
  static_cast<void>(written);
}

bool WorkerProcess::Read() {
  std::array<char, 4096> buffer;
  const ssize_t count = ::read(from_, buffer.data(), buffer.size());
  if (count > 0) {
    text_.append(buffer.data(), static_cast<size_t>(count));
  }
  return count > 0 || (count < 0 && errno == EINTR);
}

std::optional<std::string> WorkerProcess::Line() {
  const size_t end = text_.find('\n');
  if (end == std::string::npos) {
    return std::nullopt;
  }
  std::string line = text_.substr(0, end);
  text_.erase(0, end + 1);
  return line;
}

void WorkerProcess::Interrupt() {
  if (process_ > 0 && !interrupted_) {
    interrupted_ = Clock::now();
    kill(process_, SIGTERM);
  }
}

void WorkerProcess::Kill() const {
  if (process_ > 0) {
    KillTree(process_);
  }
}

int64_t WorkerProcess::Memory() const {
  return process_ > 0 ? MemoryOfTree(process_) : 0;
}

std::string WorkerProcess::Join() {
  if (process_ <= 0) {
    return {};
  }
  if (to_ >= 0) {
    ::close(std::exchange(to_, -1));
  }
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  ::close(from_);
  process_ = 0;
  return WIFEXITED(status) ? Format("code %d", WEXITSTATUS(status))
                           : Format("signal %d (%s)", WTERMSIG(status), strsignal(WTERMSIG(status)));
}

}  // namespace alidade
