#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/calibration.h"
#include "core/camera_model.h"
#include "core/visual_observation.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"
#include "tests/support/steps.h"

// Equidistant, double-sphere and eucm beyond 90 degrees off axis.

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Eigen::VectorXd;
using test::RandomStates;

constexpr double kPi = std::numbers::pi;
constexpr double kStep = kPi / 2000;  // of the march that finds a domain

CameraModel Lens(DistortionModel model, double focal_px, const std::vector<double>& coefficients,
                 int side_px = 800) {
  const double c = 0.5 * side_px;
  const Result<CameraModel> camera =
      CameraModel::Create(model, {focal_px, 1.01 * focal_px, c + 3, c - 5}, coefficients, side_px, side_px);
  EXPECT_TRUE(camera.ok()) << camera.message();
  return *camera;
}

/// Lenses of more than 180 degrees. The first: parameters in the range that Usenko et al. 2018 found for a
/// lens of 195 degrees.
std::vector<CameraModel> WideLenses() {
  return {Lens(DistortionModel::kDoubleSphere, 250, {-0.18, 0.59}),
          Lens(DistortionModel::kDoubleSphere, 230, {0.1, 0.42}),
          Lens(DistortionModel::kEucm, 240, {0.64, 1.05}),
          Lens(DistortionModel::kEquidistant, 220, {0.003, 0.0007, -0.002, 0.0002}),
          Lens(DistortionModel::kEquidistant, 200, {0, 0, 0, 0})};
}

Vector3d RayAt(double angle, double azimuth) {
  return {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle)};
}

TEST(SphericalLensTest, TheirDomainReachesBehindTheCamera) {
  for (const CameraModel& camera : WideLenses()) {
    EXPECT_TRUE(camera.is_spherical());
    EXPECT_GT(camera.max_angle_rad(), 1.65) << ToString(camera.model());
    EXPECT_LE(camera.field_angle_rad(), camera.max_angle_rad());
    Vector2d pixel(1, 2);
    EXPECT_TRUE(camera.Project(RayAt(camera.max_angle_rad() - 1e-6, 0.3), &pixel));
    const Vector2d before = pixel;
    EXPECT_FALSE(camera.Project(RayAt(camera.max_angle_rad() + 1e-6, 0.3), &pixel));
    EXPECT_FALSE(camera.Project(Vector3d::Zero(), &pixel));
    EXPECT_FALSE(camera.Project({std::nan(""), 0, 1}, &pixel));
    EXPECT_EQ(pixel, before) << "outputs must be untouched";
  }
}

TEST(SphericalLensTest, BearingInvertsProjectOverTheWholeDomain) {
  for (const CameraModel& camera : WideLenses()) {
    int beyond = 0;
    for (const double angle : test::Steps(0, camera.max_angle_rad(), 0.013)) {
      for (const double azimuth : {0.0, 0.7, 2.0, -2.6}) {
        const Vector3d ray = RayAt(angle, azimuth);
        Vector2d pixel;
        Vector3d back;
        ASSERT_TRUE(camera.Project(3.5 * ray, &pixel));
        ASSERT_TRUE(camera.Bearing(pixel, &back)) << ToString(camera.model()) << " at " << angle;
        // Where the map turns back, the angle is as ill determined as a root of it.
        EXPECT_LT((back - ray).norm(), angle < 0.97 * camera.max_angle_rad() ? 1e-11 : 1e-6)
            << ToString(camera.model()) << " at " << angle;
        EXPECT_NEAR(back.norm(), 1, 1e-14);
        beyond += ray.z() < 0 ? 1 : 0;
        Vector2d ideal;
        EXPECT_EQ(camera.Unproject(pixel, &ideal), angle < std::atan(camera.max_radius()))
            << "the plane z = 1 ends before the camera's side";
      }
    }
    EXPECT_GT(beyond, 20);
    Vector3d ray;
    EXPECT_FALSE(camera.Bearing({1e6, 0}, &ray));
    EXPECT_FALSE(camera.Bearing({std::nan(""), 0}, &ray));
  }
}

TEST(SphericalLensTest, ProjectionJacobianIsNumericOverTheWholeDomain) {
  RandomStates random(71);
  for (const CameraModel& camera : WideLenses()) {
    for (int trial = 0; trial < 60; ++trial) {
      const double angle = trial == 0 ? 0 : random.Uniform(0, 0.97 * camera.max_angle_rad());
      const Vector3d p = random.Uniform(1, 4) * RayAt(angle, random.Uniform(-kPi, kPi));
      Vector2d pixel;
      Eigen::Matrix<double, 2, 3> jacobian;
      ASSERT_TRUE(camera.Project(p, &pixel, &jacobian));
      const auto project = [&](const VectorXd& d) -> VectorXd {
        Vector2d moved;
        EXPECT_TRUE(camera.Project(p + Vector3d(d), &moved));
        return moved;
      };
      EXPECT_EQ(test::CompareJacobians(jacobian, test::NumericJacobian(project, 3), 1e-7), "")
          << ToString(camera.model()) << " at " << angle;
      EXPECT_LT((jacobian * p).norm(), 1e-9) << "along the ray nothing moves";
      Vector2d alone;
      ASSERT_TRUE(camera.Project(p, &alone));
      EXPECT_EQ(alone, pixel);
    }
  }
}

TEST(SphericalLensTest, IntrinsicsJacobianIsNumericOverTheWholeDomain) {
  RandomStates random(72);
  CalibrationConfig config;
  config.intrinsics = true;
  for (const CameraModel& camera : WideLenses()) {
    const CalibrationLayout layout(config, camera);
    EXPECT_EQ(layout.size(), 4 + CoefficientCount(camera.model()));
    for (int trial = 0; trial < 40; ++trial) {
      const double angle = trial == 0 ? 0 : random.Uniform(0, 0.95 * camera.max_angle_rad());
      const Vector3d ray = RayAt(angle, random.Uniform(-kPi, kPi));
      Eigen::Matrix<double, 2, 8> jacobian;
      ASSERT_TRUE(IntrinsicsJacobian(camera, ray, &jacobian));
      const auto project = [&](const VectorXd& error) -> VectorXd {
        CameraCalibration moved{camera, {}, 0};
        EXPECT_TRUE(Retract(layout, error, &moved));
        EXPECT_EQ(moved.camera.plane(), camera.plane());
        Vector2d pixel;
        EXPECT_TRUE(moved.camera.Project(ray, &pixel));
        return pixel;
      };
      EXPECT_EQ(test::CompareJacobians(jacobian.leftCols(layout.size()),
                                       test::NumericJacobian(project, layout.size(), 1e-5), 1e-7),
                "")
          << ToString(camera.model()) << " at " << angle;
    }
  }
}

// Usenko et al. 2018, equations 40 to 46, written by points.
TEST(DoubleSphereTest, FormulaAndDomainAreThePublishedOnes) {
  RandomStates random(73);
  for (const auto& [xi, alpha] : {std::pair(-0.2, 0.6), {0.3, 0.7}, {0.0, 0.5}, {-0.3, 0.3}, {1.0, 0.9}}) {
    // So large an image that the lens bounds the domain.
    const CameraModel camera =
        *CameraModel::Create(DistortionModel::kDoubleSphere, {1, 1, 0, 0}, {xi, alpha}, 5000, 5000);
    const double w1 = alpha <= 0.5 ? alpha / (1 - alpha) : (1 - alpha) / alpha;
    const double w2 = (w1 + xi) / std::sqrt(2 * w1 * xi + xi * xi + 1);
    EXPECT_GT(camera.max_angle_rad(), std::acos(-w2) - 2 * kStep) << xi << " " << alpha;
    // The published bound is on the safe side: the second sphere's rays turn back at Z + xi = -w1 d2.
    const double turns_back = -xi * (1 - w1 * w1) - w1 * std::sqrt(1 - xi * xi * (1 - w1 * w1));
    EXPECT_NEAR(camera.max_angle_rad(), std::acos(std::max(-1.0, turns_back)), 2 * kStep)
        << xi << " " << alpha;
    for (int trial = 0; trial < 20; ++trial) {
      const Vector3d p = 3 * RayAt(random.Uniform(0, camera.max_angle_rad()), random.Uniform(-kPi, kPi));
      const double d1 = p.norm();
      const double d2 = std::sqrt(p.x() * p.x() + p.y() * p.y() + std::pow(xi * d1 + p.z(), 2));
      const double denominator = alpha * d2 + (1 - alpha) * (xi * d1 + p.z());
      Vector2d pixel;
      ASSERT_TRUE(camera.Project(p, &pixel));
      EXPECT_LT((pixel - p.head<2>() / denominator).norm(), 1e-9 * (1 + pixel.norm()));
    }
  }
}

// Khomutenko et al. 2016, equation 6.
TEST(EucmTest, FormulaAndDomainAreThePublishedOnes) {
  RandomStates random(74);
  for (const auto& [alpha, beta] : {std::pair(0.6, 1.1), {0.7, 0.8}, {0.5, 1.0}, {0.3, 2.0}, {0.9, 1.5}}) {
    const CameraModel camera =
        *CameraModel::Create(DistortionModel::kEucm, {1, 1, 0, 0}, {alpha, beta}, 5000, 5000);
    const double w = alpha <= 0.5 ? alpha / (1 - alpha) : (1 - alpha) / alpha;
    // z = -w d with d^2 = beta s^2 + z^2.
    const double limit = std::atan2(std::sqrt((1 / (w * w) - 1) / beta), -1.0);
    EXPECT_NEAR(camera.max_angle_rad(), limit, 2 * kStep) << alpha << " " << beta;
    for (int trial = 0; trial < 20; ++trial) {
      const Vector3d p = 3 * RayAt(random.Uniform(0, camera.max_angle_rad()), random.Uniform(-kPi, kPi));
      const double d = std::sqrt(beta * p.head<2>().squaredNorm() + p.z() * p.z());
      Vector2d pixel;
      ASSERT_TRUE(camera.Project(p, &pixel));
      EXPECT_LT((pixel - p.head<2>() / (alpha * d + (1 - alpha) * p.z())).norm(), 1e-9 * (1 + pixel.norm()));
    }
  }
}

TEST(EquidistantTest, TheDomainEndsWhereThePolynomialTurnsBack) {
  // d/dt (t - 0.05 t^3) = 0 at t = sqrt(1 / 0.15), 148 degrees.
  const CameraModel camera = Lens(DistortionModel::kEquidistant, 200, {-0.05, 0, 0, 0}, 2000);
  EXPECT_NEAR(camera.max_angle_rad(), std::sqrt(1 / 0.15), 2 * kStep);
  Vector2d pixel;
  ASSERT_TRUE(camera.Project(RayAt(camera.max_angle_rad(), 0), &pixel));
  Vector3d ray;
  EXPECT_FALSE(camera.Bearing(pixel + Vector2d(0.5, 0), &ray)) << "no ray is seen there";
  // 2 t on the other hand reaches all around.
  EXPECT_GT(Lens(DistortionModel::kEquidistant, 200, {0, 0, 0, 0}, 2000).max_angle_rad(), 3.1);
}

// In front of the camera it is the lens it was on the plane z = 1.
TEST(EquidistantTest, WideIsTheFormulaOfThePlaneInFrontOfTheCamera) {
  const std::vector<double> k = {0.003, 0.0007, -0.002, 0.0002};
  const CameraModel wide = Lens(DistortionModel::kEquidistant, 220, k);
  const CameraModel narrow = Lens(DistortionModel::kEquidistant, 220, k, 300);
  ASSERT_TRUE(wide.is_spherical());
  ASSERT_FALSE(narrow.is_spherical());
  for (const double angle : test::Steps(0.01, 0.9, 0.05)) {
    Vector2d a, b;
    ASSERT_TRUE(wide.Project(RayAt(angle, 0.4), &a) && narrow.Project(RayAt(angle, 0.4), &b));
    EXPECT_LT(((a - Vector2d(403, 395)) - (b - Vector2d(153, 145))).norm(), 1e-10);
  }
}

TEST(SphericalLensTest, TheFieldOfTheImageChoosesThePlane) {
  const auto plane = [](DistortionModel model, double focal_px, const std::vector<double>& coefficients) {
    return Lens(model, focal_px, coefficients).plane();
  };
  for (const CameraModel& camera : WideLenses()) {
    EXPECT_EQ(camera.plane(), ObservationPlane::kTangent) << ToString(camera.model());
  }
  // Corners at 566 px: 79 and 82 degrees.
  EXPECT_EQ(plane(DistortionModel::kEquidistant, 412, {0, 0, 0, 0}), ObservationPlane::kNormalized);
  EXPECT_EQ(plane(DistortionModel::kEquidistant, 396, {0, 0, 0, 0}), ObservationPlane::kTangent);
  EXPECT_EQ(plane(DistortionModel::kDoubleSphere, 600, {-0.18, 0.59}), ObservationPlane::kNormalized);
  EXPECT_EQ(plane(DistortionModel::kEucm, 600, {0.64, 1.05}), ObservationPlane::kNormalized);
  EXPECT_EQ(plane(DistortionModel::kNone, 50, {}), ObservationPlane::kNormalized);
  EXPECT_EQ(plane(DistortionModel::kFov, 100, {1.5}), ObservationPlane::kNormalized);
  EXPECT_EQ(WideLenses().front().WithPlane(ObservationPlane::kNormalized).plane(),
            ObservationPlane::kNormalized);
}

TEST(SphericalLensTest, PixelNoiseIsWhitenedThroughTheLensOnTheTangentPlane) {
  RandomStates random(75);
  for (const CameraModel& camera : WideLenses()) {
    for (int trial = 0; trial < 20; ++trial) {
      Vector2d pixel;
      ASSERT_TRUE(camera.Project(
          RayAt(random.Uniform(0.2, 0.9 * camera.max_angle_rad()), random.Uniform(-kPi, kPi)), &pixel));
      NormalizedObservation observation;
      ASSERT_TRUE(NormalizeObservation(camera, pixel, 2.0, &observation));
      ASSERT_TRUE(observation.plane.is_tangent());
      EXPECT_TRUE(observation.z.isZero(0));
      // A shift of 1e-4 standard deviations in the image, on the plane of the first.
      for (const Vector2d& shift : {Vector2d(2e-4, 0), Vector2d(0, 2e-4)}) {
        NormalizedObservation moved = observation;
        ASSERT_TRUE(RenormalizeObservation(camera, pixel + shift, 2.0, &moved));
        EXPECT_EQ(moved.plane.axes(), observation.plane.axes());
        EXPECT_NEAR((observation.sqrt_information * moved.z).norm(), 1e-4, 1e-8);
      }
    }
  }
}

TEST(SphericalLensTest, BadCoefficientsAreNamed) {
  const auto message = [](DistortionModel model, const std::vector<double>& k) {
    return std::string(CameraModel::Create(model, {200, 200, 320, 240}, k, 640, 480).message());
  };
  const auto contains = [](const std::string& text, const char* part) {
    return text.find("distortion_coefficients") != std::string::npos && text.find(part) != std::string::npos;
  };
  EXPECT_PRED2(contains, message(DistortionModel::kDoubleSphere, {-1, 0.5}), "xi must lie in (-1, 1]");
  EXPECT_PRED2(contains, message(DistortionModel::kDoubleSphere, {1.1, 0.5}), "xi must lie in (-1, 1]");
  EXPECT_PRED2(contains, message(DistortionModel::kDoubleSphere, {0, 1.5}), "alpha must lie in [0, 1]");
  EXPECT_PRED2(contains, message(DistortionModel::kDoubleSphere, {0, -0.1}), "found -0.1");
  EXPECT_PRED2(contains, message(DistortionModel::kDoubleSphere, {0.1}), "takes 2, found 1");
  EXPECT_PRED2(contains, message(DistortionModel::kEucm, {1.01, 1}), "alpha must lie in [0, 1]");
  EXPECT_PRED2(contains, message(DistortionModel::kEucm, {0.5, 0}), "beta must lie in (0, 100]");
  EXPECT_PRED2(contains, message(DistortionModel::kEucm, {0.5, std::nan("")}), "entry 2");
}

}  // namespace
}  // namespace alidade
