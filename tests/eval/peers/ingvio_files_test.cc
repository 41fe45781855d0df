#include "eval/peers/ingvio_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/dataset/calibration_import.h"
#include "tests/eval/peers/peer_rig.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::PeerRig;
using testing::HasSubstr;

// The format is that of VINS-Mono's family, which our importer reads.
TEST(IngvioCameraFile, HoldsLensAndExtrinsicsOfTheSheet) {
  const test::TemporaryFolder folder;
  for (const DistortionModel model : {DistortionModel::kRadialTangential, DistortionModel::kMei}) {
    const RigCalibration rig = PeerRig(model);
    const Result<std::string> text = IngvioCameraFile(rig, {});
    ASSERT_TRUE(text.ok()) << text.message();
    const Result<ImportedCalibration> read = ImportCalibration({folder.Write("camera.yaml", *text)}, "cam0");
    ASSERT_TRUE(read.ok() && read->camera) << read.message();
    EXPECT_EQ(read->camera->camera.model(), model);
    EXPECT_EQ(read->camera->camera.intrinsics(), rig.camera.intrinsics());
    EXPECT_EQ(read->camera->camera.coefficients(), rig.camera.coefficients());
    EXPECT_LT((read->camera->T_BC.rotation - rig.T_BC.rotation).norm(), 1e-9);
    EXPECT_EQ(read->camera->T_BC.translation, rig.T_BC.translation);
    EXPECT_THAT(*text, HasSubstr("max_cnt: 150\n"));
    EXPECT_THAT(*text, HasSubstr("image_width: 752\n"));
  }
  EXPECT_THAT(IngvioCameraFile(PeerRig(DistortionModel::kEquidistant), {}).message(),
              HasSubstr("no lens model"));
}

TEST(IngvioFile, HoldsTheSettings) {
  IngvioSettings settings;
  settings.gyro_noise = 0.001;
  settings.clones = 20;
  settings.local_less_gpst_s = -1699999982.25;
  const std::string text = IngvioFile(settings, "/a/camera.yaml");
  EXPECT_THAT(text, HasSubstr("cam_left_file_path: \"/a/camera.yaml\"\n"));
  EXPECT_THAT(text, HasSubstr("noise_gyro: 0.001"));
  EXPECT_THAT(text, HasSubstr("max_sliding_window_poses: 20\n"));
  EXPECT_THAT(text, HasSubstr("gnss_local_offset: -1699999982.25\n"));
  EXPECT_THAT(text, HasSubstr("enable_gnss: 1\n"));
}

}  // namespace
}  // namespace alidade
