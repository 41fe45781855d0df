#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/camera_model.h"
#include "core/rig_calibration.h"

namespace alidade::test {

/// Smooth random number field in [0, 1] with knots one unit apart; the same everywhere and always.
inline double ValueNoise(double x, double y, std::uint64_t seed) {
  const auto knot = [seed](std::int64_t i, std::int64_t j) {
    std::uint64_t z = seed * 0x9E3779B97F4A7C15ULL + static_cast<std::uint64_t>(i) * 0xD1B54A32D192ED03ULL +
                      static_cast<std::uint64_t>(j) * 0x8CB92BA72F3D8DD7ULL;
    z = (z ^ (z >> 32)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 29)) * 0x94D049BB133111EBULL;
    return static_cast<double>((z ^ (z >> 32)) & 0xFFFFFF) / static_cast<double>(0xFFFFFF);
  };
  const double floor_x = std::floor(x);
  const double floor_y = std::floor(y);
  const auto smooth = [](double s) { return s * s * s * (s * (6 * s - 15) + 10); };
  const double u = smooth(x - floor_x);
  const double v = smooth(y - floor_y);
  const auto i = static_cast<std::int64_t>(floor_x);
  const auto j = static_cast<std::int64_t>(floor_y);
  return (1 - v) * ((1 - u) * knot(i, j) + u * knot(i + 1, j)) +
         v * ((1 - u) * knot(i, j + 1) + u * knot(i + 1, j + 1));
}

/// Grey value of an endless textured plane, coordinates in pixels: details of 8 px upon shapes of 30 px.
inline unsigned char Texture(const Eigen::Vector2d& at) {
  const double shapes = ValueNoise(at.x() / 30, at.y() / 30, 1);
  const double details = ValueNoise(at.x() / 8, at.y() / 8, 2);
  return static_cast<unsigned char>(std::clamp(255 * (0.4 * shapes + 0.6 * details), 0.0, 255.0));
}

/// Image whose pixel shows the texture at texture_of(pixel).
inline std::vector<unsigned char> Render(
    int width_px, int height_px, const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& texture_of) {
  std::vector<unsigned char> image;
  image.reserve(static_cast<size_t>(width_px) * static_cast<size_t>(height_px));
  for (int row = 0; row < height_px; ++row) {
    for (int column = 0; column < width_px; ++column) {
      image.push_back(Texture(texture_of(Eigen::Vector2d(column, row))));
    }
  }
  return image;
}

/// A wall across the world's z axis seen by a camera; 400 px of texture to a unit of z-normalised size.
class Wall {
 public:
  Wall(const CameraModel& camera, double distance_m) : camera_(camera), distance_m_(distance_m) {
    for (int row = 0; row < camera.height_px(); ++row) {
      for (int column = 0; column < camera.width_px(); ++column) {
        Eigen::Vector2d normalized = Eigen::Vector2d::Zero();
        camera.Unproject(Eigen::Vector2d(column, row), &normalized);
        bearings_.push_back(normalized.homogeneous());
      }
    }
  }

  /// What the camera at T_WC sees.
  [[nodiscard]] std::vector<unsigned char> Image(const Pose& T_WC) const {
    std::vector<unsigned char> image;
    image.reserve(bearings_.size());
    for (const Eigen::Vector3d& bearing : bearings_) {
      image.push_back(Texture(Hit(bearing, T_WC).head<2>() * 400 / distance_m_));
    }
    return image;
  }

  /// Where the wall's point seen at `pixel` from `from` appears from `to`; false when it does not.
  bool Transfer(const Eigen::Vector2d& pixel, const Pose& from, const Pose& to,
                Eigen::Vector2d* moved) const {
    Eigen::Vector2d normalized;
    return camera_.Unproject(pixel, &normalized) &&
           camera_.Project(to.Inverse() * Hit(normalized.homogeneous(), from), moved);
  }

 private:
  [[nodiscard]] Eigen::Vector3d Hit(const Eigen::Vector3d& bearing, const Pose& T_WC) const {
    const Eigen::Vector3d direction = T_WC.rotation * bearing;
    return T_WC.translation + direction * ((distance_m_ - T_WC.translation.z()) / direction.z());
  }

  CameraModel camera_;
  double distance_m_;
  std::vector<Eigen::Vector3d> bearings_;
};

/// A EuRoC-like camera, camera axes tilted in the body so that a forgotten extrinsic shows.
inline RigCalibration TestRig(int width_px = 752, int height_px = 480) {
  RigCalibration rig;
  const double focal_px = 458.0 * width_px / 752;
  rig.camera = CameraModel::Create(DistortionModel::kRadialTangential,
                                   {focal_px, focal_px, 0.49 * width_px, 0.51 * height_px},
                                   {-0.28, 0.074, 2e-4, 2e-5}, width_px, height_px)
                   .value();
  rig.T_BC.rotation = so3::Exp({0.3, -1.2, 0.9});
  rig.T_BC.translation = {-0.02, -0.06, 0.01};
  return rig;
}

inline double Median(std::vector<double> values) {
  if (values.empty()) {
    return std::nan("");
  }
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

}  // namespace alidade::test
