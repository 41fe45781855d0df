#include "eval/files/input_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "core/regular_file.h"

namespace alidade {
namespace {

bool IsMissing(int reason) {
  return reason == ENOENT || reason == ENOTDIR;
}

Status TooLarge(const std::string& path, std::size_t max_bytes, StatusCode code) {
  return Status(code,
                path + ": is larger than expected: holds more than " + std::to_string(max_bytes) + " bytes");
}

}  // namespace

Result<std::string> ReadWholeFile(const std::string& path, StatusCode code, std::size_t max_bytes) {
  const Result<std::uintmax_t> size = RegularFileSize(path, code);
  ALIDADE_RETURN_IF_ERROR(size.status());
  if (*size > max_bytes) {
    return TooLarge(path, max_bytes, code);
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (file == nullptr) {
    return Status(code, path + ": cannot be read: " + std::strerror(errno));
  }
  std::string content;
  content.reserve(*size);
  char buffer[1 << 16];
  size_t count = 0;
  while ((count = std::fread(buffer, 1, sizeof buffer, file.get())) > 0) {
    content.append(buffer, count);
    if (content.size() > max_bytes) {  // a file of /proc has no size
      return TooLarge(path, max_bytes, code);
    }
  }
  if (std::ferror(file.get()) != 0) {
    return Status(code, path + ": cannot be read: " + std::strerror(errno));
  }
  return content;
}

bool StaysInFolder(std::string_view name) {
  const std::filesystem::path path = name;
  return !path.is_absolute() && std::find(path.begin(), path.end(), "..") == path.end();
}

bool MayExist(const std::string& path) {
  struct stat found = {};
  return ::stat(path.c_str(), &found) == 0 || !IsMissing(errno);
}

bool MayBeFolder(const std::string& path) {
  struct stat found = {};
  return ::stat(path.c_str(), &found) == 0 ? S_ISDIR(found.st_mode) : !IsMissing(errno);
}

Status ExpectFolder(const std::string& path, const std::string& expected, StatusCode code) {
  struct stat found = {};
  const bool is_there = ::stat(path.c_str(), &found) == 0;
  if (is_there ? !S_ISDIR(found.st_mode) : IsMissing(errno)) {
    return Status(code, path + ": no such folder, expected " + expected);
  }
  if (!is_there || ::access(path.c_str(), X_OK) != 0) {
    return Status(code, path + ": cannot be entered: " + std::strerror(errno) + ", expected " + expected);
  }
  return Status::Ok();
}

}  // namespace alidade
