// Every way a file of a sequence can be wrong that we have met or can think of: the fault is a Status of the
// right code, and its message names the place and what was expected. None of them may crash or be read as
// something plausible.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_check.h"
#include "eval/dataset/dataset_reader.h"
#include "tests/eval/dataset/bad_sequence_fixture.h"
#include "tests/support/good_sequence.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

using test::BadSequence;
using test::FileCase;
using test::kImuHeader;
using test::kImuRows;
using test::kImuYaml;
using test::kTruthHeader;
using test::WriteGoodSequence;

TEST_P(BadSequence, IsAnInputErrorThatNamesThePlace) {
  const test::TemporaryFolder folder;
  WriteGoodSequence(folder);
  ASSERT_TRUE(ReadDataset(folder.path()).ok()) << ReadDataset(folder.path()).message();
  const std::string file = std::string("mav0/") + GetParam().file;
  std::filesystem::remove(folder.File(file));
  if (!GetParam().content.empty()) {
    folder.Write(file, GetParam().content);
  }
  const Result<Dataset> dataset = ReadDataset(folder.path());
  ASSERT_FALSE(dataset.ok());
  EXPECT_EQ(dataset.code(), StatusCode::kInput);
  for (const std::string& said : GetParam().said) {
    EXPECT_THAT(dataset.message(), HasSubstr(said));
  }
}

std::string Imu(const std::string& rows) {
  return kImuHeader + rows;
}
std::string Truth(const std::string& rows) {
  return kTruthHeader + rows;
}

const FileCase kImuCases[] = {
    {"missing IMU", "imu0/data.csv", "", {"imu0/data.csv", "No such file"}},
    {"empty IMU", "imu0/data.csv", " \n\r\n", {"imu0/data.csv", "is empty"}},
    {"header alone", "imu0/data.csv", kImuHeader, {"data.csv", "expected at least two"}},
    {"no header", "imu0/data.csv", kImuRows, {"data.csv:1", "'1000'", "'#timestamp [ns]'"}},
    {"gyro in deg/s",
     "imu0/data.csv",
     "#timestamp [ns],w_RS_S_x [deg s^-1],w_RS_S_y [deg s^-1],w_RS_S_z [deg s^-1],a_RS_S_x [m s^-2],"
     "a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n1000,0,0,0,0,0,9.81\n",
     {"data.csv:1", "column 2", "[deg s^-1]", "[rad s^-1]"}},
    {"stamps in seconds by header",
     "imu0/data.csv",
     "#timestamp [s],w_RS_S_x [rad s^-1]\n1,0\n",
     {"data.csv:1", "'#timestamp [s]'", "[ns]"}},
    {"torn row",
     "imu0/data.csv",
     Imu("1000,0,0,0,0,0,9.81\n2000,0,0,0,0"),
     {"data.csv:3", "torn row", "5 columns", "7"}},
    {"extra column",
     "imu0/data.csv",
     Imu("1000,0,0,0,0,0,9.81,42\n"),
     {"data.csv:2", "8 columns", "'42'", "expected 7"}},
    {"NaN",
     "imu0/data.csv",
     Imu("1000,0,0,nan,0,0,9.81\n"),
     {"data.csv:2", "not finite", "of 1 rows 1 dropped", "at most 5 %"}},
    {"infinite", "imu0/data.csv", Imu("1000,0,0,0,0,-inf,9.81\n"), {"data.csv:2", "not finite"}},
    {"overflow", "imu0/data.csv", Imu("1000,0,0,0,0,1e999,9.81\n"), {"data.csv:2", "column 6", "'1e999'"}},
    {"word",
     "imu0/data.csv",
     Imu("1000,0,0,0,0,0,9.81\n2000,zero,0,0,0,0,9\n"),
     {"data.csv:3", "column 2", "'zero'"}},
    {"empty field", "imu0/data.csv", Imu("1000,0,,0,0,0,9.81\n"), {"data.csv:2", "column 3", "''"}},
    {"trailing letters",
     "imu0/data.csv",
     Imu("1000,0,0,0,0,0,9.81m\n"),
     {"data.csv:2", "column 7", "'9.81m'"}},
    {"stamp as real",
     "imu0/data.csv",
     Imu("1000.5,0,0,0,0,0,9.81\n"),
     {"data.csv:2", "column 1", "'1000.5'", "integer"}},
    {"stamp of 65 bits",
     "imu0/data.csv",
     Imu("99999999999999999999,0,0,0,0,0,9\n"),
     {"data.csv:2", "64 bits"}},
    {"stamps repeat",
     "imu0/data.csv",
     Imu("1000,0,0,0,0,0,9\n1000,0,0,0,0,0,9\n"),
     {"data.csv:3", "'1000'", "expected it once", "of 2 rows 1 dropped (1 duplicate, 0 late, 0 not finite)"}},
    {"stamps go back",
     "imu0/data.csv",
     Imu("50002000,0,0,0,0,0,9\r\n1999,0,0,0,0,0,9\r\n"),
     {"data.csv:3", "'1999'", "50 ms before 50002000", "1 late"}},
    {"stamps as far apart as can be",
     "imu0/data.csv",
     Imu("4600000000000000000,0,0,0,0,0,9\n-4600000000000000000,0,0,0,0,0,9\n"),
     {"data.csv:3", "'-4600000000000000000'", "1 late"}},
    {"a stamp from which differences overflow",
     "imu0/data.csv",
     Imu("-4600000000000000001,0,0,0,0,0,9\n"),
     {"data.csv:2", "column 1", "'-4600000000000000001'",
      "expected a stamp within +-4600000000000000000 ns"}},
    {"missing IMU sheet", "imu0/sensor.yaml", "", {"imu0/sensor.yaml", "No such file"}},
    {"noise missing",
     "imu0/sensor.yaml",
     "sensor_type: imu\ngyroscope_noise_densty: 1e-4\n",
     {"sensor.yaml", "gyroscope_noise_density: is missing", "'gyroscope_noise_densty'"}},
    {"noise negative",
     "imu0/sensor.yaml",
     std::string(kImuYaml).replace(std::string(kImuYaml).find("1e-5"), 4, "-1.0"),
     {"sensor.yaml:4:24", "gyroscope_random_walk", "'-1.0'"}},
    {"gyroscope without noise",
     "imu0/sensor.yaml",
     std::string(kImuYaml).replace(std::string(kImuYaml).find("1e-4"), 4, "0.0"),
     {"sensor.yaml:3:26", "gyroscope_noise_density", "'0.0'", "greater than 0"}},
    {"accelerometer without noise",
     "imu0/sensor.yaml",
     std::string(kImuYaml).replace(std::string(kImuYaml).find("2e-3"), 4, "0"),
     {"sensor.yaml:5:", "accelerometer_noise_density", "'0'", "greater than 0"}},
    {"body is another sensor",
     "imu0/sensor.yaml",
     std::string(kImuYaml) +
         "T_BS: {rows: 4, cols: 4, data: [1, 0, 0, 0.1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n",
     {"sensor.yaml:7:7", "T_BS", "identity"}},
    {"camera sheet in the IMU folder",
     "imu0/sensor.yaml",
     "sensor_type: camera\n",
     {"sensor.yaml:1:14", "'camera'", "'imu'"}},
};
INSTANTIATE_TEST_SUITE_P(Imu, BadSequence, testing::ValuesIn(kImuCases));

constexpr char kTruthFile[] = "state_groundtruth_estimate0/data_pose.csv";
const FileCase kTruthCases[] = {
    {"truth folder without a file",
     kTruthFile,
     "",
     {"state_groundtruth_estimate0", "data.csv, data_pose.csv or data_position.csv"}},
    {"truth of nine columns",
     kTruthFile,
     "#timestamp [ns],a,b,c,d,e,f,g,h\n",
     {"data_pose.csv:1", "9 columns"}},
    {"x y z w order",
     kTruthFile,
     "#timestamp [ns],p_x,p_y,p_z,q_x,q_y,q_z,q_w\n1,0,0,0,0,0,0,1\n",
     {":1", "'q_x'", "q_w"}},
    {"quaternion too long", kTruthFile, Truth("1000,0,0,0,1.1,0,0,0\n"), {"data_pose.csv:2", "norm 1.1"}},
    {"zero quaternion", kTruthFile, Truth("1000,0,0,0,0,0,0,0\n"), {"data_pose.csv:2", "norm 0.0"}},
    {"truth stamps repeat",
     kTruthFile,
     Truth("1000,0,0,0,1,0,0,0\n1000,0,0,0,1,0,0,0\n"),
     {"data_pose.csv:3"}},
    {"truth header alone", kTruthFile, kTruthHeader, {"data_pose.csv", "no pose"}},
};
INSTANTIATE_TEST_SUITE_P(Truth, BadSequence, testing::ValuesIn(kTruthCases));
INSTANTIATE_TEST_SUITE_P(Gnss, BadSequence,
                         testing::Values(FileCase{"observations elsewhere",
                                                  "gnss0/sensor.yaml",
                                                  "p_BA: unknown\nobservations: ../../other/obs.rnx\n",
                                                  {"sensor.yaml:2", "observations",
                                                   "files in the folder of this sheet"}},
                                         FileCase{"ephemerides elsewhere",
                                                  "gnss0/sensor.yaml",
                                                  "p_BA: unknown\nnavigation: [nav.rnx, /tmp/nav.rnx]\n",
                                                  {"navigation", "files in the folder of this sheet"}}));

}  // namespace
}  // namespace alidade
