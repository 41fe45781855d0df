#include "gnss/formats/compact_rinex.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gnss/formats/rinex_text.h"
#include "tests/support/read_file.h"
#include "tests/support/shared_data.h"

namespace alidade {
namespace {

using test::HeaderLine;
using test::VersionLine;
using testing::HasSubstr;

std::string Head(const std::string& version, const std::string& rinex) {
  std::string first = version;
  first.resize(20, ' ');
  return HeaderLine(first + "COMPACT RINEX FORMAT", "CRINEX VERS   / TYPE") +
         HeaderLine("by hand", "CRINEX PROG / DATE") + rinex;
}

const std::string kRinex2 = VersionLine("2.11", "OBSERVATION DATA", "G") +
                            HeaderLine("     2    C1    L1", "# / TYPES OF OBSERV") +
                            HeaderLine("", "END OF HEADER");
const std::string kRinex3 = VersionLine("3.05", "OBSERVATION DATA", "G") +
                            HeaderLine("G    2 C1C L1C", "SYS / # / OBS TYPES") +
                            HeaderLine("", "END OF HEADER");

std::string Field14(double value) {
  return test::Value(value).substr(0, 14);
}

std::string Blanks(std::size_t count) {
  return std::string(count, ' ');
}

/// Three epochs worked out by hand after Hatanaka 2008: differences of order 3, a satellite that sets and one
/// that rises, a receiver clock, flags that change, an event.
TEST(CompactRinexTest, Version1ByHand) {
  const std::string packed = Head("1.0", kRinex2) + "&20  6 25  0  0  0.0000000  0  2G07G08\n" +
                             "3&100\n" +                       // receiver clock 0.000000100
                             "3&21000000000 3&-5000    4\n" +  // C1, L1 with strength 4
                             "3&22000000000\n" +               // L1 is missing
                             Blanks(16) + "3\n" +              // second 0 -> 30
                             "7\n" +                           // the clock's first difference
                             "1000 -2 1\n" +                   // first differences, loss of lock of C1
                             "-500 2&7\n" +                    // L1 appears
                             Blanks(17) + "1" + Blanks(13) + "1" + Blanks(3) + "&&&\n" +  // 31 s, G07 alone
                             "\n" +                                                       // no clock
                             "250 5\n" +  // second differences
                             "&" + Blanks(27) + "4  1\n" + HeaderLine("hello", "COMMENT") +
                             "&20  6 25  0  1  0.0000000  0  1G07\n\n3&23000000000 3&1\n";
  const std::string expected =
      kRinex2 + " 20  6 25  0  0  0.0000000  0  2G07G08" + Blanks(30) + " 0.000000100\n" + Field14(21000000) +
      "  " + Field14(-5) + " 4\n" + Field14(22000000) + "\n" + " 20  6 25  0  0 30.0000000  0  2G07G08" +
      Blanks(30) + " 0.000000107\n" + Field14(21000001) + "1 " + Field14(-5.002) + " 4\n" +
      Field14(21999999.5) + "  " + Field14(0.007) + "\n" + " 20  6 25  0  0 31.0000000  0  1G07\n" +
      Field14(21000002.25) + "1 " + Field14(-4.999) + " 4\n" + Blanks(28) + "4  1\n" +
      HeaderLine("hello", "COMMENT") + " 20  6 25  0  1  0.0000000  0  1G07\n" + Field14(23000000) + "  " +
      Field14(0.001) + "\n";
  const Result<std::string> text = DecodeCompactRinex("file", packed);
  ASSERT_TRUE(text.ok()) << text.message();
  EXPECT_EQ(*text, expected);
}

TEST(CompactRinexTest, DecodesAStationAsItsOwnDecoderDid) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::string folder = test::SharedDir() + "/data/gnss/rinex4_kms3/";
  const std::string packed = test::ReadFile(folder + "KMS300DNK_R_20221591000_01H_30S_MO.crx");
  ASSERT_TRUE(IsCompactRinex(packed));
  const Result<std::string> text = DecodeCompactRinex("file", packed);
  ASSERT_TRUE(text.ok()) << text.message();
  // Blanks at line ends aside.
  std::string expected;
  for (const char c : test::ReadFile(folder + "KMS3.rnx")) {
    while (c == '\n' && expected.ends_with(' ')) {
      expected.pop_back();
    }
    expected.push_back(c);
  }
  EXPECT_TRUE(*text == expected);
}

TEST(CompactRinexTest, FaultsNameTheLine) {
  const auto message = [](const std::string& text) { return DecodeCompactRinex("file", text).message(); };
  const std::string epoch = "> 2020 06 25 00 00 30.0000000  0  1      G07\n\n";
  EXPECT_THAT(message(Head("9.0", kRinex3)), HasSubstr("file:1: Compact RINEX version: found '9.0'"));
  EXPECT_THAT(message(Head("3.0", "x\n")), HasSubstr("no END OF HEADER"));
  EXPECT_THAT(message(Head("3.0", kRinex3) + "hello\n"),
              HasSubstr("file:6: found 'hello', expected the first epoch"));
  EXPECT_THAT(message(Head("3.0", kRinex3) + "> 2020 06 25 00 00 30.0000000  0 99      G07\n\n"),
              HasSubstr("announces 99 satellites"));
  EXPECT_THAT(message(Head("3.0", kRinex3) + epoch + "12345\n"), HasSubstr("file:8: G07: found '12345'"));
  EXPECT_THAT(message(Head("3.0", kRinex3) + epoch + "3&12x\n"), HasSubstr("'3&12x'"));
  EXPECT_THAT(message(Head("3.0", kRinex3) + epoch + "3&9223372036854775807\n\n\n9223372036854775807\n"),
              HasSubstr("expected a number or its difference"));
}

TEST(CompactRinexTest, ATornEndCostsTheLastEpochAlone) {
  const std::string epoch = "> 2020 06 25 00 00 30.0000000  0  1      G07\n\n3&21000000000 3&5000\n";
  const std::string next = "                      1\n\n1000 2\n";
  const Result<std::string> whole = DecodeCompactRinex("file", Head("3.0", kRinex3) + epoch + next);
  const Result<std::string> torn = DecodeCompactRinex(
      "file", (Head("3.0", kRinex3) + epoch + next)
                  .substr(0, Head("3.0", kRinex3).size() + epoch.size() + next.size() - 2));
  ASSERT_TRUE(whole.ok() && torn.ok());
  EXPECT_EQ(*torn, *DecodeCompactRinex("file", Head("3.0", kRinex3) + epoch));
  EXPECT_GT(whole->size(), torn->size());
}

}  // namespace
}  // namespace alidade
