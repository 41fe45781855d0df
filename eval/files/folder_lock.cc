#include "eval/files/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <map>

namespace alidade {

Status LockFolder(const std::string& folder) {
  static std::map<std::string, int> held;
  std::error_code ignored;
  const std::string name = std::filesystem::canonical(folder, ignored).string();
  if (held.count(name) > 0) {
    return Status::Ok();
  }
  // Without O_CLOEXEC: workers that outlive this process still write.
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY);
  if (descriptor < 0) {
    return Status::Ok();
  }
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor);
    return Status::Output(folder + ": another process is writing there");
  }
  held[name] = descriptor;
  return Status::Ok();
}

}  // namespace alidade
