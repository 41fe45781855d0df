#include "eval/files/hash.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

// RFC 1321, A.5.
TEST(HashOfFile, GivenThePublishedExampleWhenMd5IsAskedForThenItIsItsDigest) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(*HashOfFile(folder.Write("a", "message digest"), HashKind::kMd5),
            "f96b697d7cb7938d525a2f31aaf161d0");
  EXPECT_EQ(HashHex("message digest", HashKind::kMd5), "f96b697d7cb7938d525a2f31aaf161d0");
}

// FIPS 180-2, B.1.
TEST(HashOfFile, GivenThePublishedExampleWhenNoKindIsGivenThenItIsItsSha256) {
  const test::TemporaryFolder folder;
  const std::string digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  EXPECT_EQ(*HashOfFile(folder.Write("a", "abc")), digest);
  EXPECT_EQ(Sha256Hex("abc"), digest);
}

TEST(HashOfFile, GivenNoFileWhenHashedThenItIsAnInputError) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(HashOfFile(folder.File("absent")).status().code(), StatusCode::kInput);
}

}  // namespace
}  // namespace alidade
