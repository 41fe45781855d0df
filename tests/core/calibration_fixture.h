#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "core/calibration.h"

namespace alidade::test {

/// A camera of plausible intrinsics with this lens.
inline CameraModel MakeCamera(DistortionModel model) {
  std::vector<double> coefficients;
  switch (model) {
    case DistortionModel::kRadialTangential:
      coefficients = {-0.28, 0.07, 2e-4, -3e-4};
      break;
    case DistortionModel::kEquidistant:
      coefficients = {0.01, -0.004, 0.002, -0.0005};
      break;
    case DistortionModel::kFov:
      coefficients = {0.9};
      break;
    case DistortionModel::kMei:
      coefficients = {0.9, -0.03, 0.01, 1e-4, -2e-4};
      break;
    case DistortionModel::kDoubleSphere:
      coefficients = {-0.2, 0.55};
      break;
    case DistortionModel::kEucm:
      coefficients = {0.6, 1.1};
      break;
    case DistortionModel::kNone:
      break;
  }
  const Result<CameraModel> camera =
      CameraModel::Create(model, Eigen::Vector4d(458, 457, 367, 248), coefficients, 752, 480);
  EXPECT_TRUE(camera.ok()) << camera.message();
  return *camera;
}

inline constexpr DistortionModel kLenses[] = {
    DistortionModel::kNone,        DistortionModel::kRadialTangential,
    DistortionModel::kEquidistant, DistortionModel::kFov,
    DistortionModel::kMei,         DistortionModel::kDoubleSphere,
    DistortionModel::kEucm};

inline CalibrationConfig Everything() {
  CalibrationConfig config;
  config.extrinsics = config.time_offset = config.intrinsics = true;
  return config;
}

}  // namespace alidade::test
