#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/estimator/measurement_log.h"
#include "core/lie.h"
#include "core/random.h"
#include "eval/calibrate/camera_gyro_fit.h"

namespace alidade::test {

/// A camera and a gyroscope shaken by hand in a cloud of landmarks, with rolling shutter where the model has
/// it.
struct ShakenCamera {
  CameraGyroModel model;  ///< the truth
  double duration_s = 20;
  double pixel_noise_px = 0.3;
  double gyro_noise_radps = 3e-3;  ///< of a sample
  unsigned seed = 1;

  [[nodiscard]] static Eigen::Matrix3d R_WB(double t) {
    return so3::Exp(Eigen::Vector3d(0.5 * std::sin(1.1 * t), 0.4 * std::sin(0.8 * t + 1),
                                    0.6 * std::sin(0.7 * t))) *
           so3::Exp(
               Eigen::Vector3d(0.1 * std::sin(5 * t), 0.08 * std::sin(6.1 * t), 0.1 * std::sin(4.3 * t)));
  }
  [[nodiscard]] static Eigen::Vector3d p_WB(double t) {
    return {0.5 * std::sin(0.9 * t), 0.4 * std::sin(1.3 * t + 0.4), 0.3 * std::sin(0.6 * t + 2)};
  }

  [[nodiscard]] MeasurementLog Record() const {
    constexpr double kImuHz = 200, kCameraHz = 20, kStartS = 100;
    MeasurementLog log;
    log.rig.camera = model.camera;
    log.rig.T_BC.rotation = model.R_BC;
    log.rig.camera_time_offset_s = model.time_offset_s;
    RandomStream gyro_noise(seed, "gyroscope");
    for (int k = 0; k < static_cast<int>(duration_s * kImuHz); ++k) {
      const double t = k / kImuHz;
      constexpr double kStep = 1e-4;
      const Eigen::Vector3d rate = so3::Log(R_WB(t - kStep).transpose() * R_WB(t + kStep)) / (2 * kStep);
      const Eigen::Vector3d noise(gyro_noise.Normal(), gyro_noise.Normal(), gyro_noise.Normal());
      ImuSample sample;
      sample.stamp_ns = SecondsToNs(kStartS + t);
      sample.gyro = model.gyro_sign * (rate + model.gyro_bias + gyro_noise_radps * noise);
      sample.accel = R_WB(t).transpose() * Eigen::Vector3d(0, 0, 9.81);
      log.imu.push_back(sample);
    }
    const std::vector<Eigen::Vector3d> landmarks = Landmarks();
    RandomStream pixel_noise(seed, "pixels");
    for (int k = 0; k < static_cast<int>(duration_s * kCameraHz); ++k) {
      TrackFrame frame;
      frame.stamp_ns = SecondsToNs(kStartS + k / kCameraHz);
      for (std::size_t id = 0; id < landmarks.size(); ++id) {
        const Eigen::Vector2d noise(pixel_noise.Normal(), pixel_noise.Normal());
        if (Eigen::Vector2d pixel; SeenAt(landmarks[id], k / kCameraHz, &pixel)) {
          frame.observations.push_back({static_cast<std::int64_t>(id), pixel + pixel_noise_px * noise});
        }
      }
      log.frames.push_back(frame);
    }
    return log;
  }

 private:
  [[nodiscard]] std::vector<Eigen::Vector3d> Landmarks() const {
    RandomStream random(seed, "landmarks");
    std::vector<Eigen::Vector3d> landmarks;
    for (int i = 0; i < 600; ++i) {
      const Eigen::Vector3d direction =
          Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
      landmarks.emplace_back(direction * (2 + 4 * random.Uniform()));
    }
    return landmarks;
  }

  /// Row and time of the exposure of a pixel depend on each other.
  [[nodiscard]] bool SeenAt(const Eigen::Vector3d& landmark, double stamp_s, Eigen::Vector2d* pixel) const {
    double row = 0;
    for (int round = 0; round < 8; ++round) {
      const double t = stamp_s + model.time_offset_s + model.readout_s * row;
      const Eigen::Vector3d p_C = model.R_BC.transpose() * (R_WB(t).transpose() * (landmark - p_WB(t)));
      if (!model.camera.Project(p_C, pixel) || !model.camera.InImage(*pixel)) {
        return false;
      }
      row = pixel->y() / model.camera.height_px() - 0.5;
    }
    return true;
  }
};

/// A phone's camera of 640 x 480 px, held upright.
inline CameraGyroModel PhoneModel() {
  CameraGyroModel model;
  const Result<CameraModel> camera = CameraModel::Create(
      DistortionModel::kRadialTangential, {480, 482, 322, 243}, {0.08, -0.15, 0.001, -0.0007}, 640, 480);
  model.camera = *camera;
  model.R_BC << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  model.R_BC = model.R_BC * so3::Exp(Eigen::Vector3d(0.02, -0.01, 0.015));
  model.gyro_bias = {0.02, -0.01, 0.015};
  return model;
}

}  // namespace alidade::test
