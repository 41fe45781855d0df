#include "eval/files/table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

struct Line {
  int number = 0;
  std::string text;
};

void Encode(const Line& line, ByteWriter* bytes) {
  bytes->Write(line.number);
  bytes->Block(line.text);
}

void Decode(ByteReader* bytes, Line* line) {
  line->number = bytes->Read<int>();
  line->text = bytes->Block();
}

/// Longer than a block of a pass now and then.
Line LineOf(int number) {
  return {number, std::string(number % 500 == 499 ? 400'000 : static_cast<size_t>(number % 900), 'x')};
}

// GIVEN rows of several buffers, some larger than a block, THEN every pass gives them all, in order, also
// after more were added, and no file stays in the folder.
TEST(Table, GivesEveryRowOfAFileOnEveryPass) {
  const test::TemporaryFolder folder;
  Table<Line> table = Table<Line>::InFile(folder.path());
  EXPECT_TRUE(table.empty());
  for (const int count : {1, 3000, 6000}) {
    for (int i = static_cast<int>(table.size()); i < count; ++i) {
      ASSERT_TRUE(table.Add(LineOf(i)).ok());
    }
    int next = 0;
    ASSERT_TRUE(table
                    .ForEach([&next](const Line& line) {
                      ASSERT_EQ(line.number, next);
                      ASSERT_EQ(line.text, LineOf(next).text);
                      ++next;
                    })
                    .ok());
    EXPECT_EQ(next, count);
    EXPECT_EQ(table.size(), static_cast<size_t>(count));
    EXPECT_EQ(table.front().number, 0);
    EXPECT_EQ(table.back().number, count - 1);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Table, OfRowsInMemoryIsAView) {
  const std::vector<Line> lines = {LineOf(1), LineOf(2)};
  const Table<Line> table(lines);
  Table<Line>::Pass pass(table);
  EXPECT_EQ(*pass.Next(), &lines[0]);
  EXPECT_EQ(*pass.Next(), &lines[1]);
  EXPECT_EQ(*pass.Next(), nullptr);
  EXPECT_EQ(&table.back(), &lines[1]);
  EXPECT_EQ(*Table<Line>::Pass(Table<Line>()).Next(), nullptr);
}

TEST(SpoolFile, GivenAFolderThatIsNotThereThenLittleIsKeptAndMuchIsRefused) {
  const test::TemporaryFolder folder;
  SpoolFile file(folder.File("none"));
  EXPECT_TRUE(file.Append("little").ok());
  std::string bytes;
  ASSERT_TRUE(file.Read(2, 100, &bytes).ok());
  EXPECT_EQ(bytes, "ttle");
  const Status status = file.Append(std::string(SpoolFile::kBuffer, 'x'));
  EXPECT_EQ(status.code(), StatusCode::kOutput);
  EXPECT_THAT(status.message(),
              testing::HasSubstr(folder.File("none") + ": no temporary file can be made: "));
}

TEST(SpoolFile, NearestFolderIsTheFirstThatExists) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(NearestFolder(folder.File("a/b/c")), folder.path());
  EXPECT_EQ(NearestFolder(folder.path()), folder.path());
  folder.Write("file", "");
  EXPECT_EQ(NearestFolder(folder.File("file/x")), folder.path());
  EXPECT_EQ(NearestFolder("not_there"), std::filesystem::current_path());
}

}  // namespace
}  // namespace alidade
