#include "eval/trajectory/position_file_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "gnss/base/gnss_time.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

const std::string kPlace = " 22.30000000 114.20000000 5.0 ";

class PositionRows : public testing::Test {
 protected:
  Result<std::vector<FilePosition>> Read(const std::string& text) const {
    return ReadPositionRows(folder_.Write("a.pos", text));
  }
  test::TemporaryFolder folder_;
};

/// Standard deviation in any horizontal and vertical direction of an uncorrelated covariance.
double LargestDeviation(const FilePosition& position) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(position.covariance_E).eigenvalues()[2]);
}

TEST_F(PositionRows, StampsAreDatesOrWeeksAndRepeatedOnesArePassedOver) {
  const auto rows = Read("% GPST\n2288 252801.000" + kPlace + "1 9\n2023/11/14 22:13:21.000" + kPlace +
                         "1 9\n2023/11/14 22:13:22.500" + kPlace + "1 9\n");
  ASSERT_TRUE(rows.ok()) << rows.message();
  ASSERT_EQ(rows->size(), 2u);  // 2288 252801 is 2023/11/14 22:13:21
  EXPECT_EQ((*rows)[0].stamp_ns, GpsTimeFromWeek(TimeScale::kGps, 2288, 252'801 * kSecondNs));
  EXPECT_EQ((*rows)[1].stamp_ns - (*rows)[0].stamp_ns, 1'500'000'000);
  const auto utc = Read("%  UTC  latitude(deg)\n2023/11/14 22:13:21.000" + kPlace + "1 9\n");
  ASSERT_TRUE(utc.ok()) << utc.message();
  EXPECT_EQ((*utc)[0].stamp_ns - (*rows)[0].stamp_ns, 18 * kSecondNs);
}

// GIVEN rows without deviations WHEN read THEN the deviation follows from the quality.
TEST_F(PositionRows, QualityStandsForMissingDeviations) {
  for (const auto& [quality, deviation_m] :
       {std::pair(1, 0.02), {2, 0.3}, {3, 1.0}, {4, 1.0}, {5, 3.0}, {6, 0.1}}) {
    const auto rows = Read("2288 252801.000" + kPlace + std::to_string(quality) + " 9\n");
    ASSERT_TRUE(rows.ok()) << rows.message();
    EXPECT_NEAR(LargestDeviation((*rows)[0]), 2 * deviation_m, 1e-9) << quality;  // upwards
  }
}

TEST_F(PositionRows, DeviationsAreTakenAndThoseThatCannotBeLoseTheirCorrelation) {
  const auto rows = Read("2288 252801.000" + kPlace + "2 9 0.3 0.2 0.5 0 0 0\n2288 252802.000" + kPlace +
                         "2 9 0.3 0.2 0.5 0.4 0 0\n");
  ASSERT_TRUE(rows.ok()) << rows.message();
  EXPECT_NEAR(LargestDeviation((*rows)[0]), 0.5, 1e-9);
  EXPECT_TRUE((*rows)[0].covariance_E.isApprox((*rows)[1].covariance_E, 1e-9));
  const auto ecef = Read("% x-ecef(m)\n2288 252801.000 -2417000 5385000 2405000 2 9 0.3 0.2 0.5 0 0 0\n");
  ASSERT_TRUE(ecef.ok()) << ecef.message();
  EXPECT_TRUE((*ecef)[0].covariance_E.diagonal().isApprox(Eigen::Vector3d(0.09, 0.04, 0.25), 1e-9));
}

// GIVEN labels of columns or of a time scale that are not read, THEN they are named and no row is misread.
TEST_F(PositionRows, LabelsThatAreNotReadAreNamedByLine) {
  const std::string row = "2023/11/14 22:13:21.000" + kPlace + "1 9\n";
  for (const auto& [labels, message] : std::vector<std::pair<std::string, std::string>>{
           {"%  GPST                    e-baseline(m)  n-baseline(m)  u-baseline(m)   Q  ns",
            "a.pos:2: found 'e-baseline(m)', expected latitude(deg) or x-ecef(m)"},
           {"%  GPST  latitude(d'\") longitude(d'\")  height(m)   Q  ns", "a.pos:2: found 'latitude(d"},
           {"%  JST   latitude(deg) longitude(deg)  height(m)   Q  ns",
            "a.pos:2: found 'JST', expected the time scale GPST or UTC"},
           {"% e-baseline(m)", "a.pos:2: found 'e-baseline(m)'"}}) {
    const auto rows = Read("% program   : RTKLIB ver.2.4.3(b34)\n" + labels + "\n" + row);
    ASSERT_FALSE(rows.ok()) << labels;
    EXPECT_THAT(rows.message(), HasSubstr(message));
  }
  // Lines of RTKLIB's header that are not labels, among them one that speaks of other axes.
  const auto rows = Read(
      "% program   : RTKLIB ver.2.4.3(b34)\n% obs start : 2023/11/14 22:13:21.0 GPST (week2288 252801.0s)\n"
      "% ref pos   :   22.300000000  114.200000000     5.0000\n%\n"
      "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp,ns=# of "
      "satellites)\n%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns\n" +
      row);
  ASSERT_TRUE(rows.ok()) << rows.message();
  EXPECT_EQ(rows->front().stamp_ns, GpsTimeFromWeek(TimeScale::kGps, 2288, 252'801 * kSecondNs));
}

TEST_F(PositionRows, TornOnesAreNamedByLine) {
  for (const auto& [row, message] : std::vector<std::pair<std::string, std::string>>{
           {"6000 0" + kPlace,
            "a.pos:2: found '6000 0', expected a date and time, or week and second of week"},
           {"2288 x" + kPlace, "expected a date and time"},
           {"2288 604801" + kPlace, "expected a date and time"},
           {"2288 1 22 x 5", "expected three coordinates"},
           {"2288 1 95 114 5", "expected latitude and longitude [deg]"},
           {"2288 1 22 114 4000000", "from the Earth's centre"}}) {
    const auto rows = Read("% GPST\n" + row + "\n");
    ASSERT_FALSE(rows.ok()) << row;
    EXPECT_THAT(rows.message(), HasSubstr(message));
    EXPECT_THAT(rows.message(), HasSubstr("a.pos:2: "));
  }
  EXPECT_THAT(Read("% GPST\n").message(), HasSubstr("holds no position"));
}

}  // namespace
}  // namespace alidade
