#include "eval/download/expected_file.h"

#include <filesystem>

#include "eval/files/hash.h"

namespace alidade {
namespace {

Status Mismatch(const std::string& path, const std::string& what, const std::string& found,
                const std::string& expected) {
  return Status::Input(path + ": " + what + ": found " + found + ", expected " + expected);
}

}  // namespace

Status CheckFile(const std::string& path, const ExpectedFile& expected) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) {
    return Status::Input(path + ": " + error.message());
  }
  if (expected.bytes && bytes != *expected.bytes) {
    return Mismatch(path, "size", std::to_string(bytes) + " bytes", std::to_string(*expected.bytes));
  }
  if (!expected.sha256.empty()) {
    const Result<std::string> found = HashOfFile(path);
    ALIDADE_RETURN_IF_ERROR(found.status());
    if (*found != expected.sha256) {
      return Mismatch(path, "SHA-256", *found, expected.sha256);
    }
  }
  if (!expected.md5.empty()) {
    const Result<std::string> found = HashOfFile(path, HashKind::kMd5);
    ALIDADE_RETURN_IF_ERROR(found.status());
    if (*found != expected.md5) {
      return Mismatch(path, "MD5", *found, expected.md5);
    }
  }
  return Status::Ok();
}

}  // namespace alidade
