#include "eval/download/catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

constexpr const char* kCatalogue = R"(datasets:
  - name: walk
    title: a walk
    page: https://example.org/walk
    base: https://example.org/files/
    files:
      - {name: one, file: one.bag, path: a/one.bag, bytes: 12, md5: 009b52e7d7b224ffb8a203db294ac9fb}
      - {name: two, file: two.bag, path: a/two.bag}
  - name: page_only
    title: a page
    page: https://example.org/page
)";

TEST(Catalogue, GivenTheShippedOneThenItIsReadAndHoldsTheSetsOfThePage) {
  const auto catalogue = ReadCatalogue(ALIDADE_SOURCE_DIR "/configs/data/catalogue.yaml");
  ASSERT_TRUE(catalogue.ok()) << catalogue.message();
  for (const char* name : {"euroc", "tumvi", "gvins", "uzh_fpv", "4seasons", "kaist_urban", "urbannav",
                           "m2dgr", "hilti", "tartanair"}) {
    EXPECT_TRUE(ChooseFiles(*catalogue, name).ok()) << name;
  }
  const auto room = ChooseFiles(*catalogue, "tumvi/room1");
  ASSERT_TRUE(room.ok());
  EXPECT_EQ(room->files[0]->expected.bytes, 1707110400U);
}

TEST(Catalogue, GivenANameThenItsFilesAreChosen) {
  const test::TemporaryFolder folder;
  const auto catalogue = ReadCatalogue(folder.Write("c.yaml", kCatalogue));
  ASSERT_TRUE(catalogue.ok()) << catalogue.message();
  EXPECT_EQ(ChooseFiles(*catalogue, "walk")->files.size(), 2U);
  EXPECT_EQ(ChooseFiles(*catalogue, "walk/two")->files[0]->file, "two.bag");
  EXPECT_TRUE(ChooseFiles(*catalogue, "page_only")->files.empty());
  EXPECT_THAT(ChooseFiles(*catalogue, "wolk").message(), HasSubstr("did you mean 'walk'"));
  EXPECT_THAT(ChooseFiles(*catalogue, "walk/tow").message(), HasSubstr("did you mean 'two'"));
}

TEST(Catalogue, GivenAFaultThenPlaceAndExpectationAreNamed) {
  const test::TemporaryFolder folder;
  const auto message = [&](const std::string& from, const std::string& to) {
    std::string text = kCatalogue;
    text.replace(text.find(from), from.size(), to);
    return std::string(ReadCatalogue(folder.Write("c.yaml", text)).message());
  };
  EXPECT_THAT(message("title", "tittle"), HasSubstr("c.yaml:3:5: tittle: unknown key"));
  EXPECT_THAT(message("bytes: 12", "bytes: -1"), HasSubstr("a whole number of bytes"));
  EXPECT_THAT(message("009b52e7d7b224ff", "009B"), HasSubstr("32 lower-case hexadecimal digits"));
  EXPECT_THAT(message("file: one.bag", "file: ../one.bag"), HasSubstr("letters, digits"));
  EXPECT_THAT(message("name: two", "name: one"), HasSubstr("used twice"));
  EXPECT_THAT(message("name: page_only", "name: walk"), HasSubstr("used twice"));
  EXPECT_THAT(message("base: https", "base: ftp"), HasSubstr("http:// or https://"));
  EXPECT_THAT(message("page: https://example.org/walk", "size: 1 GB"), HasSubstr("name, title and page"));
}

}  // namespace
}  // namespace alidade
