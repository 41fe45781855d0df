#include "gnss/formats/rinex_navigation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gnss/formats/rinex_text.h"
#include "tests/support/shared_data.h"

namespace alidade {
namespace {

using test::HeaderLine;
using test::Number19;
using test::VersionLine;
using testing::HasSubstr;

/// Numbers of a GPS message in the file's order; the clock's three are at the head.
std::vector<double> GpsNumbers() {
  return {-3.8749864e-4,
          -2.0463e-12,
          0,
          15,
          -19.8125,
          3.938e-9,
          -1.18947,
          -9.03e-7,
          9.9226e-3,
          1.144e-5,
          5153.627862930,
          266384,
          2.01e-7,
          2.94906,
          6.7e-8,
          0.980627,
          167.7,
          0.783951,
          -7.6846e-9,
          4.47876e-10,
          1,
          2108,
          0,
          2,
          0,
          5.122274e-9,
          15,
          259110,
          4,
          0,
          0};
}

/// A message: first line with three numbers behind `head`, then four a line behind `indent`.
std::string Message(const std::string& head, int indent, const std::vector<double>& numbers) {
  std::string text = head;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i >= 3 && (i - 3) % 4 == 0) {
      text += "\n" + std::string(static_cast<std::size_t>(indent), ' ');
    }
    text += Number19(numbers[i]);
  }
  return text + "\n";
}

std::string Header3() {
  return VersionLine("3.04", "N: GNSS NAV DATA", "M") +
         HeaderLine("GPSA   6.5193D-09  2.2352D-08 -5.9605D-08 -1.1921D-07", "IONOSPHERIC CORR") +
         HeaderLine("GPSB   8.6016D+04  9.8304D+04 -6.5536D+04 -5.2429D+05", "IONOSPHERIC CORR") +
         HeaderLine("BDSA   1.6519D-08  2.2352D-08 -5.9605D-08 -1.1921D-07", "IONOSPHERIC CORR") +
         HeaderLine("GAL    4.8250D+01 -1.1719D-02  7.5684D-03  0.0000D+00", "IONOSPHERIC CORR") +
         HeaderLine("    18", "LEAP SECONDS") + HeaderLine("", "END OF HEADER");
}

NavigationData Parse(const std::string& text) {
  Result<NavigationData> data = ParseRinexNavigation("file", text);
  EXPECT_TRUE(data.ok()) << data.message();
  return data.ok() ? *data : NavigationData();
}

const KeplerEphemeris& OnlyOf(const NavigationData& data, const char* satellite) {
  return data.kepler.at(*ParseSatellite(satellite)).at(0);
}

TEST(RinexNavigationTest, Version3GpsIsReadNumberByNumber) {
  const NavigationData data = Parse(Header3() + Message("G01 2020 06 03 01 59 44", 4, GpsNumbers()));
  EXPECT_EQ(data.ephemerides(), 1u);
  const KeplerEphemeris& e = OnlyOf(data, "G01");
  EXPECT_EQ(e.message, NavMessage::kLnav);
  EXPECT_EQ(e.toe_ns, GpsTimeFromWeek(TimeScale::kGps, 2108, 266'384 * kSecondNs));
  EXPECT_EQ(e.toc_ns, e.toe_ns);
  EXPECT_EQ(e.transmission_ns, GpsTimeFromWeek(TimeScale::kGps, 2108, 259'110 * kSecondNs));
  EXPECT_NEAR(e.af0, -3.8749864e-4, 1e-14);
  EXPECT_EQ(e.issue, 15);
  EXPECT_NEAR(e.crs, -19.8125, 1e-9);
  EXPECT_NEAR(e.sqrt_a, 5153.62786293, 1e-8);
  EXPECT_NEAR(e.omega0, 2.94906, 1e-9);
  EXPECT_NEAR(e.i0, 0.980627, 1e-9);
  EXPECT_NEAR(e.crc, 167.7, 1e-9);
  EXPECT_NEAR(e.omega_dot, -7.6846e-9, 1e-19);
  EXPECT_NEAR(e.i_dot, 4.47876e-10, 1e-19);
  EXPECT_NEAR(e.group_delay_s[0], 5.122274e-9, 1e-18);
  EXPECT_EQ(e.group_delay_s[1], 0) << "that number is the clock's issue";
  EXPECT_EQ(e.health, 0);
  EXPECT_NEAR(data.gps_ionosphere->alpha[0], 6.5193e-9, 1e-18);
  EXPECT_NEAR(data.gps_ionosphere->beta[3], -5.2429e5, 1e-6);
  EXPECT_NEAR(data.beidou_ionosphere->alpha[0], 1.6519e-8, 1e-18);
  EXPECT_NEAR((*data.galileo_ionosphere)[1], -1.1719e-2, 1e-12);
  EXPECT_EQ(*data.leap_seconds, 18);
}

TEST(RinexNavigationTest, TheWeekFollowsTheClocksDate) {
  std::vector<double> numbers = GpsNumbers();
  numbers[11] = 0;     // toe: beginning of the next week,
  numbers[21] = 2108;  // but the file names the week of transmission
  const NavigationData data = Parse(Header3() + Message("G01 2020 06 06 23 59 44", 4, numbers));
  EXPECT_EQ(OnlyOf(data, "G01").toe_ns, GpsTimeFromWeek(TimeScale::kGps, 2109, 0));
}

TEST(RinexNavigationTest, BeidouTimeAndBlankFields) {
  std::vector<double> numbers = GpsNumbers();
  numbers[10] = 6493.3369;
  numbers[11] = 262'800;
  numbers[26] = -1.02e-8;
  std::string text = Message("C01 2020 06 03 01 00 00", 4, numbers);
  // The spare after IDOT is blank in BeiDou files.
  const std::size_t spare = text.find(Number19(4.47876e-10)) + 19;
  text.replace(spare, 19, std::string(19, ' '));
  const KeplerEphemeris e = OnlyOf(Parse(Header3() + text), "C01");
  EXPECT_EQ(e.message, NavMessage::kD2);
  EXPECT_EQ(e.toe_ns, GpsTimeFromWeek(TimeScale::kBeidou, 752, 262'800 * kSecondNs));
  EXPECT_EQ(e.toc_ns, e.toe_ns);
  EXPECT_NEAR(e.group_delay_s[1], -1.02e-8, 1e-17);
  EXPECT_EQ(OnlyOf(Parse(Header3() + Message("C11 2020 06 03 01 00 00", 4, numbers)), "C11").message,
            NavMessage::kD1);
}

TEST(RinexNavigationTest, GalileoMessagesAreDistinguishedByTheDataSource) {
  std::vector<double> numbers = GpsNumbers();
  numbers[10] = 5440.6;
  for (const auto& [source, message] : {std::pair{258, NavMessage::kFnav}, std::pair{517, NavMessage::kInav},
                                        std::pair{513, NavMessage::kInav}, std::pair{0, NavMessage::kInav}}) {
    numbers[20] = source;
    EXPECT_EQ(OnlyOf(Parse(Header3() + Message("E01 2020 06 03 01 59 44", 4, numbers)), "E01").message,
              message)
        << source;
  }
  numbers[23] = -1;
  EXPECT_GT(OnlyOf(Parse(Header3() + Message("E01 2020 06 03 01 59 44", 4, numbers)), "E01").accuracy_m, 1000)
      << "no accuracy prediction";
}

std::vector<double> GlonassNumbers() {
  return {6.25e-5, 9.1e-13, 264'630, 8498.656,  -1.179,  -1.86e-9, 0, 19647.59,
          -1.494,  0,       1,       -13877.68, -2.8346, 1.86e-9,  0};
}

TEST(RinexNavigationTest, GlonassIsInUtcAndKilometres) {
  const NavigationData data = Parse(Header3() + Message("R01 2020 06 03 01 45 00", 4, GlonassNumbers()));
  const GlonassEphemeris& e = data.glonass.at(1).at(0);
  EXPECT_EQ(e.toe_ns, GpsTimeFromWeek(TimeScale::kGps, 2108, (266'400 - 900 + 18) * kSecondNs));
  EXPECT_NEAR(e.position_m.x(), 8498656, 1e-3);
  EXPECT_NEAR(e.velocity_mps.z(), -2834.6, 1e-6);
  EXPECT_NEAR(e.acceleration_mps2.z(), 1.86e-6, 1e-15);
  EXPECT_NEAR(e.clock_drift, 9.1e-13, 1e-22);
  EXPECT_EQ(e.channel, 1);
  EXPECT_FALSE(e.l2_delay_s.has_value());
  std::vector<double> longer = GlonassNumbers();
  longer.insert(longer.end(), {183, -2.79e-9, 3, 0});
  EXPECT_NEAR(*Parse(Header3() + Message("R01 2020 06 03 01 45 00", 4, longer)).glonass.at(1)[0].l2_delay_s,
              -2.79e-9, 1e-18);
}

TEST(RinexNavigationTest, Version2FilesAreDistinguishedByTheirType) {
  const std::string gps = VersionLine("2.11", "N: GPS NAV DATA", "") +
                          HeaderLine("     .1118D-07   .2235D-07  -.4172D-06   .6557D-06", "ION ALPHA") +
                          HeaderLine("     .1372D+06   .2105D+06  -.2228D+06  -.4653D+06", "ION BETA") +
                          HeaderLine("", "END OF HEADER") +
                          Message(" 7 20  6  3  1 59 44.0", 3, GpsNumbers());
  const NavigationData data = Parse(gps);
  EXPECT_EQ(OnlyOf(data, "G07").toe_ns, GpsTimeFromWeek(TimeScale::kGps, 2108, 266'384 * kSecondNs));
  EXPECT_NEAR(data.gps_ionosphere->alpha[0], 0.1118e-7, 1e-16);
  EXPECT_NEAR(data.gps_ionosphere->beta[3], -0.4653e6, 1e-6);
  const std::string glonass = VersionLine("2.11", "GLONASS NAV DATA", "") + HeaderLine("", "END OF HEADER") +
                              Message(" 1 20  6  3  1 45  0.0", 3, GlonassNumbers());
  EXPECT_EQ(Parse(glonass).glonass.at(1).size(), 1u);
}

TEST(RinexNavigationTest, Version4FramesNameTheirMessages) {
  const std::string text = VersionLine("4.00", "NAVIGATION DATA", "M") + HeaderLine("", "END OF HEADER") +
                           "> EPH G01 LNAV\n" + Message("G01 2020 06 03 01 59 44", 4, GpsNumbers()) +
                           "> EPH G01 CNAV\n" + Message("G01 2020 06 03 01 59 44", 4, GpsNumbers()) +
                           "> EPH R01 FDMA\n" + Message("R01 2020 06 03 01 45 00", 4, GlonassNumbers()) +
                           "> EPH C11 D2\n" + Message("C11 2020 06 03 01 00 00", 4, GpsNumbers()) +
                           "> ION G01 LNAV\n    2020 06 03 00 00 00" + Number19(1) + Number19(2) +
                           Number19(3) + "\n    " + Number19(4) + Number19(5) + Number19(6) + Number19(7) +
                           "\n    " + Number19(8) + "\n> EOP G01 CNVX\n    1\n";
  const NavigationData data = Parse(text);
  EXPECT_EQ(data.kepler.at(*ParseSatellite("G01")).size(), 1u);
  EXPECT_EQ(data.passed_over, 2);
  EXPECT_EQ(data.glonass.at(1).size(), 1u);
  EXPECT_EQ(OnlyOf(data, "C11").message, NavMessage::kD2);
  EXPECT_EQ(data.gps_ionosphere->alpha[3], 4);
  EXPECT_EQ(data.gps_ionosphere->beta[0], 5);
  EXPECT_EQ(data.warnings.count, 0);
}

TEST(RinexNavigationTest, BadMessagesAreSkippedAndReported) {
  const std::string good = Message("G02 2020 06 03 01 59 44", 4, GpsNumbers());
  const auto with = [](std::size_t i, double value) {
    std::vector<double> numbers = GpsNumbers();
    numbers[i] = value;
    return Message("G01 2020 06 03 01 59 44", 4, numbers);
  };
  std::vector<double> few = GpsNumbers();
  few.resize(19);
  std::string letters = good;
  letters.replace(letters.find("E-09"), 4, "EX09");
  std::vector<double> low = GlonassNumbers();
  low[3] = low[7] = low[11] = 1000;
  const std::vector<std::pair<std::string, const char*>> cases = {
      {with(8, 0.9), "G01: eccentricity: found 0.9, expected 0 to 0.5"},
      {with(10, 1e9), "square root of the semi-major axis: found 1e+09"},
      {with(11, 1e6), "time of ephemeris: found 1e+06"},
      {Message("G01 2020 06 03 01 59 44", 4, few), "holds 19 numbers"},
      {Message("G01 2020 06 33 01 59 44", 4, GpsNumbers()), "epoch: found 2020-6-33"},
      {letters, "expected a number"},
      {Message("Q01 2020 06 03 01 59 44", 4, GpsNumbers()), "satellite: found 'Q01'"},
      {Message("R01 2020 06 03 01 45 00", 4, low), "from the Earth's centre"}};
  for (const auto& [text, warning] : cases) {
    const NavigationData data = Parse(Header3() + text + good);
    EXPECT_EQ(data.ephemerides(), 1u) << warning;
    ASSERT_FALSE(data.warnings.first.empty()) << warning;
    EXPECT_THAT(data.warnings.first[0], HasSubstr(warning));
    EXPECT_THAT(data.warnings.first[0], HasSubstr("file:8: ")) << warning;
  }
}

TEST(RinexNavigationTest, FilesThatCannotServeAreErrors) {
  const auto message = [](const std::string& text) { return ParseRinexNavigation("file", text).message(); };
  EXPECT_THAT(message(""), HasSubstr("is empty"));
  EXPECT_THAT(message("x\n"), HasSubstr("file:1: found 'x', expected RINEX VERSION / TYPE"));
  EXPECT_THAT(message(VersionLine("3.04", "OBSERVATION DATA", "M")), HasSubstr("expected NAVIGATION DATA"));
  EXPECT_THAT(message(VersionLine("1.00", "N", "")), HasSubstr("RINEX version: found 1.00"));
  EXPECT_THAT(message(Header3()), HasSubstr("holds no ephemeris"));
}

TEST(RinexNavigationTest, MergingFilesKeepsEachEphemerisOnce) {
  const NavigationData one = Parse(Header3() + Message("G01 2020 06 03 01 59 44", 4, GpsNumbers()));
  NavigationData both = one;
  both.Merge(one);
  EXPECT_EQ(both.ephemerides(), 1u);
  both.Merge(Parse(Header3() + Message("G02 2020 06 03 01 59 44", 4, GpsNumbers())));
  EXPECT_EQ(both.ephemerides(), 2u);
}

TEST(RinexNavigationTest, RealFilesAreReadWhole) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::string folder = test::SharedDir() + "/data/gnss/";
  struct Case {
    const char* path;
    std::size_t ephemerides;
    std::int64_t passed_over;
  };
  // Counts of lines that begin a message: grep -c '^[GRECJ][0-9]', and of those of SBAS and RINEX 4's other
  // kinds.
  for (const Case& real : {Case{"static_esbc/ESBC00DNK_R_20201770000_01D_MN.rnx", 2741, 2130},
                           Case{"urban_static_tst2/hksc155c.20b", 44, 0},
                           Case{"phone_xiaomi/HERT00GBR_R_20240920000_01D_GN.rnx", 231, 0},
                           Case{"rinex4_kms3/KMS300DNK_R_20221591000_01H_MN.rnx", 199, 161},
                           Case{"precise_cod/brdc1180.21n", 0, 0}}) {
    const Result<NavigationData> data = ReadRinexNavigation(folder + real.path);
    ASSERT_TRUE(data.ok()) << data.message();
    EXPECT_EQ(data->warnings.count, 0) << real.path;
    EXPECT_EQ(data->passed_over, real.passed_over) << real.path;
    if (real.ephemerides > 0) {
      EXPECT_EQ(data->ephemerides(), real.ephemerides) << real.path;
    }
    EXPECT_TRUE(data->gps_ionosphere || data->beidou_ionosphere) << real.path;
  }
}

}  // namespace
}  // namespace alidade
