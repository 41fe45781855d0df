#include "eval/files/md5.h"

#include <openssl/evp.h>

#include <fstream>
#include <memory>
#include <vector>

#include "core/check.h"
#include "core/format.h"

namespace alidade {

Result<std::string> Md5OfFile(const std::string& path) {
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
  CHECK(context != nullptr && EVP_DigestInit_ex(context.get(), EVP_md5(), nullptr) == 1);
  std::ifstream file(path, std::ios::binary);
  std::vector<char> piece(std::size_t{1} << 20);
  while (file) {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    CHECK_EQ(EVP_DigestUpdate(context.get(), piece.data(), static_cast<std::size_t>(file.gcount())), 1);
  }
  if (!file.eof()) {
    return Status::Input(path + ": cannot be read");
  }
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  CHECK_EQ(EVP_DigestFinal_ex(context.get(), digest, &size), 1);
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    text += Format("%02x", static_cast<unsigned>(digest[i]));
  }
  return text;
}

}  // namespace alidade
