#include "eval/compare/external_run.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>
#include <vector>

#include "core/format.h"
#include "eval/files/shell_quote.h"
#include "eval/files/suggest.h"

namespace alidade {
namespace {

using Clock = std::chrono::steady_clock;

std::string LastLine(const std::string& path) {
  std::ifstream file(path);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    last = line.find_first_not_of(" \t\r") == std::string::npos ? last : line;
  }
  constexpr size_t kMaxLength = 200;
  return last.substr(0, kMaxLength);
}

/// Starts /bin/sh; the process id, or a negative error number.
pid_t Start(const std::string& command, const std::string& log_path) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // A group of its own: what the shell starts is ended with it.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::string shell = "/bin/sh", option = "-c", text = command;
  char* arguments[] = {shell.data(), option.data(), text.data(), nullptr};
  pid_t process = 0;
  const int error = posix_spawn(&process, shell.c_str(), &files, &attributes, arguments, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return error == 0 ? process : -error;
}

double Seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

Result<std::string> FillCommand(const std::string& text, const std::map<std::string, std::string>& values) {
  std::vector<std::string> known;
  known.reserve(values.size());
  for (const auto& [word, value] : values) {
    known.push_back(word);
  }
  std::string filled;
  for (size_t i = 0; i < text.size();) {
    const size_t end = text[i] == '{' ? text.find('}', i) : std::string::npos;
    const std::string word = end == std::string::npos ? std::string() : text.substr(i + 1, end - i - 1);
    // ${name} and awk's programs are the shell's business.
    const bool shell = i > 0 && text[i - 1] == '$';
    const bool plain =
        !word.empty() && word.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string::npos;
    if (shell || !plain) {
      filled += text[i++];
      continue;
    }
    const auto value = values.find(word);
    if (value == values.end()) {
      return Status::Config("command: unknown placeholder {" + word + "}" + Suggestion(word, known));
    }
    filled += ShellQuoted(value->second);
    i = end + 1;
  }
  return filled;
}

Result<ExternalRun> RunExternal(const std::string& command, const std::string& log_path, double timeout_s,
                                const std::atomic<bool>* stop) {
  const Clock::time_point begin = Clock::now();
  const pid_t process = Start(command, log_path);
  if (process <= 0) {
    return Status::Output(log_path + ": the command cannot be started (error " + std::to_string(-process) +
                          ")");
  }
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  int status = 0;
  rusage usage{};
  std::string ended;
  while (wait4(process, &status, WNOHANG, &usage) == 0) {
    if (ended.empty() && (elapsed() > timeout_s || (stop != nullptr && stop->load()))) {
      ended = elapsed() > timeout_s ? Format("took longer than %g s", timeout_s) : std::string("stopped");
      kill(-process, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ExternalRun run{elapsed(), Seconds(usage.ru_utime) + Seconds(usage.ru_stime)};
  if (!ended.empty()) {
    return Status::Diverged("the command " + ended);
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    const std::string how =
        WIFEXITED(status) ? Format("code %d", WEXITSTATUS(status)) : Format("signal %d", WTERMSIG(status));
    return Status::Diverged("the command ended with " + how + ": " + LastLine(log_path));
  }
  return run;
}

}  // namespace alidade
