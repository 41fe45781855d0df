#include "gnss/base/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

std::string Gzip(const test::TemporaryFolder& folder, const std::string& text) {
  std::string path = folder.File("text.gz");
  gzFile file = gzopen(path.c_str(), "wb");
  EXPECT_EQ(gzwrite(file, text.data(), static_cast<unsigned>(text.size())), static_cast<int>(text.size()));
  gzclose(file);
  return path;
}

TEST(TextFileTest, PlainAndGzipAreReadAlike) {
  const test::TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 100'000; ++i) {
    text += std::to_string(i) + " line\n";
  }
  EXPECT_EQ(ReadTextFile(folder.Write("plain", text)).value(), text);
  EXPECT_EQ(ReadTextFile(Gzip(folder, text)).value(), text);
}

TEST(TextFileTest, FaultsNameThePath) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(ReadTextFile(folder.File("none")).message(), HasSubstr("none: cannot be read"));
  EXPECT_THAT(ReadTextFile(folder.path()).message(), HasSubstr("is a folder"));
  std::string text;
  for (int i = 0; i < 10'000; ++i) {
    text += std::to_string(i * 7919) + "\n";
  }
  const std::string path = Gzip(folder, text);
  const std::string packed = ReadTextFile(path).ok() ? "ok" : "";
  EXPECT_EQ(packed, "ok");
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  EXPECT_THAT(ReadTextFile(path).message(), HasSubstr("text.gz: cannot be unpacked"));
}

TEST(TextFileTest, LinesEndInAnyWay) {
  LineReader lines("file", "\xEF\xBB\xBFone\r\ntwo  \n\nfour");
  ASSERT_TRUE(lines.Next());
  EXPECT_EQ(lines.line(), "one");
  ASSERT_TRUE(lines.Next());
  EXPECT_EQ(lines.line(), "two  ");
  EXPECT_EQ(lines.trimmed(), "two");
  lines.PutBack();
  ASSERT_TRUE(lines.Next());
  EXPECT_EQ(lines.number(), 2);
  ASSERT_TRUE(lines.Next());
  ASSERT_TRUE(lines.Next());
  EXPECT_EQ(lines.line(), "four");
  EXPECT_EQ(lines.Fault("x").message(), "file:4: x");
  EXPECT_FALSE(lines.Next());
}

TEST(TextFileTest, NumbersAreWhole) {
  EXPECT_DOUBLE_EQ(*ParseReal("-1.234D-04"), -1.234e-4);
  EXPECT_DOUBLE_EQ(*ParseReal("+1.5e3"), 1500);
  EXPECT_DOUBLE_EQ(*ParseReal(".5d0"), 0.5);
  EXPECT_DOUBLE_EQ(*ParseReal("1D-400"), 0);
  for (const char* bad : {"", "1.5x", "nan", "inf", "-inf", "1e999", "--1", "1 2", "+"}) {
    EXPECT_FALSE(ParseReal(bad).has_value()) << bad;
  }
  EXPECT_EQ(*ParseInteger("+12"), 12);
  for (const char* bad : {"", "1.0", "99999999999", "1x"}) {
    EXPECT_FALSE(ParseInteger(bad).has_value()) << bad;
  }
}

TEST(TextFileTest, SecondsKeepTheirDigits) {
  CalendarTime time;
  ASSERT_TRUE(ParseSeconds("16.4427602", &time));
  EXPECT_EQ(time.second, 16);
  EXPECT_EQ(time.nanoseconds, 442'760'200);
  ASSERT_TRUE(ParseSeconds("5", &time));
  EXPECT_EQ(time.nanoseconds, 0);
  ASSERT_TRUE(ParseSeconds("0.1234567899", &time));
  EXPECT_EQ(time.nanoseconds, 123'456'789);
  for (const char* bad : {"", "61", "-1.0", "1.-5", "x"}) {
    EXPECT_FALSE(ParseSeconds(bad, &time)) << bad;
  }
}

TEST(TextFileTest, TwoDigitYearsSpanACentury) {
  EXPECT_EQ(ParseCalendar("80 1 6 0 0 0.0")->year, 1980);
  EXPECT_EQ(ParseCalendar("20 1 6 0 0 0.0")->year, 2020);
  EXPECT_THAT(ParseCalendar("20 x 6 0 0 0.0").message(), HasSubstr("month: found 'x'"));
  EXPECT_THAT(ParseCalendar("20 1 6 0 0").message(), HasSubstr("second: found ''"));
}

TEST(TextFileTest, WarningsAreCountedAndKeptFew) {
  ReaderWarnings warnings;
  for (int i = 0; i < 1000; ++i) {
    warnings.Add(Status::Input("fault " + std::to_string(i)));
  }
  EXPECT_EQ(warnings.count, 1000);
  EXPECT_EQ(warnings.first.size(), ReaderWarnings::kKept);
  EXPECT_EQ(warnings.Nothing("f", "epoch").message(), "f: holds no epoch; first fault: fault 0");
}

}  // namespace
}  // namespace alidade
