#include "eval/peers/msceqf_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/dataset/calibration_import.h"
#include "tests/eval/peers/peer_rig.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::PeerRig;
using testing::HasSubstr;

// The camera's keys are those of Kalibr's chain, which our importer reads below a camera's name.
TEST(MsceqfFile, HoldsLensExtrinsicsAndTimeOffsetOfTheSheet) {
  const test::TemporaryFolder folder;
  for (const DistortionModel model : {DistortionModel::kRadialTangential, DistortionModel::kEquidistant}) {
    const RigCalibration rig = PeerRig(model);
    const Result<std::string> text = MsceqfFile(rig, {});
    ASSERT_TRUE(text.ok()) << text.message();
    std::string chain = "cam0:\n  camera_model: pinhole\n";
    std::istringstream lines(*text);
    for (std::string line; std::getline(lines, line) && line.find("extended_pose_std") != 0;) {
      chain += "  " + line + "\n";
    }
    const Result<ImportedCalibration> read = ImportCalibration({folder.Write("chain.yaml", chain)}, "cam0");
    ASSERT_TRUE(read.ok() && read->camera) << read.message();
    EXPECT_EQ(read->camera->camera.model(), model);
    EXPECT_EQ(read->camera->camera.intrinsics(), rig.camera.intrinsics());
    EXPECT_EQ(read->camera->camera.coefficients(), rig.camera.coefficients());
    EXPECT_LT((read->camera->T_BC.rotation - rig.T_BC.rotation).norm(), 1e-9);
    EXPECT_LT((read->camera->T_BC.translation - rig.T_BC.translation).norm(), 1e-12);
    EXPECT_THAT(*text, HasSubstr("timeshift_cam_imu: -0.0125"));
    EXPECT_THAT(*text, HasSubstr("resolution: [752, 480]\n"));
  }
  EXPECT_THAT(MsceqfFile(PeerRig(DistortionModel::kMei), {}).message(), HasSubstr("no lens model"));
}

TEST(MsceqfFile, HoldsTheSettings) {
  MsceqfSettings settings;
  settings.gyro_noise = 0.001;
  settings.clones = 20;
  settings.extrinsics_std = 0.5;
  const Result<std::string> text = MsceqfFile(PeerRig(DistortionModel::kRadialTangential), settings);
  ASSERT_TRUE(text.ok()) << text.message();
  EXPECT_THAT(*text, HasSubstr("gyroscope_noise_density: 0.001"));
  EXPECT_THAT(*text, HasSubstr("num_clones: 20\n"));
  EXPECT_THAT(*text, HasSubstr("extrinsics_std: [0.5, 0.5, 0.5, 0.5, 0.5, 0.5]\n"));
}

}  // namespace
}  // namespace alidade
