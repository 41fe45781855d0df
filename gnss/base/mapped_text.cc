#include "gnss/base/mapped_text.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <utility>

#include "core/regular_file.h"
#include "gnss/base/text_file.h"

namespace alidade {

Result<MappedText> MappedText::Open(const std::string& path) {
  ALIDADE_RETURN_IF_ERROR(RegularFileSize(path).status());
  MappedText text;
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat info {};
  if (file >= 0 && ::fstat(file, &info) == 0 && info.st_size > 0) {
    const size_t size = static_cast<size_t>(info.st_size);
    void* const at = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
    if (at != MAP_FAILED) {
      ::madvise(at, size, MADV_SEQUENTIAL);
      text.mapped_ = {static_cast<const char*>(at), size};
    }
  }
  if (file >= 0) {
    ::close(file);
  }
  if (text.mapped_.empty() || text.mapped_.starts_with("\x1f\x8b")) {
    Result<std::string> unpacked = ReadTextFile(path);
    ALIDADE_RETURN_IF_ERROR(unpacked.status());
    MappedText whole;
    whole.unpacked_ = *std::move(unpacked);
    return whole;
  }
  return text;
}

MappedText::MappedText(MappedText&& other) noexcept
    : mapped_(std::exchange(other.mapped_, {})), unpacked_(std::move(other.unpacked_)) {}

MappedText::~MappedText() {
  if (!mapped_.empty()) {
    // The mapping was made of nothing constant.
    ::munmap(const_cast<char*>(mapped_.data()), mapped_.size());
  }
}

}  // namespace alidade
