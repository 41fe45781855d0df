#include "eval/dataset/sensor_yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace alidade {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(SensorYamlTest, EveryLensIsReadAsItWasWritten) {
  const struct {
    DistortionModel model;
    std::vector<double> coefficients;
    bool is_pinhole;
  } cases[] = {{DistortionModel::kNone, {}, true},
               {DistortionModel::kRadialTangential, {-0.28, 0.07, 2e-4, 1e-5}, true},
               {DistortionModel::kEquidistant, {0.01, -0.002, 3e-4, -1e-5}, true},
               {DistortionModel::kFov, {0.93}, true},
               {DistortionModel::kMei, {1.8, -0.07, 0.8, -6e-4, 1e-3}, false},
               {DistortionModel::kDoubleSphere, {-0.172, 0.593}, false},
               {DistortionModel::kEucm, {0.62, 1.08}, false}};
  for (const auto& c : cases) {
    RigCalibration rig;
    rig.camera = *CameraModel::Create(c.model, {158.25, 158.27, 254.96, 256.88}, c.coefficients, 512, 510);
    rig.T_BC = {so3::Exp({0.1, -0.4, 1.2}), {0.1, 0.2, -0.3}};
    const std::string sheet = CameraSensorYaml(rig, 20);
    const Result<CameraSensor> read = ParseCameraSensor(sheet, "sensor.yaml");
    ASSERT_TRUE(read.ok()) << read.message();
    EXPECT_EQ(read->camera.model(), c.model);
    EXPECT_EQ(read->camera.intrinsics(), rig.camera.intrinsics());
    EXPECT_EQ(read->camera.coefficients(), rig.camera.coefficients());
    EXPECT_LT((read->T_BC.translation - rig.T_BC.translation).norm(), 1e-15);
    if (c.is_pinhole) {
      EXPECT_THAT(sheet, HasSubstr("camera_model: pinhole"));
    } else {
      EXPECT_THAT(sheet, Not(HasSubstr("camera_model")));
    }
  }
}

}  // namespace
}  // namespace alidade
