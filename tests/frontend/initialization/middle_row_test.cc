#include "frontend/initialization/middle_row.h"

#include <gtest/gtest.h>

#include "core/body_motion.h"
#include "core/lie.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

RigCalibration Rig() {
  RigCalibration rig;
  rig.camera = CameraModel::Create(DistortionModel::kRadialTangential, {458, 457, 367, 248},
                                   {-0.28, 0.07, 0, 0}, 752, 480)
                   .value();
  rig.T_BC.rotation = so3::Exp(Vector3d(0.3, -1.2, 0.4));
  rig.line_delay_s = 4e-5;
  return rig;
}

// GIVEN a camera that turns about itself WHEN its observations are taken back to the middle row THEN they are
// those of a camera that stands as it stood then: the rotation of CameraAfter at a constant rate.
TEST(MiddleRowTest, TurnsObservationsBack) {
  const RigCalibration rig = Rig();
  const Vector3d gyro(0.8, -1.5, 0.6);
  TrackFrame frame;
  std::vector<Vector2d> still;
  for (const Vector3d& ray : {Vector3d(0.5, 0.4, 1), Vector3d(-0.6, -0.45, 1), Vector3d(0.1, 0.02, 1)}) {
    Vector2d pixel;
    ASSERT_TRUE(rig.camera.Project(ray, &pixel));
    still.push_back(pixel);
    for (int pass = 0; pass < 20; ++pass) {
      const double later_s = rig.line_delay_s * (pixel.y() - 240);
      const Pose moved = CameraAfter({gyro, Vector3d::Zero(), Vector3d::Zero()}, rig.T_BC, later_s);
      ASSERT_TRUE(rig.camera.Project(moved.rotation.transpose() * ray, &pixel));
    }
    frame.observations.push_back({static_cast<std::int64_t>(still.size()), pixel});
  }
  EXPECT_GT((frame.observations[0].pixel - still[0]).norm(), 3);
  const TrackFrame back = AtMiddleRow(rig, gyro, frame);
  for (size_t i = 0; i < still.size(); ++i) {
    EXPECT_LT((back.observations[i].pixel - still[i]).norm(), 1e-5);
  }
  RigCalibration at_once = rig;
  at_once.line_delay_s = 0;
  EXPECT_EQ(AtMiddleRow(at_once, gyro, frame).observations[0].pixel, frame.observations[0].pixel);
}

}  // namespace
}  // namespace alidade
