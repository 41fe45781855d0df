#include "eval/dataset/dataset_fix.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/digest.h"
#include "gnss/base/anchor_llh.h"
#include "tests/eval/dataset/healthy_dataset.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::Complaints;
using testing::HasSubstr;

constexpr TimeNs kStart = 1'700'000'000'000'000'000;

/// Two sensors at 1 Hz and 2 Hz beside an IMU at 100 Hz: one on the Earth, one in a frame of its own.
Dataset WithFixes() {
  Dataset dataset;
  for (int i = 0; i <= 1000; ++i) {
    dataset.imu.push_back({kStart + i * TimeNs{10'000'000}, Vector3d(1e-4 * i, 0.1, 0), Vector3d(0, 0, 9.8)});
  }
  dataset.rig.fixes = {{Vector3d(0.1, -0.2, 1.0 / 3), 0.0123456789, Vector3d(47.4, 8.5, 450.125)},
                       {Vector3d::Zero(), -1.5, std::nullopt}};
  for (int i = 0; i < 18; ++i) {
    const int sensor = i % 3 == 0 ? 0 : 1;
    const TimeNs imu_stamp = kStart + i * TimeNs{500'000'000};
    Matrix3d covariance = Vector3d(1.1, 0.9, 2.0 + 0.1 * i).asDiagonal();
    covariance(0, 1) = covariance(1, 0) = 0.3;
    dataset.fixes.push_back(
        {imu_stamp - SecondsToNs(dataset.rig.fixes[static_cast<std::size_t>(sensor)].time_offset_s), sensor,
         Vector3d(i / 3.0, std::sin(i), 1e-9 * i), covariance});
  }
  return dataset;
}

void WriteImu(const test::TemporaryFolder& folder) {
  folder.Write(
      "mav0/imu0/sensor.yaml",
      "gyroscope_noise_density: 1e-3\ngyroscope_random_walk: 1e-5\naccelerometer_noise_density: 1e-2\n"
      "accelerometer_random_walk: 1e-4\n");
  folder.Write(
      "mav0/imu0/data.csv",
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],"
      "a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n1,0,0,0,0,0,9.8\n2,0,0,0,0,0,9.8\n");
}

Result<Dataset> ReadFixes(const test::TemporaryFolder& folder) {
  Dataset dataset;
  const Status status = ReadFixFolders(folder.File("mav0"), {}, &dataset);
  return status.ok() ? Result<Dataset>(dataset) : status;
}

TEST(DatasetFix, WHEN_written_and_read_THEN_fixes_are_equal_to_the_last_bit) {
  const test::TemporaryFolder folder;
  const Dataset written = WithFixes();
  ASSERT_TRUE(WriteFixFolders(written, folder.File("mav0")).ok());
  const Result<Dataset> read = ReadFixes(folder);
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_EQ(read->rig.fixes.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read->rig.fixes[i].p_BA, written.rig.fixes[i].p_BA);
    EXPECT_EQ(read->rig.fixes[i].time_offset_s, written.rig.fixes[i].time_offset_s);
    EXPECT_EQ(read->rig.fixes[i].anchor_llh_deg, written.rig.fixes[i].anchor_llh_deg);
  }
  ASSERT_EQ(read->fixes.size(), written.fixes.size());
  for (std::size_t i = 0; i < written.fixes.size(); ++i) {
    EXPECT_EQ(read->fixes[i].stamp_ns, written.fixes[i].stamp_ns);
    EXPECT_EQ(read->fixes[i].sensor, written.fixes[i].sensor);
    EXPECT_EQ(read->fixes[i].p_A, written.fixes[i].p_A);
    EXPECT_EQ(read->fixes[i].covariance, written.fixes[i].covariance);
  }
}

TEST(DatasetFix, GIVEN_fixes_THEN_the_digest_is_theirs_and_without_them_it_is_as_before) {
  const Dataset dataset = WithFixes();
  MeasurementLog log{dataset.rig, dataset.imu, {}};
  const std::string without = DigestOf(log);
  MeasurementLog bare = log;
  bare.rig.fixes.clear();
  EXPECT_EQ(DigestOf(bare), without) << "a sheet alone is no input";
  log.fixes = dataset.fixes;
  const std::string with = DigestOf(log);
  EXPECT_NE(with, without);
  for (int change = 0; change < 5; ++change) {
    MeasurementLog changed = log;
    change == 0   ? void(changed.fixes[3].stamp_ns += 1)
    : change == 1 ? void(changed.fixes[3].p_A[2] += 1e-12)
    : change == 2 ? void(changed.fixes[3].covariance(2, 2) += 1e-12)
    : change == 3 ? void(changed.rig.fixes[0].p_BA[0] += 1e-12)
                  : changed.rig.fixes[0].anchor_llh_deg.reset();
    EXPECT_NE(DigestOf(changed), with) << "change " << change;
  }
}

/// A fault of fix0 and what its message must hold.
struct BadFix {
  const char* name;
  const char* sheet;
  const char* data;
  const char* message;
};
constexpr const char* kSheet = "p_BA: [0, 0, 0]\n";
constexpr const char* kHeader =
    "#timestamp [ns],p_x [m],p_y [m],p_z [m],c_xx,c_xy,c_xz,c_yy,c_yz,c_zz [m^2]\n";

class BadFixFolder : public testing::TestWithParam<BadFix> {};
TEST_P(BadFixFolder, IsAnInputErrorThatNamesThePlace) {
  const test::TemporaryFolder folder;
  folder.Write("mav0/fix0/sensor.yaml", GetParam().sheet);
  folder.Write("mav0/fix0/data.csv", GetParam().data);
  const Result<Dataset> read = ReadFixes(folder);
  EXPECT_EQ(read.status().code(), StatusCode::kInput);
  EXPECT_THAT(read.message(), HasSubstr(GetParam().message));
}
const std::string kGood = std::string(kHeader) + "10,1,2,3,1,0,0,1,0,1\n";
const std::string kTorn = kGood + "20,1,2,3,1,0,0,1\n";
const std::string kLate = kGood + "10,1,2,3,1,0,0,1,0,1\n";
const std::string kIndefinite = kGood + "20,1,2,3,1,2,0,1,0,1\n";
const std::string kNan = kGood + "20,1,nan,3,1,0,0,1,0,1\n";
INSTANTIATE_TEST_SUITE_P(
    Cases, BadFixFolder,
    testing::Values(
        BadFix{"arm", "time_offset_s: 0\n", kGood.c_str(), "p_BA: is missing"},
        BadFix{"offset", "p_BA: [0, 0, 0]\ntime_offset_s: soon\n", kGood.c_str(), "sensor.yaml:2:16"},
        BadFix{"clock", "p_BA: [0, 0, 0]\ntime_offset_s: 4.7e9\n", kGood.c_str(),
               "sensor.yaml:2:16: time_offset_s: found '4.7e9', expected a number within +-4.6e9 s"},
        BadFix{"far_behind", "p_BA: [0, 0, 0]\ntime_offset_s: -1e10\n", kGood.c_str(), "-1e10"},
        BadFix{"sum", "p_BA: [0, 0, 0]\ntime_offset_s: 4.6e9\n", kGood.c_str(),
               "sensor.yaml: time_offset_s: found 4.6e+09 s with the stamp 10 ns, expected a sum within "
               "+-4600000000000000000 ns"},
        BadFix{"anchor", "p_BA: unknown\nanchor_llh_deg: [95, 8, 400]\n", kGood.c_str(),
               "anchor_llh_deg: found"},
        BadFix{"type", "sensor_type: camera\np_BA: unknown\n", kGood.c_str(), "'position'"},
        BadFix{"extension", "p_BA: unknown\npositions: data.ubx\n", kGood.c_str(), "ends in .csv"},
        BadFix{"elsewhere", "p_BA: unknown\npositions: ../cam0/data.csv\n", kGood.c_str(),
               "expected the name of a file in the folder of this sheet"},
        BadFix{"header", kSheet, "#timestamp [ns],x\n", "data.csv:1"},
        BadFix{"torn", kSheet, kTorn.c_str(), "data.csv:3"},
        BadFix{"late", kSheet, kLate.c_str(), "data.csv:3"},
        BadFix{"indefinite", kSheet, kIndefinite.c_str(), "data.csv:3: column 5 (c_xx)"},
        BadFix{"nan", kSheet, kNan.c_str(), "data.csv:3: column 3 (p_y)"}),
    [](const auto& bad) { return std::string(bad.param.name); });

TEST(DatasetFix, GIVEN_a_pos_file_THEN_its_deviations_are_the_covariance_and_its_first_row_the_anchor) {
  const test::TemporaryFolder folder;
  WriteImu(folder);
  folder.Write("mav0/fix0/sensor.yaml", "p_BA: [0, 0, 1]\npositions: rover.pos\ntime_offset_s: 0.5\n");
  folder.Write(
      "mav0/fix0/rover.pos",
      "% program\n"
      "%  GPST  latitude(deg) longitude(deg)  height(m)  Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  "
      "sdun(m) age(s)  ratio\n"
      "2023/11/14 22:13:20.000 47.4 8.5 450 1 9 0.02 0.01 0.04 -0.01 0.005 0.01 0 3\n"
      "2023/11/14 22:13:21.000 47.4 8.5 451 2 9 0 0 0 0 0 0 0 3\n");
  const Result<Dataset> read = ReadFixes(folder);
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_EQ(read->fixes.size(), 2u);
  EXPECT_EQ(read->fixes[0].stamp_ns, kStart);
  EXPECT_LT((*read->rig.fixes[0].anchor_llh_deg - Vector3d(47.4, 8.5, 450)).norm(), 1e-8);
  EXPECT_LT(read->fixes[0].p_A.norm(), 1e-6);
  EXPECT_LT((read->fixes[1].p_A - Vector3d(0, 0, 1)).norm(), 1e-6);
  Matrix3d expected;  // east, north, up
  expected << 1e-4, -1e-4, 25e-6, -1e-4, 4e-4, 1e-4, 25e-6, 1e-4, 16e-4;
  EXPECT_LT((read->fixes[0].covariance - expected).norm(), 1e-12) << read->fixes[0].covariance;
  EXPECT_LT((read->fixes[1].covariance - Matrix3d(Vector3d(0.09, 0.09, 0.36).asDiagonal())).norm(), 1e-12);
}

TEST(DatasetFix, GIVEN_NMEA_THEN_its_positions_stand_at_the_given_anchor) {
  const test::TemporaryFolder folder;
  folder.Write("mav0/fix0/sensor.yaml",
               "p_BA: unknown\npositions: log.nmea\ndate: 2023-11-14\nanchor_llh_deg: [47.4, 8.5, 449]\n");
  folder.Write("mav0/fix0/log.nmea",
               "$GNGGA,221302.00,4724.0000,N,00830.0000,E,4,12,0.8,400.0,M,50.0,M,1.0,0000\n");
  const Result<Dataset> read = ReadFixes(folder);
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_EQ(read->fixes[0].stamp_ns, kStart) << "UTC is 18 s behind GPST";
  EXPECT_LT((read->fixes[0].p_A - Vector3d(0, 0, 1)).norm(), 1e-6);
}

TEST(DatasetFix, GIVEN_odd_fixes_THEN_check_names_rate_gap_deviation_jump_and_frames) {
  Dataset dataset = WithFixes();
  EXPECT_THAT(Complaints(dataset, DatasetFinding::Severity::kFact), HasSubstr("fix0: 6 stamps over 7.500 s"));
  EXPECT_THAT(Complaints(dataset, DatasetFinding::Severity::kFact), HasSubstr("fix1: deviation"));
  EXPECT_THAT(Complaints(dataset, DatasetFinding::Severity::kWarning), HasSubstr("more than one sensor"));
  dataset.fixes.erase(dataset.fixes.begin() + 4, dataset.fixes.begin() + 9);
  dataset.fixes.back().covariance *= 1e-9;
  dataset.fixes[9].p_A.x() += 1000;
  const std::string warnings = Complaints(dataset, DatasetFinding::Severity::kWarning);
  EXPECT_THAT(warnings, HasSubstr("fix1: 1 gaps"));
  EXPECT_THAT(warnings, HasSubstr("is the covariance in m^2?"));
  EXPECT_THAT(warnings, HasSubstr("wrong fixes?"));
}

TEST(DatasetFix, GIVEN_positions_where_nobody_is_THEN_check_names_them) {
  const Dataset sound = WithFixes();
  EXPECT_THAT(Complaints(sound, DatasetFinding::Severity::kWarning), testing::Not(HasSubstr("absurd")));
  const auto shifted = [&sound](const Vector3d& shift, double scale) {
    Dataset dataset = sound;
    for (PositionFix& fix : dataset.fixes) {
      fix.p_A = scale * fix.p_A + shift;
    }
    return dataset;
  };
  const Dataset ecef = shifted(Vector3d(4'279'000, 639'000, 4'672'000), 1);
  EXPECT_THAT(Complaints(ecef, DatasetFinding::Severity::kError),
              testing::AllOf(HasSubstr("fix0: 6 of 6 positions are absurd"),
                             HasSubstr("fix1: 12 of 12 positions are absurd"), HasSubstr("is it ECEF?")));
  // The grid of a map is a frame of a sensor's own, too.
  const Dataset grid = shifted(Vector3d(500'000, 6'350'000, 400), 1);
  EXPECT_EQ(Complaints(grid, DatasetFinding::Severity::kError), "");
  EXPECT_THAT(Complaints(grid, DatasetFinding::Severity::kWarning),
              testing::AllOf(HasSubstr("fix0: 6 of 6 positions are absurd"),
                             HasSubstr("within 100 km of anchor_llh_deg"),
                             testing::Not(HasSubstr("fix1: 12 of 12"))));
  // CGCS2000, zone 39: beyond the Earth, but for a sensor without an anchor a grid.
  const Dataset zone = shifted(Vector3d(39'500'000, 4'400'000, 50), 1);
  EXPECT_THAT(
      Complaints(zone, DatasetFinding::Severity::kError),
      testing::AllOf(HasSubstr("fix0: 6 of 6 positions are absurd"), testing::Not(HasSubstr("fix1"))));
  EXPECT_THAT(Complaints(zone, DatasetFinding::Severity::kWarning), testing::Not(HasSubstr("absurd")));
  const std::string in_nm = Complaints(shifted(Vector3d::Zero(), 1e9), DatasetFinding::Severity::kError);
  EXPECT_THAT(in_nm, HasSubstr("fix1: 11 of 11 steps are faster than 1000 m/s"));
  Dataset one = sound;
  one.fixes[4].p_A.x() = 1e9;
  EXPECT_EQ(Complaints(one, DatasetFinding::Severity::kError), "");
  EXPECT_THAT(Complaints(one, DatasetFinding::Severity::kWarning),
              testing::AllOf(HasSubstr("fix1: 1 of 12 positions are absurd"),
                             HasSubstr("expected a place on the Earth")));
}

TEST(DatasetFix, GIVEN_fixes_that_repeat_THEN_check_names_them) {
  Dataset dataset = WithFixes();
  for (PositionFix& fix : dataset.fixes) {
    fix.p_A = Vector3d(1, 2, 3);
  }
  EXPECT_THAT(
      Complaints(dataset, DatasetFinding::Severity::kWarning),
      testing::AllOf(HasSubstr("fix1: all 12 fixes are at one place"), testing::Not(HasSubstr("fix0: all"))));
}

}  // namespace
}  // namespace alidade
