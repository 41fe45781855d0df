#include "eval/files/hash.h"

#include <openssl/evp.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

#include "core/check.h"
#include "core/regular_file.h"

namespace alidade {

struct Hash::Context {
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> handle{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
};

Hash::Hash(HashKind kind) : context_(std::make_unique<Context>()) {
  const EVP_MD* function = kind == HashKind::kMd5 ? EVP_md5() : EVP_sha256();
  CHECK(context_->handle != nullptr && EVP_DigestInit_ex(context_->handle.get(), function, nullptr) == 1);
}

Hash::~Hash() = default;

void Hash::Add(std::string_view bytes) {
  CHECK_EQ(EVP_DigestUpdate(context_->handle.get(), bytes.data(), bytes.size()), 1);
}

std::string Hash::Hex() {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  CHECK_EQ(EVP_DigestFinal_ex(context_->handle.get(), digest, &size), 1);
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    text.push_back(kDigits[digest[i] >> 4]);
    text.push_back(kDigits[digest[i] & 15]);
  }
  return text;
}

std::string HashHex(std::string_view bytes, HashKind kind) {
  Hash hash(kind);
  hash.Add(bytes);
  return hash.Hex();
}

std::string Sha256Hex(std::string_view bytes) {
  return HashHex(bytes, HashKind::kSha256);
}

namespace {

/// Piece by piece: a bag may be larger than memory.
Status AddFile(const std::string& path, Hash* hash) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> piece(std::size_t{1} << 20);
  while (file) {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    hash->Add({piece.data(), static_cast<std::size_t>(file.gcount())});
  }
  return file.eof() ? Status::Ok() : Status::Input(path + ": cannot be read");
}

}  // namespace

Result<std::string> HashOfFile(const std::string& path, HashKind kind) {
  Hash hash(kind);
  ALIDADE_RETURN_IF_ERROR(AddFile(path, &hash));
  return hash.Hex();
}

Result<std::string> DigestOfFolder(const std::string& folder) {
  namespace fs = std::filesystem;
  std::vector<std::string> names;
  std::error_code error;
  if (fs::is_regular_file(folder, error)) {
    return HashOfFile(folder);
  }
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->is_regular_file(error)) {
      names.push_back(fs::path(it->path()).lexically_relative(folder).generic_string());
    }
  }
  if (error) {
    return Status::Input(folder + ": " + error.message() + ", expected a folder that can be read");
  }
  std::sort(names.begin(), names.end());
  Hash hash;
  for (const std::string& name : names) {
    const std::string path = (fs::path(folder) / name).string();
    const Result<std::uintmax_t> size = RegularFileSize(path);
    ALIDADE_RETURN_IF_ERROR(size.status());
    // Lengths keep a name from running into a content.
    hash.Add(std::to_string(name.size()) + ":" + name + std::to_string(*size) + ":");
    ALIDADE_RETURN_IF_ERROR(AddFile(path, &hash));
  }
  return hash.Hex();
}

}  // namespace alidade
