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

// GIVEN rows without deviations WHEN read THEN the quality says how good they are.
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
