#include "eval/files/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

// GIVEN a file of many blocks, with a byte order mark, CRLF, blank lines and no end of the last line, THEN
// every row is read whole and its line is right.
TEST(CsvReader, ReadsRowsOfAnyLengthAcrossBlocks) {
  const test::TemporaryFolder folder;
  std::string text = "\xEF\xBB\xBF\n \r\n#a,b\r\n";
  std::vector<std::string> wide;
  for (int i = 0; i < 5000; ++i) {
    wide.emplace_back(static_cast<size_t>(i % 300 == 7 ? 200'000 : i % 97), 'x');
    text += std::to_string(i) + ", " + wide.back() + (i % 2 == 0 ? "\n" : "\r\n\n");
  }
  text += "5000,y";
  wide.emplace_back("y");
  Result<CsvReader> csv = CsvReader::Open(folder.Write("t.csv", text));
  ASSERT_TRUE(csv.ok()) << csv.message();
  ASSERT_TRUE(csv->NextRow());
  EXPECT_TRUE(csv->ExpectHeader({{"a"}, {"b"}}).ok());
  EXPECT_EQ(csv->Place(), folder.File("t.csv") + ":3");
  for (int i = 0; i <= 5000; ++i) {
    ASSERT_TRUE(csv->NextRow()) << i;
    ASSERT_TRUE(csv->ExpectColumns(2).ok());
    std::int64_t number = -1;
    ASSERT_TRUE(csv->ReadInt64(0, "a", &number).ok());
    ASSERT_EQ(number, i);
    ASSERT_EQ(csv->field(1), wide[static_cast<size_t>(i)]);
  }
  EXPECT_EQ(csv->Place(), folder.File("t.csv") + ":" + std::to_string(3 + 5001 + 2500));
  EXPECT_FALSE(csv->NextRow());
  EXPECT_FALSE(csv->NextRow());
}

TEST(CsvReader, GivenARowWithoutEndThenItIsNeverHeldWhole) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write("t.csv", "a,b\n1,2\n" + std::string(3 << 20, '7') + "\n3,4\n");
  Result<CsvReader> csv = CsvReader::Open(path);
  ASSERT_TRUE(csv.ok()) << csv.message();
  ASSERT_TRUE(csv->NextRow());
  ASSERT_TRUE(csv->NextRow());
  EXPECT_TRUE(csv->ExpectColumns(2).ok());
  ASSERT_TRUE(csv->NextRow());  // the row that cannot be held
  std::int64_t number = 0;
  for (const Status& status :
       {csv->ExpectColumns(2), csv->ReadInt64(0, "a", &number), csv->ExpectHeader({{"a"}})}) {
    EXPECT_EQ(status.code(), StatusCode::kInput);
    EXPECT_THAT(status.message(), HasSubstr(path + ": is larger than expected: holds a row of more than"));
  }
  EXPECT_FALSE(csv->NextRow());
  EXPECT_THAT(CsvReader::Open(folder.Write("u.csv", std::string(3 << 20, '7'))).message(),
              HasSubstr("u.csv: is larger than expected: holds a row of more than"));
}

TEST(CsvReader, GivenBlanksAloneThenTheFileIsEmpty) {
  const test::TemporaryFolder folder;
  for (const std::string& text : {std::string(), std::string(" \t\r\n"), std::string(300'000, '\n')}) {
    EXPECT_THAT(CsvReader::Open(folder.Write("t.csv", text)).message(), HasSubstr("t.csv: is empty"));
  }
}

}  // namespace
}  // namespace alidade
