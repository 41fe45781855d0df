#include "core/regular_file.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstring>

namespace alidade {
namespace {

const char* KindOf(mode_t mode) {
  if (S_ISDIR(mode)) {
    return "a folder";
  }
  if (S_ISFIFO(mode)) {
    return "a pipe";
  }
  return S_ISSOCK(mode) ? "a socket" : "a device";
}

}  // namespace

Result<std::uintmax_t> RegularFileSize(const std::string& path, StatusCode code) {
  struct stat found = {};
  if (::stat(path.c_str(), &found) != 0) {
    return Status(code, path + ": cannot be read: " + std::strerror(errno));
  }
  if (!S_ISREG(found.st_mode)) {
    return Status(code, path + ": is " + KindOf(found.st_mode) + ", expected a file");
  }
  return static_cast<std::uintmax_t>(found.st_size);
}

}  // namespace alidade
