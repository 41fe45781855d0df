#include "eval/dataset/calibration_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

// A quarter turn and an offset: p_C = [-y, x, z] + t for T_cam_imu, different from its inverse.
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

TEST_F(CalibrationImport, KalibrDoubleSphereAndEucm) {
  const Result<ImportedCalibration> ds =
      Import(Chain("T_cam_imu",
                   "  camera_model: ds\n  distortion_model: none\n  distortion_coeffs: []\n"
                   "  intrinsics: [-0.18, 0.59, 211.0, 212.0, 379.0, 218.0]\n"));
  ASSERT_TRUE(ds.ok()) << ds.message();
  EXPECT_EQ(ds->camera->camera.model(), DistortionModel::kDoubleSphere);
  EXPECT_EQ(ds->camera->camera.intrinsics(), Eigen::Vector4d(211, 212, 379, 218));
  EXPECT_EQ(ds->camera->camera.coefficients().head<2>(), Eigen::Vector2d(-0.18, 0.59));
  EXPECT_LT((ds->camera->T_BC * Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 1e-12);
  const Result<ImportedCalibration> eucm = Import(
      Chain("T_cam_imu", "  camera_model: eucm\n  intrinsics: [0.6, 1.1, 281.0, 282.0, 379.0, 218.0]\n"));
  ASSERT_TRUE(eucm.ok()) << eucm.message();
  EXPECT_EQ(eucm->camera->camera.model(), DistortionModel::kEucm);
  EXPECT_EQ(eucm->camera->camera.coefficients().head<2>(), Eigen::Vector2d(0.6, 1.1));
}

std::string Basalt(const std::string& lens, const std::string& pose = "") {
  const std::string half = "0.7071067811865476";
  return "{\n  \"value0\": {\n    \"T_imu_cam\": [" +
         (pose.empty() ? "{\"px\": 0.1, \"py\": 0.2, \"pz\": 0.3, \"qx\": 0.0, \"qy\": 0.0, \"qz\": " + half +
                             ", \"qw\": " + half + "}"
                       : pose) +
         "],\n    \"intrinsics\": [" + lens +
         "],\n    \"resolution\": [[512, 510]],\n    \"calib_accel_bias\": [0.0, 0.0, 0.0],\n"
         "    \"imu_update_rate\": 200.0,\n    \"accel_noise_std\": [0.016, 0.016, 0.016],\n"
         "    \"gyro_noise_std\": [0.0002, 0.0002, 0.00035],\n    \"accel_bias_std\": [0.001, 0.001, "
         "0.001],\n"
         "    \"gyro_bias_std\": [0.0001, 0.0001, 0.0001],\n    \"cam_time_offset_ns\": -2000000,\n"
         "    \"vignette\": []\n  }\n}\n";
}

std::string BasaltLens(const std::string& type, const std::string& coefficients) {
  return "{\"camera_type\": \"" + type +
         "\", \"intrinsics\": {\"fx\": 158.2, \"fy\": 158.3, \"cx\": 254.9, \"cy\": 256.8" + coefficients +
         "}}";
}

TEST_F(CalibrationImport, BasaltLensesAndImu) {
  const struct {
    const char* type;
    const char* coefficients;
    DistortionModel model;
    Eigen::Vector4d expected;
  } cases[] = {
      {"ds", ", \"xi\": -0.17, \"alpha\": 0.59", DistortionModel::kDoubleSphere, {-0.17, 0.59, 0, 0}},
      {"eucm", ", \"alpha\": 0.6, \"beta\": 1.1", DistortionModel::kEucm, {0.6, 1.1, 0, 0}},
      {"kb4",
       ", \"k1\": 0.003, \"k2\": 0.0007, \"k3\": -0.002, \"k4\": 0.0002",
       DistortionModel::kEquidistant,
       {0.003, 0.0007, -0.002, 0.0002}},
      {"pinhole", "", DistortionModel::kNone, {0, 0, 0, 0}}};
  for (const auto& c : cases) {
    const Result<ImportedCalibration> found = Import(Basalt(BasaltLens(c.type, c.coefficients)));
    ASSERT_TRUE(found.ok()) << found.message();
    const CameraSensor& camera = *found->camera;
    EXPECT_EQ(camera.camera.model(), c.model);
    EXPECT_EQ(camera.camera.intrinsics(), Eigen::Vector4d(158.2, 158.3, 254.9, 256.8));
    EXPECT_EQ(camera.camera.coefficients().head<4>(), c.expected);
    EXPECT_EQ(camera.camera.width_px(), 512);
    EXPECT_EQ(camera.camera.height_px(), 510);
    EXPECT_EQ(camera.time_offset_s, -0.002);
    // A quarter turn about z from the camera to the IMU.
    EXPECT_LT((camera.T_BC * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0.1, 1.2, 0.3)).norm(), 1e-12);
    EXPECT_FALSE(found->imu_is_per_sample);
    EXPECT_EQ(found->imu->noise.accel_noise_density_mps2_sqrthz, 0.016);
    EXPECT_EQ(found->imu->noise.accel_random_walk_mps3_sqrthz, 0.001);
    EXPECT_NEAR(found->imu->noise.gyro_noise_density_radps_sqrthz, std::sqrt((2 * 0.04 + 0.1225) / 3) * 1e-3,
                1e-12);
    EXPECT_EQ(found->imu->rate_hz, 200);
  }
}

TEST_F(CalibrationImport, BasaltFaultsAreNamed) {
  const auto message = [this](const std::string& text) { return std::string(Import(text).message()); };
  EXPECT_THAT(message(Basalt(BasaltLens("ucm", ", \"alpha\": 0.6"))),
              testing::AllOf(HasSubstr("value0.intrinsics[0].camera_type"), HasSubstr("found 'ucm'")));
  EXPECT_THAT(message(Basalt(BasaltLens("ds", ", \"xi\": -0.17"))),
              HasSubstr("value0.intrinsics[0].intrinsics.alpha"));
  EXPECT_THAT(message(Basalt(BasaltLens("ds", ", \"xi\": -0.17, \"alpha\": 1.5"))),
              testing::AllOf(HasSubstr("calibration.yaml"), HasSubstr("alpha must lie in [0, 1]")));
  EXPECT_THAT(
      message(Basalt(BasaltLens("pinhole", ""),
                     "{\"px\": 0, \"py\": 0, \"pz\": 0, \"qx\": 0, \"qy\": 0, \"qz\": 0, \"qw\": 2}")),
      HasSubstr("unit length"));
  EXPECT_THAT(message(Basalt("")), HasSubstr("value0.intrinsics[0].camera_type"));
  const std::string path = folder_.Write("calibration.json", Basalt(BasaltLens("pinhole", "")));
  EXPECT_THAT(ImportCalibration({path}, "cam1").message(), HasSubstr("the lens of cam1"));
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

// GIVEN a configuration of two cameras, THEN lens and place are those of the camera that is asked for.
TEST_F(CalibrationImport, VinsFollowsTheFileOfTheCamera) {
  const auto lens = [](const std::string& focal) {
    return "%YAML:1.0\nmodel_type: PINHOLE\nimage_width: 752\nimage_height: 480\ndistortion_parameters:\n"
           "   k1: 0\n   k2: 0\n   p1: 0\n   p2: 0\nprojection_parameters:\n   fx: " +
           focal + "\n   fy: 460.3\n   cx: 363.0\n   cy: 248.1\n";
  };
  const auto place = [](const std::string& camera, const std::string& x) {
    return "body_T_" + camera + ": !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: d\n   data: [1, 0, 0, " +
           x + ", 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n";
  };
  folder_.Write("left.yaml", lens("461.0"));
  const std::string right = folder_.Write("right.yaml", lens("462.0"));
  const std::string places = "%YAML:1.0\n" + place("cam0", "0.1") + place("cam1", "0.2");
  const std::string both =
      folder_.Write("both.yaml", places + "cam0_calib: \"left.yaml\"\ncam1_calib: \"right.yaml\"\n");
  for (const auto& [camera, focal, x] : {std::tuple("cam0", 461.0, 0.1), std::tuple("cam1", 462.0, 0.2)}) {
    const Result<ImportedCalibration> found = ImportCalibration({both}, camera);
    ASSERT_TRUE(found.ok()) << found.message();
    EXPECT_EQ(found->camera->camera.intrinsics()[0], focal);
    EXPECT_NEAR(found->camera->T_BC.translation.x(), x, 1e-12);
  }
  const std::string left_alone = folder_.Write("left_alone.yaml", places + "cam0_calib: \"left.yaml\"\n");
  EXPECT_THAT(ImportCalibration({left_alone}, "cam1").message(),
              testing::AllOf(HasSubstr("left_alone.yaml: cam1_calib: is missing"),
                             HasSubstr("expected the file with the lens of cam1")));
  const Result<ImportedCalibration> given = ImportCalibration({left_alone, right}, "cam1");
  ASSERT_TRUE(given.ok()) << given.message();
  EXPECT_EQ(given->camera->camera.intrinsics()[0], 462);
  EXPECT_NEAR(given->camera->T_BC.translation.x(), 0.2, 1e-12);
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
  EXPECT_THAT(Import(Chain("T_cam_imu",
                           "  camera_model: ds\n  distortion_model: radtan\n"
                           "  intrinsics: [0.1, 0.5, 200.0, 200.0, 379.0, 218.0]\n"))
                  .message(),
              HasSubstr("distortion_model: found 'radtan' with 'ds'"));
  EXPECT_THAT(
      Import(Chain("T_cam_imu", "  camera_model: eucm\n  intrinsics: [0.5, 200.0, 200.0, 379.0, 218.0]\n"))
          .message(),
      HasSubstr("expected 6 numbers"));
  EXPECT_THAT(Import(Chain("T_cam_imu",
                           "  camera_model: eucm\n"
                           "  intrinsics: [0.5, -1.0, 200.0, 200.0, 379.0, 218.0]\n"))
                  .message(),
              testing::AllOf(HasSubstr("calibration.yaml"), HasSubstr("beta must lie in (0, 100]")));
  EXPECT_THAT(Import(Chain("T_cam_imu", "  camera_model: ucm\n")).message(), HasSubstr("ds or eucm"));
  chain = Chain("T_cam_imu");
  chain.replace(chain.find("- [1.0, 0.0"), 11, "- [2.0, 0.0");
  EXPECT_THAT(Import(chain).message(), HasSubstr("rigid"));
}

}  // namespace
}  // namespace alidade
