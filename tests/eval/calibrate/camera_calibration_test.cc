#include "eval/calibrate/camera_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "eval/calibrate/camera_report.h"
#include "eval/dataset/sensor_yaml.h"
#include "tests/eval/calibrate/shaken_camera.h"
#include "tests/support/read_file.h"
#include "tests/support/scenario.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;
using Coordinate = CameraGyroCoordinate;

/// A minute of figure-8 with a sheet that is wrong by 2 deg, 2 cm, 10 ms and 10 px.
class CalibratedFigureEight : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    SimulatorConfig simulation;
    simulation.duration_s = 60;
    simulation.path_m = 78;
    simulation.calibration_rotation_error_rad = 0.035;
    simulation.calibration_translation_error_m = 0.02;
    simulation.calibration_time_error_s = 0.01;
    simulation.calibration_focal_error_px = 10;
    dataset_ = new Dataset(SimulateOrDie(simulation, 21));
    EstimatorConfig config;
    config.vision.pixel_noise_px = simulation.pixel_noise_px;
    MeasurementLog log{dataset_->rig, dataset_->imu, dataset_->frames};
    camera_ = new Result<CalibratedCamera>(CalibrateCamera(config, log, {}));
  }
  static void TearDownTestSuite() {
    delete camera_;
    delete dataset_;
  }

  static const Dataset* dataset_;
  static const Result<CalibratedCamera>* camera_;
};
const Dataset* CalibratedFigureEight::dataset_ = nullptr;
const Result<CalibratedCamera>* CalibratedFigureEight::camera_ = nullptr;

TEST_F(CalibratedFigureEight, TheCameraIsFoundWithinItsDeviations) {
  ASSERT_TRUE(camera_->ok()) << camera_->message();
  const RigCalibration& truth = *dataset_->true_rig;
  const RigCalibration& found = (*camera_)->rig;
  const CameraGyroError& deviations = (*camera_)->fit.deviations;
  const Eigen::Vector3d turn = so3::Log(found.T_BC.rotation.transpose() * truth.T_BC.rotation);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(std::abs(turn[axis]), 4 * deviations[Coordinate::kRotation + axis]);
  }
  EXPECT_LT(turn.norm(), 0.01);
  EXPECT_LT(std::abs(found.camera_time_offset_s - truth.camera_time_offset_s),
            4 * deviations[Coordinate::kTimeOffset]);
  EXPECT_LT(std::abs(found.camera_time_offset_s - truth.camera_time_offset_s), 2e-3);
  const double focal = found.camera.intrinsics()[0] / truth.camera.intrinsics()[0] - 1;
  EXPECT_LT(std::abs(focal), 4 * deviations[Coordinate::kFocal]);
  EXPECT_LT(std::abs(focal), 0.01);
}

TEST_F(CalibratedFigureEight, TheLeverArmIsFoundWithinItsDeviations) {
  ASSERT_TRUE(camera_->ok()) << camera_->message();
  ASSERT_TRUE((*camera_)->lever_arm.has_value());
  const CameraLeverArm& arm = *(*camera_)->lever_arm;
  const Eigen::Vector3d error = arm.p_BC - dataset_->true_rig->T_BC.translation;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(std::abs(error[axis]), 4 * arm.deviations[axis]) << axis;
  }
  EXPECT_LT(error.norm(), 0.015);
}

TEST_F(CalibratedFigureEight, TheHalvesAgree) {
  ASSERT_TRUE(camera_->ok()) << camera_->message();
  EXPECT_GT((*camera_)->halves_sigma, 0);
  EXPECT_LT((*camera_)->halves_sigma, 4);
}

TEST_F(CalibratedFigureEight, SheetAndReportAreWritten) {
  ASSERT_TRUE(camera_->ok()) << camera_->message();
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteCalibratedCamera(**camera_, dataset_->rig, "figure8", 10, folder.path()).ok());
  const Result<CameraSensor> sheet = ReadCameraSensor(folder.path() + "/mav0/cam0/sensor.yaml");
  ASSERT_TRUE(sheet.ok()) << sheet.message();
  EXPECT_EQ(sheet->camera.intrinsics(), (*camera_)->rig.camera.intrinsics());
  EXPECT_EQ(sheet->time_offset_s, (*camera_)->rig.camera_time_offset_s);
  const auto json = nlohmann::json::parse(ReadFile(folder.path() + "/calibrate.json"));
  EXPECT_EQ(json["changes"]["time_offset"]["unit"], "ms");
  EXPECT_GT(json["changes"]["time_offset"]["std"].get<double>(), 0);
  EXPECT_EQ(json["lever_arm"]["p_BC_m"].size(), 3U);
  const std::string table = CalibratedCameraTable(**camera_, dataset_->rig, 10);
  EXPECT_THAT(table, HasSubstr("time offset"));
  EXPECT_THAT(table, HasSubstr("second half"));
  EXPECT_THAT(table, HasSubstr("T_BS"));
}

TEST(CameraCalibrationTest, AShortRecordingIsRefusedWithWhatIsMissing) {
  ShakenCamera recording{PhoneModel()};
  recording.duration_s = 4;
  CameraCalibrationOptions options;
  options.lever_arm = false;
  const Result<CalibratedCamera> camera = CalibrateCamera({}, recording.Record(), options);
  ASSERT_TRUE(camera.ok()) << camera.message();
  ASSERT_EQ(camera->remarks.size(), 1U);
  EXPECT_THAT(camera->remarks[0], HasSubstr("too short"));
}

TEST(CameraCalibrationTest, AGuessedFocalLengthIsEnough) {
  const ShakenCamera recording{PhoneModel()};
  MeasurementLog log = recording.Record();
  const Result<CameraModel> guess =
      CameraModel::Create(DistortionModel::kRadialTangential, {700, 700, 320, 240}, {0, 0, 0, 0}, 640, 480);
  log.rig.camera = *guess;
  log.rig.T_BC.rotation.setIdentity();
  CameraCalibrationOptions options;
  options.lever_arm = false;
  options.focal_factors = {0.6, 0.8, 1};
  const Result<CalibratedCamera> camera = CalibrateCamera({}, log, options);
  ASSERT_TRUE(camera.ok()) << camera.message();
  EXPECT_NEAR(camera->rig.camera.intrinsics()[0], 480, 6);
  EXPECT_LT(so3::Log(camera->rig.T_BC.rotation.transpose() * recording.model.R_BC).norm(), 0.01);
}

// GIVEN clocks seconds apart THEN a long recording is refused for it, and with a short one it is said.
TEST(CalibrateCamera, ClocksSecondsApartAreRefusedOrReported) {
  for (const double duration_s : {40.0, 20.0}) {
    MeasurementLog log = ShakenCamera{.model = PhoneModel(), .duration_s = duration_s}.Record();
    for (TrackFrame& frame : log.frames) {
      frame.stamp_ns += SecondsToNs(4);
    }
    std::string said;
    CameraCalibrationOptions options;
    options.lever_arm = false;
    options.progress = [&said](const std::string& line) { said += line + "\n"; };
    const Result<CalibratedCamera> camera = CalibrateCamera(EstimatorConfig(), log, options);
    const std::string text = "the clocks of camera and imu0 differ";
    if (duration_s > 30) {
      ASSERT_FALSE(camera.ok());
      EXPECT_THAT(camera.message(), HasSubstr(text));
    } else {
      EXPECT_THAT(said, HasSubstr(text));
    }
  }
}

}  // namespace
}  // namespace alidade::test
