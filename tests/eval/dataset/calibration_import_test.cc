#include "eval/dataset/calibration_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

// A quarter turn and an offset: p_C = [-y, x, z] + t for T_cam_imu, told apart from its inverse.
constexpr char kRows[] =
    "- [0.0, -1.0, 0.0, 0.1]\n    - [1.0, 0.0, 0.0, 0.2]\n    - [0.0, 0.0, 1.0, 0.3]\n"
    "    - [0.0, 0.0, 0.0, 1.0]\n";

std::string Chain(const std::string& extrinsics, const std::string& lens = "") {
  return "cam0:\n  " + extrinsics + ":\n    " + kRows +
         (lens.empty() ? "  camera_model: pinhole\n  distortion_coeffs: [-0.28, 0.07, 2.0e-04, 1.8e-05]\n"
                         "  distortion_model: radtan\n  intrinsics: [458.6, 457.3, 367.2, 248.4]\n"
                       : lens) +
         "  resolution: [752, 480]\n  rostopic: /cam0/image_raw\n  timeshift_cam_imu: -0.005\n";
}

constexpr char kImu[] =
    "accelerometer_noise_density: 2.0e-3\naccelerometer_random_walk: 3.0e-3\n"
    "gyroscope_noise_density: 1.7e-4\ngyroscope_random_walk: 1.9e-5\nrostopic: /imu0\nupdate_rate: 200.0\n";

std::string Vins(const std::string& model) {
  return "%YAML:1.0\n" + model +
         "image_width: 752\nimage_height: 480\nextrinsicRotation: !!opencv-matrix\n   rows: 3\n   cols: 3\n  "
         " dt: d\n"
         "   data: [0, -1, 0, 1, 0, 0, 0, 0, 1]\nextrinsicTranslation: !!opencv-matrix\n   rows: 3\n   cols: "
         "1\n   dt: d\n"
         "   data: [0.1, 0.2, 0.3]\nacc_n: 0.08\ngyr_n: 0.004\nacc_w: 0.00004\ngyr_w: 2.0e-6\ntd: 0.01\n";
}

class CalibrationImport : public testing::Test {
 protected:
  Result<ImportedCalibration> Import(const std::string& text) {
    return ImportCalibration({folder_.Write("calibration.yaml", text)});
  }
  test::TemporaryFolder folder_;
};

TEST_F(CalibrationImport, KalibrChainAndImu) {
  const Result<ImportedCalibration> found = ImportCalibration(
      {folder_.Write("camchain.yaml", Chain("T_cam_imu")), folder_.Write("imu.yaml", kImu)});
  ASSERT_TRUE(found.ok()) << found.message();
  EXPECT_EQ(found->imu->noise.gyro_noise_density_radps_sqrthz, 1.7e-4);
  EXPECT_EQ(found->imu->noise.accel_random_walk_mps3_sqrthz, 3e-3);
  EXPECT_EQ(found->imu->rate_hz, 200);
  EXPECT_FALSE(found->imu_is_per_sample);
  const CameraSensor& camera = *found->camera;
  EXPECT_EQ(camera.camera.model(), DistortionModel::kRadialTangential);
  EXPECT_EQ(camera.camera.intrinsics(), Eigen::Vector4d(458.6, 457.3, 367.2, 248.4));
  EXPECT_EQ(camera.camera.coefficients()[3], 1.8e-5);
  EXPECT_EQ(camera.time_offset_s, -0.005);
  // T_cam_imu takes the IMU's origin to (0.1, 0.2, 0.3) in the camera.
  EXPECT_LT((camera.T_BC * Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 1e-12);
}

TEST_F(CalibrationImport, OpenVinsNamesTheInverseAndItsFiles) {
  folder_.Write("chain.yaml", "%YAML:1.0\n" + Chain("T_imu_cam"));
  std::string imu = kImu;
  for (size_t at = 0; (at = imu.find('\n', at)) != std::string::npos && at + 1 < imu.size(); at += 3) {
    imu.insert(at + 1, "  ");
  }
  folder_.Write("imu.yaml", "%YAML:1.0\nimu0:\n  " + imu);
  const Result<ImportedCalibration> found =
      Import("%YAML:1.0\nrelative_config_imu: \"imu.yaml\"\nrelative_config_imucam: \"chain.yaml\"\n");
  ASSERT_TRUE(found.ok()) << found.message();
  EXPECT_TRUE(found->imu.has_value());
  EXPECT_LT((found->camera->T_BC.translation - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 1e-12);
}

TEST_F(CalibrationImport, KalibrOmniIsMei) {
  const Result<ImportedCalibration> found =
      Import(Chain("T_cam_imu",
                   "  camera_model: omni\n  distortion_model: radtan\n"
                   "  distortion_coeffs: [-0.06, 0.85, -6.4e-4, 1.5e-3]\n"
                   "  intrinsics: [1.85, 1338.0, 1340.0, 379.0, 218.0]\n"));
  ASSERT_TRUE(found.ok()) << found.message();
  EXPECT_EQ(found->camera->camera.model(), DistortionModel::kMei);
  EXPECT_EQ(found->camera->camera.intrinsics()[0], 1338);
  EXPECT_EQ(found->camera->camera.coefficients()[0], 1.85);
  EXPECT_EQ(found->camera->camera.coefficients()[4], 1.5e-3);
}

TEST_F(CalibrationImport, VinsModels) {
  const struct {
    const char* text;
    DistortionModel model;
    double focal, first;
  } cases[] = {
      {"model_type: PINHOLE\ndistortion_parameters:\n   k1: -0.29\n   k2: 0.08\n   p1: 5.0e-5\n"
       "   p2: -1.5e-4\nprojection_parameters:\n   fx: 461.6\n   fy: 460.3\n   cx: 363.0\n   cy: 248.1\n",
       DistortionModel::kRadialTangential, 461.6, -0.29},
      {"model_type: MEI\nmirror_parameters:\n   xi: 1.85\ndistortion_parameters:\n   k1: -0.06\n"
       "   k2: 0.85\n   p1: -6.4e-4\n   p2: 1.5e-3\nprojection_parameters:\n   gamma1: 1338.2\n"
       "   gamma2: 1340.1\n   u0: 378.8\n   v0: 217.7\n",
       DistortionModel::kMei, 1338.2, 1.85},
      {"model_type: KANNALA_BRANDT\nprojection_parameters:\n   k2: 3.0e-3\n   k3: 7.0e-4\n   k4: -2.0e-3\n"
       "   k5: 2.0e-4\n   mu: 190.9\n   mv: 190.8\n   u0: 254.9\n   v0: 256.9\n",
       DistortionModel::kEquidistant, 190.9, 3e-3}};
  for (const auto& c : cases) {
    const Result<ImportedCalibration> found = Import(Vins(c.text));
    ASSERT_TRUE(found.ok()) << found.message();
    EXPECT_EQ(found->camera->camera.model(), c.model);
    EXPECT_EQ(found->camera->camera.intrinsics()[0], c.focal);
    EXPECT_EQ(found->camera->camera.coefficients()[0], c.first);
    // extrinsicRotation and extrinsicTranslation take the camera to the IMU.
    EXPECT_LT((found->camera->T_BC.translation - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 1e-12);
    EXPECT_LT((found->camera->T_BC * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0.1, 1.2, 0.3)).norm(),
              1e-12);
    EXPECT_EQ(found->camera->time_offset_s, 0.01);
    EXPECT_TRUE(found->imu_is_per_sample);
    EXPECT_NEAR(DensitiesOf(found->imu->noise, 200).gyro_noise_density_radps_sqrthz, 2.828427e-4, 1e-9);
  }
}

TEST_F(CalibrationImport, NamesWhatIsWrong) {
  EXPECT_THAT(Import("a: 1\n").message(), HasSubstr("none of the keys"));
  EXPECT_THAT(ImportCalibration({folder_.File("none.yaml")}).message(), HasSubstr("none.yaml"));
  EXPECT_THAT(Import("model_type: SCARAMUZZA\n").message(), HasSubstr("model_type"));
  EXPECT_THAT(Import(Vins("model_type: PINHOLE\nprojection_parameters:\n   fx: 1\n")).message(),
              HasSubstr("fy"));
  EXPECT_THAT(Import("relative_config_imu: calibration.yaml\n").message(), HasSubstr("names itself"));
  std::string chain = Chain("T_cam_imu");
  chain.replace(chain.find("T_cam_imu"), 9, "T_cam_xxx");
  EXPECT_THAT(Import(chain).message(), HasSubstr("no extrinsics"));
  chain = Chain("T_cam_imu");
  chain.replace(chain.find("- [1.0, 0.0"), 11, "- [2.0, 0.0");
  EXPECT_THAT(Import(chain).message(), HasSubstr("rigid"));
}

}  // namespace
}  // namespace alidade
