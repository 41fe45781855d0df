#include "eval/trajectory/nmea_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gnss/base/geodesy.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

/// "$" + body + checksum.
std::string Sentence(const std::string& body) {
  unsigned sum = 0;
  for (const char c : body) {
    sum ^= static_cast<unsigned char>(c);
  }
  char tail[8];
  std::snprintf(tail, sizeof tail, "*%02X", sum);
  return "$" + body + tail + "\r\n";
}

std::string Gga(const std::string& time, const char* quality = "1") {
  return Sentence("GPGGA," + time + ",4807.038,N,01131.000,W," + quality + ",08,0.9,545.4,M,46.9,M,,");
}

TEST(NmeaReader, GIVEN_the_textbook_sentence_THEN_place_time_and_deviation_are_its_own) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write(
      "a.nmea", "noise before\n$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\n" +
                    Sentence("GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W"));
  const auto positions = ReadNmeaFile(path, std::nullopt);
  ASSERT_TRUE(positions.ok()) << positions.message();
  ASSERT_EQ(positions->size(), 1u);
  const GeodeticPosition place = ToGeodetic(positions->front().position_E);
  EXPECT_NEAR(place.latitude_rad * 180 / M_PI, 48.1173, 1e-9);
  EXPECT_NEAR(place.longitude_rad * 180 / M_PI, 11.0 + 31.0 / 60, 1e-9);
  EXPECT_NEAR(place.height_m, 592.3, 1e-6);
  // 1994-03-23 12:35:19 UTC; GPST was 9 s ahead.
  EXPECT_EQ(positions->front().stamp_ns, (764'426'119LL + 9) * kSecondNs);
  EXPECT_NEAR(std::sqrt(positions->front().covariance_E.trace()), 2.5 * 0.9 * std::sqrt(6), 1e-9);
}

TEST(NmeaReader, GIVEN_midnight_and_a_late_date_THEN_the_day_turns) {
  const test::TemporaryFolder folder;
  const std::string path =
      folder.Write("a.nmea", Gga("235958.50") + Gga("235959.50") + Gga("000000.50") +
                                 Sentence("GPZDA,000001.00,02,01,2020,00,00") + Gga("000001.50"));
  const auto positions = ReadNmeaFile(path, std::nullopt);
  ASSERT_TRUE(positions.ok()) << positions.message();
  ASSERT_EQ(positions->size(), 4u);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_EQ((*positions)[i].stamp_ns - (*positions)[i - 1].stamp_ns, kSecondNs);
  }
  const CalendarTime last = CalendarFromGpsTime(TimeScale::kUtc, positions->back().stamp_ns);
  EXPECT_EQ(last.day, 2);
  EXPECT_EQ(last.year, 2020);
}

TEST(NmeaReader, GIVEN_GST_THEN_its_deviations_count_and_RTK_has_centimetres) {
  const test::TemporaryFolder folder;
  const CalendarTime date{2023, 5, 10};
  const std::string path = folder.Write(
      "a.nmea", Gga("120000.00") + Sentence("GPGST,120000.00,1.0,,,,0.5,0.4,0.9") + Gga("120001.00", "4"));
  const auto positions = ReadNmeaFile(path, date);
  ASSERT_TRUE(positions.ok()) << positions.message();
  const auto enu = [](const FilePosition& position) {
    const Eigen::Matrix3d R_EN = EnuFrame::At(position.position_E).R_EN;
    return Eigen::Matrix3d(R_EN.transpose() * position.covariance_E * R_EN);
  };
  EXPECT_LT((enu((*positions)[0]).diagonal() - Eigen::Vector3d(0.16, 0.25, 0.81)).norm(), 1e-9);
  EXPECT_LT((enu((*positions)[1]).diagonal() - Eigen::Vector3d(4e-4, 4e-4, 16e-4)).norm(), 1e-9);
}

TEST(NmeaReader, GIVEN_no_solution_or_a_wrong_checksum_THEN_the_sentence_is_passed_over) {
  const test::TemporaryFolder folder;
  const CalendarTime date{2023, 5, 10};
  std::string wrong = Gga("120001.00");
  wrong[10] = '9';
  const std::string path =
      folder.Write("a.nmea", Gga("120000.00", "0") + wrong + Gga("120002.00", "6") + Gga("120003.00", "2"));
  const auto positions = ReadNmeaFile(path, date);
  ASSERT_TRUE(positions.ok()) << positions.message();
  EXPECT_EQ(positions->size(), 1u);
}

TEST(NmeaReader, GIVEN_what_cannot_be_read_THEN_the_place_and_the_remedy_are_named) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(ReadNmeaFile(folder.Write("a.nmea", Gga("120000.00")), std::nullopt).message(),
              HasSubstr("date:"));
  const CalendarTime date{2023, 5, 10};
  EXPECT_THAT(ReadNmeaFile(folder.Write("b.nmea", Gga("120000.00") + Gga("12xx00.00")), date).message(),
              HasSubstr("b.nmea:2"));
  EXPECT_THAT(ReadNmeaFile(folder.Write("c.nmea", Sentence("GPGGA,120000.00,4807.038")), date).message(),
              HasSubstr("c.nmea:1"));
  for (const char* cut : {"2", "23", "230", "2303", "23039"}) {
    const std::string rmc = Sentence(std::string("GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,") + cut);
    EXPECT_THAT(ReadNmeaFile(folder.Write("cut.nmea", Gga("123519") + rmc), date).message(),
                testing::AllOf(HasSubstr("cut.nmea:2"), HasSubstr("expected time and date")))
        << cut;
  }
  EXPECT_THAT(ReadNmeaFile(folder.Write("d.nmea", "hello\n"), date).message(),
              HasSubstr("holds no position"));
}

}  // namespace
}  // namespace alidade
