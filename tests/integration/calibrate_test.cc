#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "eval/dataset/sensor_yaml.h"
#include "tests/integration/command.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string SimulateFigureEight(const TemporaryFolder& folder, const std::string& settings) {
  std::string sequence = folder.File("seq");
  const CommandResult made = Alidade("simulate --config=" + Source("configs/datasets/figure8.yaml") +
                                     " --seed=31 --set=" + "duration_s=30,path_m=39" + settings +
                                     " --output=" + sequence + " --quiet");
  EXPECT_EQ(made.code, 0) << made.output;
  return sequence;
}

/// A sequence of links to the files of a phone's recording.
std::string LinkedPhone(const TemporaryFolder& folder) {
  const std::filesystem::path from = SharedDir() + "/data/real_images/phone_102213",
                              to = folder.File("phone");
  std::filesystem::create_directory(to);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(from)) {
    const std::filesystem::path place = to / entry.path().lexically_relative(from);
    if (entry.is_directory()) {
      std::filesystem::create_directory(place);
    } else {
      std::filesystem::create_symlink(entry.path(), place);
    }
  }
  return to;
}

/// Rewrites a sheet of the camera.
template <typename Change>
void ChangeCamera(const std::string& sequence, const Change& change) {
  const std::string path = sequence + "/mav0/cam0/sensor.yaml";
  Result<CameraSensor> sensor = ReadCameraSensor(path);
  ASSERT_TRUE(sensor.ok()) << sensor.message();
  RigCalibration rig;
  rig.camera = sensor->camera;
  rig.T_BC = sensor->T_BC;
  rig.camera_time_offset_s = sensor->time_offset_s;
  change(&rig);
  std::filesystem::remove(path);  // it may be a link
  std::ofstream(path) << CameraSensorYaml(rig, sensor->rate_hz.value_or(0));
}

// GIVEN a sheet that is wrong by 2 deg, 20 ms and 2 % WHEN it is checked THEN each is named; WHEN the camera
// is calibrated THEN the written sheet passes, and a run with it is right.
TEST(Calibrate, AWrongSheetIsReportedAndReplaced) {
  TemporaryFolder folder;
  const std::string sequence = SimulateFigureEight(
      folder,
      ",calibration_rotation_error_rad=0.035,calibration_time_error_s=0.02,calibration_focal_error_px=10");
  const CommandResult wrong = Alidade("check --dataset=" + sequence);
  EXPECT_EQ(wrong.code, 0) << wrong.output;
  EXPECT_THAT(wrong.output, AllOf(HasSubstr("warning  cam0: time_offset_s"), HasSubstr("warning  cam0: T_BS"),
                                  HasSubstr("warning  cam0: intrinsics")));

  const CommandResult found = Alidade("calibrate --dataset=" + sequence + " --output=" + folder.File("out"));
  ASSERT_EQ(found.code, 0) << found.output;
  EXPECT_THAT(found.output, AllOf(HasSubstr("second half"), HasSubstr("lever arm, body x")));
  const nlohmann::json json = nlohmann::json::parse(ReadFile(folder.File("out/calibrate.json")));
  EXPECT_GT(json["changes"]["focal"]["std"].get<double>(), 0);
  EXPECT_LT(json["halves_sigma"].get<double>(), 5);

  std::filesystem::copy_file(folder.File("out/mav0/cam0/sensor.yaml"), sequence + "/mav0/cam0/sensor.yaml",
                             std::filesystem::copy_options::overwrite_existing);
  const CommandResult right = Alidade("check --dataset=" + sequence);
  EXPECT_THAT(right.output, AllOf(HasSubstr("cam0 against the gyroscope"), Not(HasSubstr("warning  cam0"))));

  EXPECT_EQ(Alidade("calibrate --dataset=" + sequence + " --output=" + folder.File("out")).code, 6);
}

// GIVEN an inverted T_BS, or a negated gyroscope WHEN an estimator is to run THEN it does not, and the
// message names it.
TEST(Calibrate, ARunWithWrongAxesDoesNotBegin) {
  TemporaryFolder folder;
  const std::string sequence = SimulateFigureEight(folder, "");
  const std::string words = "run --config=" + Source("configs/base.yaml") +
                            " --set=init.method=truth --dataset=" + sequence + " --output=";
  std::filesystem::copy(sequence, folder.File("kept"), std::filesystem::copy_options::recursive);
  ChangeCamera(sequence, [](RigCalibration* rig) { rig->T_BC = rig->T_BC.Inverse(); });
  const CommandResult inverse = Alidade(words + folder.File("inverse"));
  EXPECT_EQ(inverse.code, 4) << inverse.output;
  EXPECT_THAT(inverse.output, HasSubstr("T_BS is the inverse"));

  std::string table = ReadFile(folder.File("kept/mav0/imu0/data.csv"));
  std::string negated;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    if (line[0] != '#') {
      std::vector<std::string> fields;
      std::istringstream row(line);
      for (std::string field; std::getline(row, field, ',');) {
        fields.push_back(field);
      }
      for (std::size_t axis = 1; axis <= 3; ++axis) {
        fields[axis] = fields[axis][0] == '-' ? fields[axis].substr(1) : "-" + fields[axis];
      }
      line.clear();
      for (const std::string& field : fields) {
        line += (line.empty() ? "" : ",") + field;
      }
    }
    negated += line + "\n";
  }
  folder.Write("kept/mav0/imu0/data.csv", negated);
  const CommandResult sign = Alidade("run --config=" + Source("configs/base.yaml") +
                                     " --set=init.method=truth --dataset=" + folder.File("kept") +
                                     " --output=" + folder.File("sign"));
  EXPECT_EQ(sign.code, 4) << sign.output;
  EXPECT_THAT(sign.output, HasSubstr("once they are negated"));
}

TEST(Calibrate, ARecordingAtRestIsRefusedWithAReason) {
  TemporaryFolder folder;
  const std::string sequence = folder.File("seq");
  ASSERT_EQ(Alidade("simulate --config=" + Source("configs/datasets/figure8_short.yaml") +
                    " --set=duration_s=10,path_m=0.1,rest_s=5 --output=" + sequence + " --quiet")
                .code,
            0);
  const CommandResult found = Alidade("calibrate --dataset=" + sequence + " --output=" + folder.File("out"));
  EXPECT_EQ(found.code, 4);
  EXPECT_THAT(found.output, HasSubstr("pairs of images in motion"));
}

// GIVEN a sequence without the IMU's sheet whose samples cannot be read WHEN it is calibrated THEN what was
// staged is removed, and the folder is as good as new.
TEST(Calibrate, AFaultOfTheSequenceLeavesNoProvisionalSheets) {
  TemporaryFolder folder;
  const std::string sequence = folder.File("seq");
  ASSERT_EQ(Alidade("simulate --config=" + Source("configs/datasets/figure8_short.yaml") +
                    " --set=duration_s=2,path_m=2.6 --output=" + sequence + " --quiet")
                .code,
            0);
  std::filesystem::remove(sequence + "/mav0/imu0/sensor.yaml");
  std::ofstream(sequence + "/mav0/imu0/data.csv") << "no table\n";
  const CommandResult found = Alidade("calibrate --dataset=" + sequence + " --output=" + folder.File("out"));
  EXPECT_EQ(found.code, 4) << found.output;
  EXPECT_THAT(found.output, HasSubstr("imu0/data.csv"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.File("out")));
}

TEST(Calibrate, ThePhonesTimeOffsetIsReported) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  TemporaryFolder folder;
  const std::string sequence = LinkedPhone(folder);
  ChangeCamera(sequence, [](RigCalibration* rig) { rig->camera_time_offset_s = 0; });
  const CommandResult result = Alidade("check --dataset=" + sequence);
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("warning  cam0: time_offset_s: images and gyroscope agree at -0.03"),
                    HasSubstr("rolling shutter")));
}

// GIVEN images and IMU of a phone and no sheet WHEN it is calibrated THEN the output is a sequence that runs.
TEST(Calibrate, APhoneWithoutAnySheetRunsAfterCalibration) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  TemporaryFolder folder;
  const std::string sequence = LinkedPhone(folder);
  std::filesystem::remove(sequence + "/mav0/cam0/sensor.yaml");
  std::filesystem::remove(sequence + "/mav0/imu0/sensor.yaml");
  const CommandResult found = Alidade("calibrate --dataset=" + sequence + " --output=" + folder.File("out"));
  ASSERT_EQ(found.code, 0) << found.output;
  EXPECT_THAT(found.output, HasSubstr("noise of a consumer IMU is assumed"));
  const Result<CameraSensor> sheet = ReadCameraSensor(folder.File("out/mav0/cam0/sensor.yaml"));
  ASSERT_TRUE(sheet.ok()) << sheet.message();
  EXPECT_NEAR(sheet->camera.intrinsics()[0], 480, 12);
  EXPECT_NEAR(sheet->time_offset_s, -0.036, 0.006);
  EXPECT_FALSE(std::filesystem::exists(folder.File("out/provisional")));
  EXPECT_FALSE(std::filesystem::exists(sequence + "/mav0/cam0/sensor.yaml"));

  const CommandResult run = Alidade("run --config=" + Source("configs/estimators/alidade_filter.yaml") +
                                    " --dataset=" + folder.File("out") + " --output=" + folder.File("run"));
  // The watch doubts the time offset of this recording for a while, which is less than half of it.
  EXPECT_EQ(run.code, 0) << run.output;
  const nlohmann::json json = nlohmann::json::parse(ReadFile(folder.File("run/run.json")));
  EXPECT_EQ(json["status"], "ok");
  EXPECT_FALSE(json.contains("restarts"));
}

TEST(Calibrate, ThePublishedSheetsOfOtherRecordingsPass) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  for (const char* name : {"ovsim/gore_px1_seed1", "ovsim/v101_px1_seed1", "real_images/v1_01_flight_4s"}) {
    const CommandResult result = Alidade("check --dataset=" + SharedDir() + "/data/" + name);
    EXPECT_EQ(result.code, 0);
    EXPECT_THAT(result.output,
                AllOf(HasSubstr("cam0 against the gyroscope"), Not(HasSubstr("gyroscope agree"))))
        << name;
  }
}

}  // namespace
}  // namespace alidade::test
