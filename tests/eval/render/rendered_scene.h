#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "eval/render/rendered_sequence.h"
#include "eval/simulation/simulator.h"

namespace alidade::test {

/// The figure-8 at EuRoC's size and frame rate through a lens like EuRoC's.
inline SimulatorConfig RenderedConfig() {
  SimulatorConfig config;
  config.duration_s = 2;
  config.path_m = 2.6;
  config.imu_rate_hz = 200;
  config.camera_rate_hz = 20;
  config.camera_time_offset_s = 0.01;
  config.distortion = DistortionModel::kRadialTangential;
  config.distortion_coefficients << -0.28, 0.07, 2e-4, 2e-5;
  config.landmark_min_distance_m = 0.8;
  config.render.enabled = true;
  return config;
}

/// The same, a quarter as wide and high: for what does not depend on the size.
inline SimulatorConfig SmallConfig() {
  SimulatorConfig config = RenderedConfig();
  config.width_px = 188;
  config.height_px = 120;
  config.focal_px = 115;
  config.duration_s = 1;
  return config;
}

struct Scene {
  SimulatorConfig config;
  Simulation simulation;
  RenderedSequence sequence;

  static Scene Make(const SimulatorConfig& config, unsigned seed = 3) {
    Simulation simulation = SimulateWithMotion(config, seed).value();
    RenderedSequence sequence = RenderedSequence::Create(config, simulation, seed).value();
    return {config, std::move(simulation), std::move(sequence)};
  }

  [[nodiscard]] const Dataset& dataset() const { return simulation.dataset; }
  [[nodiscard]] Pose CameraAt(TimeNs stamp_ns) const {
    const double time_s =
        SecondsBetween(simulation.motion_start_ns, stamp_ns) + dataset().rig.camera_time_offset_s;
    return simulation.motion->At(time_s).nav.T_WB() * dataset().rig.T_BC;
  }
};

inline double Quantile(std::vector<double> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// Distances [px] of tracked pixels from where the surface point of the track's first pixel projects.
inline std::vector<double> ReprojectionErrors(const Scene& scene, const std::vector<TrackFrame>& frames) {
  const CameraModel& camera = scene.dataset().rig.camera;
  std::map<std::int64_t, Eigen::Vector3d> points_W;
  std::vector<double> errors;
  for (const TrackFrame& frame : frames) {
    const Pose T_WC = scene.CameraAt(frame.stamp_ns);
    for (const TrackObservation& observation : frame.observations) {
      const auto known = points_W.find(observation.track_id);
      Eigen::Vector2d place;
      if (known != points_W.end()) {
        EXPECT_TRUE(camera.Project(T_WC.Inverse() * known->second, &place));
        errors.push_back((observation.pixel - place).norm());
      } else if (camera.Unproject(observation.pixel, &place)) {
        const Eigen::Vector3d ray_W = T_WC.rotation * place.homogeneous().normalized();
        const double distance = scene.sequence.hall().Distance(T_WC.translation, ray_W);
        points_W[observation.track_id] = T_WC.translation + distance * ray_W;
      }
    }
  }
  return errors;
}

/// Mean squared difference of neighbours along a row: how sharp an image is.
inline double Sharpness(const GreyImage& image) {
  double sum = 0;
  for (std::size_t i = 1; i < image.pixels.size(); ++i) {
    const double step = image.pixels[i] - image.pixels[i - 1];
    sum += step * step;
  }
  return sum / static_cast<double>(image.pixels.size());
}

inline double MeanGrey(const GreyImage& image) {
  double sum = 0;
  for (const unsigned char grey : image.pixels) {
    sum += grey;
  }
  return sum / static_cast<double>(image.pixels.size());
}

/// The frame at 0.5 s with other keys of the renderer.
inline GreyImage FrameWith(const std::function<void(RenderConfig*)>& change) {
  SimulatorConfig config = SmallConfig();
  config.render.read_noise_grey = 0;
  config.render.shot_noise_grey = 0;
  change(&config.render);
  return Scene::Make(config).sequence.Frame(10);
}

/// Mean over the pixels of the squared difference of two images less the variance that a read noise and a
/// photon noise tell, which grows with the grey value: a sixth, that of the two roundings, where they tell it
/// right.
inline double ExcessVariance(const GreyImage& clean, const GreyImage& noisy, double read, double shot) {
  double excess = 0;
  for (std::size_t i = 0; i < clean.pixels.size(); ++i) {
    const double difference = noisy.pixels[i] - clean.pixels[i];
    excess += difference * difference - (read + shot * clean.pixels[i]);
  }
  return excess / static_cast<double>(clean.pixels.size());
}

}  // namespace alidade::test
