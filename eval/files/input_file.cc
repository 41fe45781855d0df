#include "eval/files/input_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

namespace alidade {

Result<std::string> ReadWholeFile(const std::string& path, StatusCode code) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    return Status(code, path + ": is a folder, expected a file");
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (file == nullptr) {
    return Status(code, path + ": cannot be read: " + std::strerror(errno));
  }
  std::string content;
  const std::uintmax_t size = std::filesystem::file_size(path, ignored);
  if (!ignored) {
    content.reserve(size);
  }
  char buffer[1 << 16];
  size_t count = 0;
  while ((count = std::fread(buffer, 1, sizeof buffer, file.get())) > 0) {
    content.append(buffer, count);
  }
  if (std::ferror(file.get()) != 0) {
    return Status(code, path + ": cannot be read: " + std::strerror(errno));
  }
  return content;
}

}  // namespace alidade
