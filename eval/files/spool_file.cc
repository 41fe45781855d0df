#include "eval/files/spool_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace alidade {
namespace {

Status Fault(const std::string& folder, const char* what) {
  return Status::Output(folder + ": " + what + ": " + std::strerror(errno));
}

}  // namespace

SpoolFile::~SpoolFile() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

Status SpoolFile::Open() {
#ifdef O_TMPFILE
  descriptor_ = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
#endif
  if (descriptor_ < 0) {  // not every file system has files without a name
    std::string name = folder_ + "/.alidade_XXXXXX";
    descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (descriptor_ >= 0) {
      ::unlink(name.c_str());
    }
  }
  return descriptor_ >= 0 ? Status::Ok() : Fault(folder_, "no temporary file can be made");
}

Status SpoolFile::Flush() {
  if (descriptor_ < 0) {
    ALIDADE_RETURN_IF_ERROR(Open());
  }
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t count = ::pwrite(descriptor_, rest.data(), rest.size(), static_cast<off_t>(written_));
    if (count < 0) {
      if (errno == EINTR) {
        continue;
      }
      return Fault(folder_, "a temporary file cannot be written");
    }
    written_ += static_cast<std::uint64_t>(count);
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
  buffer_.clear();
  return Status::Ok();
}

Status SpoolFile::Append(std::string_view bytes) {
  if (buffer_.size() + bytes.size() > kBuffer) {
    ALIDADE_RETURN_IF_ERROR(Flush());
  }
  buffer_.append(bytes);
  return Status::Ok();
}

Status SpoolFile::Read(std::uint64_t at, std::size_t count, std::string* bytes) const {
  bytes->resize(count);
  std::size_t done = 0;
  while (done < count && at + done < written_) {
    const std::size_t wanted =
        static_cast<std::size_t>(std::min<std::uint64_t>(count - done, written_ - at - done));
    const ssize_t got = ::pread(descriptor_, bytes->data() + done, wanted, static_cast<off_t>(at + done));
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got <= 0) {
      return Fault(folder_, "a temporary file cannot be read");
    }
    done += static_cast<std::size_t>(got);
  }
  if (done < count && at + done >= written_ && at + done < size()) {
    const std::string_view held = std::string_view(buffer_).substr(at + done - written_, count - done);
    std::copy(held.begin(), held.end(), bytes->begin() + static_cast<std::ptrdiff_t>(done));
    done += held.size();
  }
  bytes->resize(done);
  return Status::Ok();
}

std::string NearestFolder(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::path folder = fs::absolute(path.empty() ? "." : path, error);
  while (folder.has_relative_path() && !fs::is_directory(folder, error)) {
    folder = folder.parent_path();
  }
  return folder.string();
}

}  // namespace alidade
