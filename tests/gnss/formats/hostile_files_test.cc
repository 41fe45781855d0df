#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/random.h"
#include "gnss/formats/compact_rinex.h"
#include "gnss/formats/precise_products.h"
#include "gnss/formats/rinex_navigation.h"
#include "gnss/formats/rinex_observation.h"
#include "gnss/positioning/single_point.h"
#include "tests/gnss/formats/rinex_text.h"
#include "tests/support/read_file.h"
#include "tests/support/shared_data.h"

// Readers must come back from any bytes: with data that keeps what its types promise, or with a message that
// names the file. Anything else they do wrong shows as a crash, a sanitizer's report or a time limit.

namespace alidade {
namespace {

using test::HeaderLine;
using test::VersionLine;

/// Parses, and uses what was read so that it is touched.
struct Target {
  std::string name;
  std::string text;
  std::function<std::string(const std::string&)> parse;  ///< the message, empty when data came back
  bool differenced = false;                              ///< a line depends on those before it
};

std::string ParseObservation(const std::string& text) {
  const Result<ObservationFile> file = ParseRinexObservation("hostile", text);
  if (!file.ok()) {
    return file.message();
  }
  SinglePointSolver solver(MeasurementBuilder(std::make_shared<SatelliteCatalog>(NavigationData()), {}), {});
  TimeNs last_ns = INT64_MIN;
  for (const ObservationEpoch& epoch : file->epochs) {
    EXPECT_FALSE(solver.Solve(epoch).ok());
    EXPECT_GT(epoch.stamp_ns, last_ns) << "strictly rising";
    last_ns = epoch.stamp_ns;
    for (const SatelliteObservation& satellite : epoch.satellites) {
      for (const SignalObservation& signal : satellite.signals) {
        for (const auto& value : {signal.pseudorange_m, signal.doppler_hz, signal.cn0_dbhz}) {
          EXPECT_TRUE(std::isfinite(value.value_or(0))) << ToString(satellite.satellite);
        }
      }
    }
  }
  return "";
}

std::string ParseNavigation(const std::string& text) {
  const Result<NavigationData> data = ParseRinexNavigation("hostile", text);
  if (!data.ok()) {
    return data.message();
  }
  const SatelliteCatalog catalog(*data);
  for (const auto& [id, list] : data->kepler) {
    const SatelliteFix fix = catalog.AtTransmission(id, {'1', 'C'}, list[0].toe_ns, 2.2e7);
    EXPECT_TRUE(fix.state.position_E.allFinite()) << ToString(id);
  }
  for (const auto& [number, list] : data->glonass) {
    const SatelliteFix fix =
        catalog.AtTransmission({GnssSystem::kGlonass, number}, {'1', 'C'}, list[0].toe_ns, 2.2e7);
    EXPECT_TRUE(fix.state.position_E.allFinite()) << number;
  }
  return "";
}

/// The first `bytes` of a real file, to a whole line.
std::string Head(const std::string& path, std::size_t bytes) {
  const std::string text = test::ReadFile(test::SharedDir() + "/data/" + path).substr(0, bytes);
  return text.substr(0, text.rfind('\n') + 1);
}

std::string Message(const Result<PreciseProducts>& products) {
  return products.ok() ? "" : products.message();
}

std::vector<Target> Targets() {
  const auto sp3 = [](const std::string& text) { return Message(ParseSp3("hostile", text)); };
  const auto clock = [](const std::string& text) { return Message(ParseRinexClock("hostile", text)); };
  std::string rinex2 = VersionLine("2.11", "OBSERVATION DATA", "M") +
                       HeaderLine("     6    C1    L1    D1    S1    P2    L2", "# / TYPES OF OBSERV") +
                       HeaderLine("", "END OF HEADER");
  for (int i = 0; i < 30; ++i) {
    char line[80];
    std::snprintf(line, sizeof line, " 20  6 25  0  0 %2d.0000000  0  2G07R08\n", i);
    rinex2 += line;
    for (int k = 0; k < 2; ++k) {
      rinex2 += test::Value(2.1e7 + i) + test::Value(1e8) + test::Value(-2000) + test::Value(45) +
                test::Value(2.1e7) + "\n" + test::Value(8e7) + "\n";
    }
  }
  return {
      {"RINEX 2", rinex2, ParseObservation},
      {"RINEX 3", Head("gnss/static_esbc/ESBC_4h.rnx", 30'000), ParseObservation},
      {"RINEX 3 phone", Head("gnss/phone_xiaomi/GEOP092I.24o", 20'000), ParseObservation},
      {"Compact RINEX", Head("gnss/rinex4_kms3/KMS300DNK_R_20221591000_01H_30S_MO.crx", 40'000),
       ParseObservation, true},
      {"navigation 3", Head("gnss/urban_static_tst2/hksc155c.20b", 12'000), ParseNavigation},
      {"navigation 3 GLONASS", Head("gnss/urban_static_tst2/hksc155c.20g", 8'000), ParseNavigation},
      {"navigation 4", Head("gnss/rinex4_kms3/KMS300DNK_R_20221591000_01H_MN.rnx", 30'000), ParseNavigation},
      {"navigation 2", Head("gnss/precise_cod/brdc1180.21n", 10'000), ParseNavigation},
      {"SP3", Head("gnss/precise_cod/COD0MGXFIN_20211180000_01D_05M_ORB.SP3", 20'000), sp3},
      {"CLK", Head("gnss/precise_cod/COD21118_300.CLK", 10'000), clock}};
}

/// Damaged texts of a target: how many of them were read, and how many refused with a message.
struct Outcome {
  int read = 0;
  int refused = 0;
};

/// A damaged record costs itself alone, so most texts are read. In a differenced text the damage would go on
/// to the records behind it: most are refused.
void ExpectDamageIsContained(const Target& target, const Outcome& outcome) {
  EXPECT_GT(target.differenced ? outcome.refused : outcome.read,
            target.differenced ? outcome.read : outcome.refused)
      << target.name;
}

void Feed(const Target& target, const std::string& text, Outcome* outcome) {
  const std::string message = target.parse(text);
  ++(message.empty() ? outcome->read : outcome->refused);
  EXPECT_TRUE(message.empty() || message.rfind("hostile", 0) == 0) << target.name << ": " << message;
}

TEST(HostileFilesTest, TruncationAtAnyPlaceIsSurvived) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  for (const Target& target : Targets()) {
    ASSERT_EQ(target.parse(target.text), "") << target.name;
    Outcome outcome;
    for (std::size_t size = 0; size < target.text.size(); size += 1 + target.text.size() / 200) {
      Feed(target, target.text.substr(0, size), &outcome);
    }
    EXPECT_GT(outcome.read, 0) << target.name << ": a file that was cut short still serves up to there";
    EXPECT_GT(outcome.refused, 0) << target.name << ": without its header it is an error";
  }
}

TEST(HostileFilesTest, FlippedBytesAreSurvived) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  RandomStream random(11, "flips");
  for (const Target& target : Targets()) {
    Outcome lightly_damaged;
    Outcome heavily_damaged;
    for (int round = 0; round < 60; ++round) {
      std::string text = target.text;
      const int flips = 1 << (round % 10);
      for (int i = 0; i < flips; ++i) {
        const auto place = static_cast<std::size_t>(random.Uniform(0, static_cast<double>(text.size())));
        // Digits and blanks do more than arbitrary bytes, which most readers stop at.
        constexpr std::string_view kBytes("0123456789 -.>&G\n\0\xFF", 19);
        text[place] = round % 2 == 0 ? kBytes[static_cast<std::size_t>(random.Uniform(0, 19))]
                                     : static_cast<char>(random.Uniform(-128, 128));
      }
      Feed(target, text, flips <= 4 ? &lightly_damaged : &heavily_damaged);
    }
    EXPECT_EQ(lightly_damaged.read + lightly_damaged.refused, 18) << target.name;
    EXPECT_EQ(heavily_damaged.read + heavily_damaged.refused, 42) << target.name;
    ExpectDamageIsContained(target, lightly_damaged);
  }
}

TEST(HostileFilesTest, RepeatedAndDroppedLinesAreSurvived) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  RandomStream random(12, "lines");
  for (const Target& target : Targets()) {
    Outcome outcome;
    for (int round = 0; round < 20; ++round) {
      std::string text;
      std::string_view rest = target.text;
      while (!rest.empty()) {
        const std::string_view line = rest.substr(0, rest.find('\n') + 1);
        const double fate = random.Uniform(0, 1);
        text += fate < 0.03 ? "" : line;
        text += fate > 0.97 ? line : "";
        rest.remove_prefix(line.size());
      }
      Feed(target, text, &outcome);
    }
    ExpectDamageIsContained(target, outcome);
  }
}

TEST(HostileFilesTest, HugeCountsReserveNothing) {
  const std::string head3 = VersionLine("3.05", "OBSERVATION DATA", "M");
  const std::string end = HeaderLine("", "END OF HEADER");
  const std::vector<std::string> observations = {
      head3 + HeaderLine("G  999 C1C", "SYS / # / OBS TYPES") + end +
          "> 2020 06 25 00 00 30.0000000  0999\nG07\n",
      head3 + HeaderLine("G-9999 C1C", "SYS / # / OBS TYPES") + end,
      head3 + HeaderLine("G    1 C1C", "SYS / # / OBS TYPES") + end + "> 2020 06 25 00 00 30.0000000  4999\n",
      VersionLine("2.11", "OBSERVATION DATA", "M") + HeaderLine("999999    C1", "# / TYPES OF OBSERV") + end,
      VersionLine("2.11", "OBSERVATION DATA", "M") + HeaderLine("   999    C1", "# / TYPES OF OBSERV") + end +
          " 20  6 25  0  0 30.0000000  0999G07\n"};
  for (const std::string& text : observations) {
    EXPECT_NE(ParseObservation(text), "") << text;
  }
  const std::string packed =
      HeaderLine("3.0                 COMPACT RINEX FORMAT", "CRINEX VERS   / TYPE") +
      HeaderLine("", "CRINEX PROG / DATE") + head3 + HeaderLine("G  999 C1C", "SYS / # / OBS TYPES") + end +
      "> 2020 06 25 00 00 30.0000000  0999      " + std::string(2997, 'G') + "\n\n\n\n";
  EXPECT_NE(ParseObservation(packed), "");
}

/// Differences that repeat make a small text unpack to a large one: it is bounded.
TEST(HostileFilesTest, CompactRinexThatGrowsWithoutEndIsStopped) {
  std::string types = "G  999";
  std::string header = VersionLine("3.05", "OBSERVATION DATA", "M");
  for (int i = 0; i < 999; ++i) {
    types += " C1C";
    if (i % 13 == 12 || i == 998) {
      header += HeaderLine(types, "SYS / # / OBS TYPES");
      types = "      ";
    }
  }
  std::string begin;
  std::string more;
  for (int i = 0; i < 999; ++i) {
    begin += "0&0 ";
    more += "0 ";
  }
  std::string text = HeaderLine("3.0                 COMPACT RINEX FORMAT", "CRINEX VERS   / TYPE") +
                     HeaderLine("", "CRINEX PROG / DATE") + header + HeaderLine("", "END OF HEADER") +
                     "> 2020 06 25 00 00 30.0000000  0  1      G01\n\n" + begin + "\n";
  for (int epoch = 0; epoch < 20; ++epoch) {
    text += "\n\n" + more + "\n";
  }
  ASSERT_TRUE(DecodeCompactRinex("hostile", text).ok());
  EXPECT_GT(DecodeCompactRinex("hostile", text)->size(), 6 * text.size());
  const Result<std::string> plain = DecodeCompactRinex("hostile", text, 100'000);
  ASSERT_FALSE(plain.ok());
  EXPECT_NE(plain.message().find("unpacks to more than"), std::string::npos) << plain.message();
}

}  // namespace
}  // namespace alidade
