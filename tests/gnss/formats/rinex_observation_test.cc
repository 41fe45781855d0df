#include "gnss/formats/rinex_observation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>

#include "core/format.h"
#include "tests/gnss/formats/rinex_text.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::HeaderLine;
using test::Value;
using test::VersionLine;
using testing::HasSubstr;

const std::string kHeader3 =
    VersionLine("3.05", "OBSERVATION DATA", "M") + HeaderLine("TEST", "MARKER NAME") +
    HeaderLine("  3582105.2910   532589.7313  5232754.8054", "APPROX POSITION XYZ") +
    HeaderLine("        0.2160        0.0000        0.0000", "ANTENNA: DELTA H/E/N") +
    HeaderLine("G    4 C1C L1C D1C S1C", "SYS / # / OBS TYPES") +
    HeaderLine("C    3 C2I", "SYS / # / OBS TYPES") + HeaderLine("       D2I S2I", "SYS / # / OBS TYPES") +
    HeaderLine("  2020     6    25     0     0    0.0000000     GPS", "TIME OF FIRST OBS") +
    HeaderLine("  2 R01  1 R02 -4", "GLONASS SLOT / FRQ #") + HeaderLine("    18", "LEAP SECONDS") +
    HeaderLine("", "END OF HEADER");

std::string Satellite(const std::string& name, double range) {
  return name + Value(range) + Value(1e8) + Value(-2000.5) + Value(45) + "\n";
}

const SignalObservation& Only(const SatelliteObservation& satellite) {
  EXPECT_EQ(satellite.signals.size(), 1u);
  return satellite.signals.at(0);
}

ObservationFile Parse(const std::string& text) {
  Result<ObservationFile> file = ParseRinexObservation("file", text);
  EXPECT_TRUE(file.ok()) << file.message();
  return file.ok() ? *file : ObservationFile();
}

TEST(RinexObservationTest, Version3IsReadByItsColumns) {
  const ObservationFile file =
      Parse(kHeader3 + "> 2020 06 25 00 00 30.0000000  0  2\n" + Satellite("G07", 2.1e7) + "C08" +
            Value(3.8e7) + Value(0) + Value(40.5) + "\n");
  EXPECT_EQ(file.marker, "TEST");
  EXPECT_DOUBLE_EQ(file.approximate_position_E->x(), 3582105.2910);
  EXPECT_DOUBLE_EQ(file.antenna_delta_hen.x(), 0.216);
  EXPECT_EQ(file.glonass_channels.at(2), -4);
  EXPECT_EQ(file.warnings.count, 0);
  ASSERT_EQ(file.epochs.size(), 1u);
  EXPECT_EQ(file.epochs[0].stamp_ns, GpsTimeFromWeek(TimeScale::kGps, 2111, 345'630 * kSecondNs));
  const SatelliteObservation& gps = file.epochs[0].satellites.at(0);
  EXPECT_EQ(ToString(gps.satellite), "G07");
  EXPECT_DOUBLE_EQ(*Only(gps).pseudorange_m, 2.1e7);
  EXPECT_DOUBLE_EQ(*Only(gps).doppler_hz, -2000.5);
  EXPECT_DOUBLE_EQ(*Only(gps).cn0_dbhz, 45);
  const SignalObservation& beidou = Only(file.epochs[0].satellites.at(1));
  EXPECT_EQ(ToString(beidou.signal), "2I");
  EXPECT_FALSE(beidou.doppler_hz.has_value()) << "zero means missing";
}

TEST(RinexObservationTest, LineEndsAndBlanksDoNotMatter) {
  std::string text = kHeader3 + "> 2020 06 25 00 00 30.0000000  0  1\n" + Satellite("G 7", 2.1e7);
  std::string dos;
  for (const char c : text) {
    dos += c == '\n' ? "\r\n" : std::string(1, c);
  }
  EXPECT_EQ(Parse(dos).epochs.at(0).satellites.at(0).satellite, (SatelliteId{GnssSystem::kGps, 7}));
}

TEST(RinexObservationTest, EventRecordsArePassedOverAndObeyed) {
  const ObservationFile file =
      Parse(kHeader3 + "> 2020 06 25 00 00 00.0000000  2  0\n" + "> 2020 06 25 00 00 30.0000000  0  1\n" +
            Satellite("G07", 2.1e7) + ">                              4  1\n" +
            HeaderLine("G    1 C5Q", "SYS / # / OBS TYPES") + "> 2020 06 25 00 01 00.0000000  0  1\nG07" +
            Value(2.2e7) + "\n");
  EXPECT_EQ(file.events, 2);
  ASSERT_EQ(file.epochs.size(), 2u);
  EXPECT_EQ(ToString(Only(file.epochs[1].satellites.at(0)).signal), "5Q");
  EXPECT_EQ(file.warnings.count, 0);
}

TEST(RinexObservationTest, ScaleFactorsDivide) {
  std::string header = kHeader3;
  header.insert(header.find(HeaderLine("", "END OF HEADER")),
                HeaderLine("G  100  1 D1C", "SYS / SCALE FACTOR"));
  const ObservationFile file =
      Parse(header + "> 2020 06 25 00 00 30.0000000  0  1\n" + Satellite("G07", 2.1e7));
  EXPECT_DOUBLE_EQ(*Only(file.epochs.at(0).satellites.at(0)).doppler_hz, -20.005);
  EXPECT_DOUBLE_EQ(*Only(file.epochs.at(0).satellites.at(0)).pseudorange_m, 2.1e7);
}

TEST(RinexObservationTest, TimeSystemOfTheHeaderIsObeyed) {
  std::string header = kHeader3;
  header.replace(header.find("GPS         TIME"), 3, "GLO");
  const ObservationFile file =
      Parse(header + "> 2020 06 25 00 00 12.0000000  0  1\n" + Satellite("G07", 2.1e7));
  EXPECT_EQ(file.epochs.at(0).stamp_ns, GpsTimeFromWeek(TimeScale::kGps, 2111, 345'630 * kSecondNs));
}

TEST(RinexObservationTest, DamageCostsOneRecordAndIsReported) {
  const std::string good = "> 2020 06 25 00 00 30.0000000  0  1\n" + Satellite("G07", 2.1e7);
  const std::string later = "> 2020 06 25 00 01 00.0000000  0  1\n" + Satellite("G07", 2.2e7);
  struct Case {
    const char* name;
    std::string between;
    const char* warning;
  };
  const std::vector<Case> cases = {
      {"fewer satellites than announced", "> 2020 06 25 00 00 40.0000000  0  3\n" + Satellite("G07", 2.1e7),
       "holds 1 satellites, its epoch line states 3"},
      {"more than announced", Satellite("G08", 2.1e7), "expected an epoch that begins with '>'"},
      {"date", "> 2020 06 31 00 00 40.0000000  0  1\n" + Satellite("G07", 2.1e7), "expected a date"},
      {"count", "> 2020 06 25 00 00 40.0000000  0 xx\n" + Satellite("G07", 2.1e7),
       "a flag of 0 to 6 and a count"},
      {"flag", "> 2020 06 25 00 00 40.0000000  9  1\n" + Satellite("G07", 2.1e7), "a flag of 0 to 6"},
      {"back in time", good, "not later than the previous one"},
      {"satellite", "> 2020 06 25 00 00 40.0000000  0  1\n" + Satellite("Q07", 2.1e7),
       "satellite: found 'Q07'"},
      {"number", "> 2020 06 25 00 00 40.0000000  0  1\nG07  21x00000.000\n", "'21x00000.000'"},
      {"cut number", "> 2020 06 25 00 00 40.0000000  0  1\nG07  21000000.0\n",
       "expected a number of width 14"},
      {"twice", "> 2020 06 25 00 00 40.0000000  0  2\n" + Satellite("G07", 2.1e7) + Satellite("G07", 2.3e7),
       "occurs twice"}};
  for (const Case& damage : cases) {
    const ObservationFile file = Parse(kHeader3 + good + damage.between + later);
    EXPECT_EQ(file.warnings.count, 1) << damage.name;
    ASSERT_FALSE(file.warnings.first.empty()) << damage.name;
    EXPECT_THAT(file.warnings.first[0], HasSubstr(damage.warning)) << damage.name;
    EXPECT_THAT(file.warnings.first[0], HasSubstr("file:1")) << damage.name;
    ASSERT_GE(file.epochs.size(), 2u) << damage.name;
    EXPECT_DOUBLE_EQ(*Only(file.epochs.back().satellites.at(0)).pseudorange_m, 2.2e7) << damage.name;
  }
  const ObservationFile torn =
      Parse(kHeader3 + good + "> 2020 06 25 00 01 00.0000000  0  2\n" + Satellite("G07", 2.2e7));
  EXPECT_EQ(torn.epochs.size(), 1u);
  EXPECT_THAT(torn.warnings.first.at(0), HasSubstr("truncated"));
}

TEST(RinexObservationTest, HeadersThatCannotServeAreErrors) {
  const auto message = [](const std::string& text) { return ParseRinexObservation("file", text).message(); };
  EXPECT_THAT(message(""), HasSubstr("file: is empty"));
  EXPECT_THAT(message("hello\n"), HasSubstr("file:1: found 'hello', expected RINEX VERSION / TYPE"));
  EXPECT_THAT(message(VersionLine("9.00", "OBSERVATION DATA", "M")), HasSubstr("RINEX version: found 9.00"));
  EXPECT_THAT(message(VersionLine("3.05", "NAVIGATION DATA", "M")), HasSubstr("expected OBSERVATION DATA"));
  EXPECT_THAT(message(VersionLine("3.05", "OBSERVATION DATA", "M")), HasSubstr("no END OF HEADER"));
  EXPECT_THAT(message(VersionLine("3.05", "OBSERVATION DATA", "M") + HeaderLine("", "END OF HEADER")),
              HasSubstr("no observation types"));
  EXPECT_THAT(message(kHeader3), HasSubstr("holds no epoch of observations"));
}

const std::string kHeader2 =
    VersionLine("2.11", "OBSERVATION DATA", "M (MIXED)") +
    HeaderLine("     7    C1    P1    L1    D1    S1    P2    L2", "# / TYPES OF OBSERV") +
    HeaderLine("  2020     6    25     0     0    0.0000000     GPS", "TIME OF FIRST OBS") +
    HeaderLine("", "END OF HEADER");

std::string Satellite2(double range) {
  return Value(range) + Value(0) + Value(1e8) + Value(-2000.5) + Value(45) + "\n" + Value(range + 5) +
         Value(8e7) + "\n";
}

TEST(RinexObservationTest, Version2IsReadAcrossItsLines) {
  std::string epoch = " 20  6 25  0  0 30.0000000  0 14";
  for (int i = 1; i <= 12; ++i) {
    epoch += i < 10 ? "G 0" + std::to_string(i) : "G" + std::to_string(i);
  }
  epoch = " 20  6 25  0  0 30.0000000  0 14G01G02G03G04G05G06G07G08G09G10G11 12\n" + std::string(32, ' ') +
          "R01E05\n";
  std::string text = kHeader2 + epoch;
  for (int i = 1; i <= 14; ++i) {
    text += Satellite2(2e7 + i);
  }
  const ObservationFile file = Parse(text);
  EXPECT_EQ(file.warnings.count, 0) << (file.warnings.first.empty() ? "" : file.warnings.first[0]);
  ASSERT_EQ(file.epochs.size(), 1u);
  const ObservationEpoch& first = file.epochs[0];
  EXPECT_EQ(first.stamp_ns, GpsTimeFromWeek(TimeScale::kGps, 2111, 345'630 * kSecondNs));
  ASSERT_EQ(first.satellites.size(), 14u);
  EXPECT_EQ(ToString(first.satellites[11].satellite), "G12");
  const SatelliteObservation& gps = first.satellites[0];
  ASSERT_EQ(gps.signals.size(), 2u);
  EXPECT_EQ(ToString(gps.signals[0].signal), "1C");
  EXPECT_DOUBLE_EQ(*gps.signals[0].pseudorange_m, 2e7 + 1);
  EXPECT_DOUBLE_EQ(*gps.signals[0].doppler_hz, -2000.5);
  EXPECT_EQ(ToString(gps.signals[1].signal), "2W");
  EXPECT_DOUBLE_EQ(*gps.signals[1].pseudorange_m, 2e7 + 6);
  EXPECT_DOUBLE_EQ(*gps.signals[1].phase_cycles, 8e7);
  const SatelliteObservation& glonass = first.satellites.back();
  EXPECT_EQ(ToString(glonass.satellite), "R01");
  EXPECT_EQ(ToString(glonass.signals[1].signal), "2P");
}

TEST(RinexObservationTest, Version2EventsAndDamage) {
  const std::string good = " 20  6 25  0  0 30.0000000  0  1G07\n" + Satellite2(2.1e7);
  const std::string event =
      std::string(28, ' ') + "4  1\n" + HeaderLine("     1    C1", "# / TYPES OF OBSERV");
  const ObservationFile file = Parse(kHeader2 + good + "garbage\n" + event +
                                     " 20  6 25  0  1  0.0000000  0  1G07\n" + Value(2.2e7) + "\n");
  EXPECT_EQ(file.events, 1);
  ASSERT_EQ(file.epochs.size(), 2u);
  EXPECT_DOUBLE_EQ(*Only(file.epochs[1].satellites.at(0)).pseudorange_m, 2.2e7);
  EXPECT_EQ(file.warnings.count, 1);
}

// GIVEN a file of several parts, plain, as gzip, torn and cut to nothing WHEN it is scanned THEN the epochs,
// the header and the warnings are those of reading it whole, and a torn one is refused.
TEST(RinexObservationTest, ScanningGivesTheSameEpochs) {
  const test::TemporaryFolder folder;
  std::string text = kHeader3;
  constexpr std::size_t kEpochs = 7200;
  for (std::size_t second = 0; second < kEpochs; ++second) {
    text += Format("> 2020 06 25 %02zu %02zu %02zu.0000000  0  1\n", second / 3600, second / 60 % 60,
                   second % 60) +
            Satellite("G07", 2.1e7 + static_cast<double>(second));
  }
  ASSERT_GT(text.size(), std::size_t{3} << 17);
  text += "> 2020 06 25 00 00 30.0000000  0  1\n" + Satellite("G07", 2.1e7);  // earlier
  const std::string plain = folder.Write("plain.rnx", text);
  const std::string gzip = folder.File("gzip.rnx.gz");
  gzFile file = gzopen(gzip.c_str(), "wb");
  ASSERT_EQ(gzwrite(file, text.data(), static_cast<unsigned>(text.size())), static_cast<int>(text.size()));
  gzclose(file);
  const Result<ObservationFile> whole = ReadRinexObservation(plain);
  ASSERT_TRUE(whole.ok()) << whole.message();
  ASSERT_EQ(whole->epochs.size(), kEpochs);
  for (const std::string& path : {plain, gzip}) {
    std::vector<ObservationEpoch> epochs;
    std::size_t count = 0;
    const Result<ObservationFile> scanned = ScanRinexObservation(
        path, [&epochs](ObservationEpoch epoch) { epochs.push_back(std::move(epoch)); }, &count);
    ASSERT_TRUE(scanned.ok()) << scanned.message();
    EXPECT_EQ(count, kEpochs);
    ASSERT_EQ(epochs.size(), kEpochs);
    for (std::size_t i = 0; i < epochs.size(); ++i) {
      EXPECT_EQ(epochs[i].stamp_ns, whole->epochs[i].stamp_ns);
      EXPECT_EQ(Only(epochs[i].satellites.at(0)).pseudorange_m, 2.1e7 + static_cast<double>(i));
    }
    EXPECT_TRUE(scanned->epochs.empty());
    EXPECT_EQ(scanned->warnings.count, 1);
    EXPECT_EQ(scanned->glonass_channels, whole->glonass_channels);
  }
  std::size_t count = 0;
  std::filesystem::resize_file(gzip, std::filesystem::file_size(gzip) / 2);
  EXPECT_THAT(ScanRinexObservation(gzip, nullptr, &count).message(),
              HasSubstr("gzip.rnx.gz: cannot be unpacked"));
  // A line without an end takes no more memory than a part of it.
  const std::string endless = folder.Write("endless.rnx", text + std::string(5 * LineReader::kMaxLine, 'x'));
  const Result<ObservationFile> scanned = ScanRinexObservation(endless, nullptr, &count);
  ASSERT_TRUE(scanned.ok()) << scanned.message();
  EXPECT_EQ(count, kEpochs);
  EXPECT_THAT(ScanRinexObservation(folder.Write("none.rnx", ""), nullptr, &count).message(),
              HasSubstr("none.rnx"));
  EXPECT_THAT(ScanRinexObservation(folder.File("gone.rnx"), nullptr, &count).message(),
              HasSubstr("gone.rnx"));
}

TEST(RinexObservationTest, RealFilesAreReadWhole) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  struct Case {
    const char* path;
    std::size_t epochs;
    int events;
  };
  for (const Case& real :
       {Case{"gnss/static_esbc/ESBC_4h.rnx", 480, 0},
        Case{"gnss/urban_static_tst2/2020_06_03_TST_03.obs", 986, 0},
        Case{"gnss/phone_xiaomi/GEOP092I.24o", 599, 1}, Case{"gnss/rinex4_kms3/KMS3.rnx", 19, 0},
        Case{"gnss_imu/walk_0827/mav0/gnss0/obs.rnx", 536, 0}}) {
    const Result<ObservationFile> file = ReadRinexObservation(test::SharedDir() + "/data/" + real.path);
    ASSERT_TRUE(file.ok()) << file.message();
    EXPECT_EQ(file->epochs.size(), real.epochs) << real.path;
    EXPECT_EQ(file->events, real.events) << real.path;
    EXPECT_EQ(file->warnings.count, 0) << real.path;
  }
}

// Receivers of BeiDou may count from its epoch.
TEST(RinexObservationTest, LeapSecondsCountedFromBdtAreRightToo) {
  std::string header = kHeader3;
  const std::string of_gps = HeaderLine("    18", "LEAP SECONDS");
  header.replace(header.find(of_gps), of_gps.size(),
                 HeaderLine("     4    18   753     7BDS", "LEAP SECONDS"));
  const ObservationFile file =
      Parse(header + "> 2020 06 25 00 00 30.0000000  0  1\n" + Satellite("G07", 2.1e7));
  EXPECT_EQ(file.warnings.count, 0);
  EXPECT_EQ(file.leap_seconds, 18);
}

}  // namespace
}  // namespace alidade
