#include "core/camera_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/visual_observation.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;
using test::RandomStates;

struct CameraCase {
  const char* name;
  DistortionModel model;
  Vector4d intrinsics;
  std::vector<double> coefficients;
  int width, height;
};

// Calibrations of real cameras: EuRoC cam0, TUM-VI cam0, Lenovo Tango fisheye, left camera of the GVINS
// dataset, TUM-VI cam0 as double-sphere. The others are made up.
const CameraCase kCameras[] = {
    {"none", DistortionModel::kNone, {460, 460, 376, 240}, {}, 752, 480},
    {"radial_tangential",
     DistortionModel::kRadialTangential,
     {458.654, 457.296, 367.215, 248.375},
     {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05},
     752,
     480},
    {"equidistant",
     DistortionModel::kEquidistant,
     {190.978477, 190.973307, 254.931706, 256.897442},
     {0.00348238940225, 0.000715034845, -0.00205323614187, 0.00020293673591},
     512,
     512},
    {"fov", DistortionModel::kFov, {257.67, 258.16, 327.73, 229.11}, {0.932489670230815}, 640, 480},
    {"mei",
     DistortionModel::kMei,
     {1338.1845333957547, 1340.1190112672946, 378.7909740462579, 217.69105287172025},
     {1.8476540167437447, -0.06597811223735722, 0.8559479340704287, -0.0006445829733139821,
      0.0015137487236065916},
     752,
     480},
    {"double_sphere",
     DistortionModel::kDoubleSphere,
     {158.28, 158.27, 254.96, 256.88},
     {-0.172, 0.593},
     512,
     512},
    {"double_sphere_narrow", DistortionModel::kDoubleSphere, {600, 605, 330, 235}, {0.1, 0.4}, 640, 480},
    {"eucm", DistortionModel::kEucm, {190.5, 190.6, 254.9, 256.8}, {0.62, 1.08}, 512, 512},
};

class EveryCamera : public ::testing::TestWithParam<CameraCase> {
 protected:
  void SetUp() override {
    const CameraCase& c = GetParam();
    Result<CameraModel> camera =
        CameraModel::Create(c.model, c.intrinsics, c.coefficients, c.width, c.height);
    ASSERT_TRUE(camera.ok()) << camera.message();
    camera_ = *camera;
  }
  CameraModel camera_;
};
INSTANTIATE_TEST_SUITE_P(Cameras, EveryCamera, ::testing::ValuesIn(kCameras),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

// The unified sphere by its own construction: onto the unit sphere, seen from xi behind its centre.
TEST(MeiCamera, SeesThePointOnTheSphereFromBehindItsCentre) {
  constexpr double kMirror = 1.2;
  const CameraModel camera =
      *CameraModel::Create(DistortionModel::kMei, {700, 710, 320, 240}, {kMirror, 0, 0, 0, 0}, 640, 480);
  RandomStates random(11);
  for (int i = 0; i < 20; ++i) {
    const Vector3d p(random.Uniform(-2, 2), random.Uniform(-2, 2), random.Uniform(1, 5));
    const Vector3d on_sphere = p.normalized();
    Vector2d pixel;
    ASSERT_TRUE(camera.Project(p, &pixel));
    EXPECT_NEAR(pixel.x(), 700 * on_sphere.x() / (on_sphere.z() + kMirror) + 320, 1e-9);
    EXPECT_NEAR(pixel.y(), 710 * on_sphere.y() / (on_sphere.z() + kMirror) + 240, 1e-9);
  }
  EXPECT_NEAR(camera.mean_focal_px(), 705 / (1 + kMirror), 1e-12);
}

// Without a mirror it is the radial-tangential camera.
TEST(MeiCamera, WithoutMirrorIsRadialTangential) {
  const CameraModel mei = *CameraModel::Create(DistortionModel::kMei, {920, 918, 367, 248},
                                               {0, -0.28, 0.07, 2e-4, 2e-5}, 752, 480);
  // xi = 0 leaves m = x, so that the focal lengths are the pinhole's.
  const CameraModel brown = *CameraModel::Create(DistortionModel::kRadialTangential, {920, 918, 367, 248},
                                                 {-0.28, 0.07, 2e-4, 2e-5}, 752, 480);
  RandomStates random(12);
  for (int i = 0; i < 20; ++i) {
    const Vector3d p(random.Uniform(-0.3, 0.3), random.Uniform(-0.2, 0.2), 1);
    Vector2d a, b;
    ASSERT_TRUE(mei.Project(p, &a) && brown.Project(p, &b));
    EXPECT_LT((a - b).norm(), 1e-9);
  }
}

TEST_P(EveryCamera, UnprojectInvertsProjectOverTheWholeImage) {
  for (int u = 0; u < camera_.width_px(); u += 16) {
    for (int v = 0; v < camera_.height_px(); v += 16) {
      const Vector2d pixel(u, v);
      Vector2d ideal;
      if (!camera_.Unproject(pixel, &ideal)) {
        continue;  // fisheye corners beyond 90 degrees
      }
      Vector2d back;
      ASSERT_TRUE(camera_.Project(2.5 * Vector3d(ideal.x(), ideal.y(), 1), &back));
      EXPECT_LT((back - pixel).norm(), 1e-7) << pixel.transpose();
    }
  }
}

TEST_P(EveryCamera, MostOfTheImageIsInsideTheDomain) {
  int inside = 0;
  int all = 0;
  for (int u = 0; u < camera_.width_px(); u += 8) {
    for (int v = 0; v < camera_.height_px(); v += 8, ++all) {
      Vector2d ideal;
      inside += camera_.Unproject(Vector2d(u, v), &ideal) ? 1 : 0;
    }
  }
  EXPECT_GT(inside, all * 0.75);
}

TEST_P(EveryCamera, ProjectionJacobianIsNumeric) {
  RandomStates random(6);
  for (int i = 0; i < 40; ++i) {
    const Vector3d p(random.Uniform(-1, 1), random.Uniform(-0.7, 0.7), random.Uniform(1, 5));
    Vector2d pixel;
    Eigen::Matrix<double, 2, 3> jacobian;
    ASSERT_TRUE(camera_.Project(p, &pixel, &jacobian));
    const auto project = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
      Vector2d moved;
      EXPECT_TRUE(camera_.Project(p + Vector3d(d), &moved));
      return moved;
    };
    EXPECT_EQ(test::CompareJacobians(jacobian, test::NumericJacobian(project, 3), 1e-8), "");
  }
}

TEST_P(EveryCamera, UnprojectionJacobianIsNumeric) {
  RandomStates random(7);
  for (int i = 0; i < 40; ++i) {
    const Vector2d pixel(random.Uniform(0.2, 0.8) * camera_.width_px(),
                         random.Uniform(0.2, 0.8) * camera_.height_px());
    Vector2d ideal;
    Eigen::Matrix2d jacobian;
    ASSERT_TRUE(camera_.Unproject(pixel, &ideal, &jacobian));
    const auto project = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
      Vector2d moved;
      EXPECT_TRUE(camera_.Project((ideal + Vector2d(d)).homogeneous(), &moved));
      return moved;
    };
    EXPECT_EQ(test::CompareJacobians(jacobian, test::NumericJacobian(project, 2), 1e-8), "");
  }
}

TEST_P(EveryCamera, RefusesWhatItCannotSee) {
  Vector2d pixel(1, 2);
  EXPECT_FALSE(camera_.Project(Vector3d(0, 0, -1), &pixel));
  if (!camera_.is_spherical()) {
    EXPECT_FALSE(camera_.Project(Vector3d(0.1, 0.1, -1), &pixel));
    EXPECT_FALSE(camera_.Project(Vector3d(0.1, 0.1, 0), &pixel));
    EXPECT_FALSE(camera_.Project(Vector3d(1e4, 0, 1), &pixel));
  }
  EXPECT_EQ(pixel, Vector2d(1, 2)) << "outputs must be untouched";
  Vector2d ideal;
  EXPECT_FALSE(camera_.Unproject(Vector2d(std::nan(""), 0), &ideal));
  EXPECT_FALSE(camera_.Unproject(Vector2d(1e7, 0), &ideal));
}

// data/README of the Tango set: w 0.9325, r_d w < pi/2 bounds the image of the half-space.
TEST(CameraModelTest, FovFormulaIsDevernayFaugeras) {
  const double w = 0.932489670230815;
  const CameraModel camera = *CameraModel::Create(DistortionModel::kFov, {1, 1, 0, 0}, {w}, 10, 10);
  for (const double r : {0.0, 1e-7, 0.1, 1.0, 5.0}) {
    Vector2d distorted;
    ASSERT_TRUE(camera.Distort({r, 0}, &distorted));
    EXPECT_NEAR(distorted.x(), std::atan(2 * r * std::tan(w / 2)) / w, 1e-14);
  }
  Vector2d ideal;
  EXPECT_FALSE(camera.Unproject(Vector2d(M_PI / 2 / w, 0), &ideal));
}

TEST(CameraModelTest, RadialDomainEndsWhereTheMapTurnsBack) {
  const CameraModel camera =
      *CameraModel::Create(DistortionModel::kRadialTangential, {1, 1, 0, 0}, {-0.3, 0, 0, 0}, 10, 10);
  EXPECT_NEAR(camera.max_radius(), std::sqrt(1 / 0.9), 0.01);  // d/dr (r - 0.3 r^3) = 0
}

TEST(CameraModelTest, BadCalibrationsAreNamed) {
  const auto message = [](DistortionModel model, const Vector4d& intrinsics, const std::vector<double>& k,
                          int width) {
    return CameraModel::Create(model, intrinsics, k, width, 480).message();
  };
  EXPECT_NE(message(DistortionModel::kNone, {-1, 1, 0, 0}, {}, 640).find("intrinsics"), std::string::npos);
  EXPECT_NE(message(DistortionModel::kNone, {1, 1, 0, 0}, {}, 0).find("resolution"), std::string::npos);
  EXPECT_NE(message(DistortionModel::kFov, {1, 1, 0, 0}, {0.9, 0.1}, 640).find("takes 1, found 2"),
            std::string::npos);
  EXPECT_NE(message(DistortionModel::kFov, {1, 1, 0, 0}, {4.0}, 640).find("(0, pi)"), std::string::npos);
  EXPECT_NE(
      message(DistortionModel::kEquidistant, {1, 1, 0, 0}, {0, std::nan(""), 0, 0}, 640).find("entry 2"),
      std::string::npos);
}

TEST(VisualObservationTest, PixelNoiseIsWhitenedThroughTheLens) {
  const CameraCase& c = kCameras[3];
  const CameraModel camera = *CameraModel::Create(c.model, c.intrinsics, c.coefficients, c.width, c.height);
  NormalizedObservation observation;
  const Vector2d pixel(520, 300);
  ASSERT_TRUE(NormalizeObservation(camera, pixel, 2.0, &observation));
  // A shift of one standard deviation in the image has whitened length one.
  NormalizedObservation moved;
  ASSERT_TRUE(NormalizeObservation(camera, pixel + Vector2d(2e-4, 0), 2.0, &moved));
  EXPECT_NEAR((observation.sqrt_information * (moved.z - observation.z)).norm(), 1e-4, 1e-8);
}

TEST(VisualObservationTest, BodyToCameraChainIsNumericInEveryConvention) {
  RandomStates random(8);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int i = 0; i < 20; ++i) {
      const Pose T_WB = random.RandomPose(5);
      const Pose T_BC = random.RandomPose(0.3);
      const auto chain = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        return Local(ErrorConvention::kSo3xRn, T_WB * T_BC, Retract(convention, T_WB, Vector6d(xi)) * T_BC);
      };
      const Matrix6d analytic = BodyToCameraJacobian(T_WB.rotation, T_BC) * ChartJacobian(convention, T_WB);
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(chain, 6), 1e-9), "");
    }
  }
}

}  // namespace
}  // namespace alidade
