#include "core/calibration.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/core/calibration_fixture.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;
using test::Everything;
using test::kLenses;
using test::MakeCamera;
using test::RandomStates;

TEST(CalibrationTest, LayoutListsWhatIsEstimatedAndNothingElse) {
  const CameraModel camera = MakeCamera(DistortionModel::kRadialTangential);
  CalibrationConfig config;
  EXPECT_EQ(CalibrationLayout(config, camera).size(), 0);
  config.time_offset = true;
  EXPECT_EQ(CalibrationLayout(config, camera).size(), 1);
  EXPECT_EQ(CalibrationLayout(config, camera).extrinsics(), -1);
  EXPECT_EQ(CalibrationLayout(Everything(), camera).size(), 15);
  EXPECT_EQ(CalibrationLayout(Everything(), MakeCamera(DistortionModel::kNone)).size(), 11);
  config = Everything();
  config.distortion_std = 0;
  EXPECT_EQ(CalibrationLayout(config, camera).intrinsics_size(), 4);
}

TEST(CalibrationTest, LocalUndoesRetract) {
  RandomStates random(51);
  for (int trial = 0; trial < 20; ++trial) {
    CameraCalibration truth{MakeCamera(kLenses[trial % 4]), random.RandomPose(0.3), 0.02};
    const CalibrationLayout layout(Everything(), truth.camera);
    VectorXd error(layout.size());
    for (int i = 0; i < layout.size(); ++i) {
      error[i] = random.Uniform(-1e-3, 1e-3);
    }
    const CameraCalibration estimate = truth;
    ASSERT_TRUE(Retract(layout, error, &truth));
    EXPECT_LT((Local(layout, estimate, truth) - error).norm(), 1e-12);
  }
}

TEST(CalibrationTest, TheBodyMovesOnAtItsRates) {
  RandomStates random(53);
  for (int trial = 0; trial < 20; ++trial) {
    const Pose T_WB = random.RandomPose(2);
    const Vector6d rates = BodyRates(random.Vector(3), random.Vector(4));
    const double later_s = random.Uniform(-0.1, 0.1);
    Eigen::Matrix3d turn;
    const Pose later = BodyAfter(T_WB, rates, later_s, &turn);
    EXPECT_EQ(later.rotation, T_WB.rotation * turn);
    const auto local = [](const Pose& from, const Pose& to) -> VectorXd {
      return (Vector6d() << so3::Log(from.rotation.transpose() * to.rotation),
              to.translation - from.translation)
          .finished();
    };
    const auto of_time = [&](const VectorXd& longer) -> VectorXd {
      return local(later, BodyAfter(T_WB, rates, later_s + longer[0]));
    };
    EXPECT_EQ(test::CompareJacobians(rates, test::NumericJacobian(of_time, 1), 1e-9), "");
    const auto of_body = [&](const VectorXd& zeta) -> VectorXd {
      const Pose moved = Retract(ErrorConvention::kSo3xRn, T_WB, Vector6d(zeta));
      return local(later, BodyAfter(moved, rates, later_s));
    };
    Matrix6d chart = Matrix6d::Identity();
    chart.topLeftCorner<3, 3>() = turn.transpose();
    EXPECT_EQ(test::CompareJacobians(chart, test::NumericJacobian(of_body, 6), 1e-9), "");
  }
}

TEST(CalibrationTest, NoCameraIsRefusedAndLeavesTheCalibration) {
  CameraCalibration calibration{MakeCamera(DistortionModel::kNone), {}, 0};
  const CalibrationLayout layout(Everything(), calibration.camera);
  VectorXd error = VectorXd::Zero(layout.size());
  error[layout.time_offset()] = 1;
  error[layout.intrinsics()] = -1000;
  EXPECT_FALSE(Retract(layout, error, &calibration));
  error.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(Retract(layout, error, &calibration));
  EXPECT_EQ(calibration.time_offset_s, 0);
  EXPECT_EQ(calibration.camera.intrinsics()[0], 458);
}

TEST(CalibrationTest, IntrinsicsJacobianIsNumericForEveryLens) {
  RandomStates random(52);
  for (const DistortionModel lens : kLenses) {
    const CameraModel camera = MakeCamera(lens);
    const CalibrationLayout layout(Everything(), camera);
    for (int trial = 0; trial < 20; ++trial) {
      const Vector2d ideal = trial == 0 ? Vector2d(0, 0) : Vector2d(random.Vector(0.5).head<2>());
      Eigen::Matrix<double, 2, 8> jacobian;
      ASSERT_TRUE(IntrinsicsJacobian(camera, ideal, &jacobian));
      const auto project = [&](const VectorXd& error) -> VectorXd {
        CameraCalibration moved{camera, {}, 0};
        VectorXd all = VectorXd::Zero(layout.size());
        all.tail(error.size()) = error;
        EXPECT_TRUE(Retract(layout, all, &moved));
        Vector2d pixel;
        EXPECT_TRUE(moved.camera.Project(ideal.homogeneous(), &pixel));
        return pixel;
      };
      const int size = layout.intrinsics_size();
      EXPECT_EQ(test::CompareJacobians(jacobian.leftCols(size), test::NumericJacobian(project, size), 1e-7),
                "")
          << ToString(lens);
    }
  }
}

}  // namespace
}  // namespace alidade
