#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/error_convention.h"
#include "core/estimator/measurement_log.h"
#include "core/imu_propagation.h"
#include "core/imu_step.h"
#include "core/position_fix.h"
#include "core/random.h"

namespace alidade::test {

inline constexpr double kGravity = 9.81;
inline constexpr double kImuRateHz = 200;
inline constexpr int kSamplesPerFrame = 20;
inline constexpr int kFrames = 8;  // that see landmarks; one more sees none, so that every track has ended
inline constexpr int kTracks = 30;

/// What both back ends read.
struct OneWindow {
  RigCalibration rig;
  NavEstimate start;
  NavEstimate carried;  ///< the start at the last frame, by the IMU alone
  std::vector<ImuSample> samples;
  std::vector<TrackFrame> frames;
  std::vector<PositionFix> fixes;  ///< at stamps of frames
};

inline RigCalibration MakeRig() {
  RigCalibration rig;
  Result<CameraModel> camera =
      CameraModel::Create(DistortionModel::kNone, {458, 457, 367, 248}, {}, 752, 480);
  EXPECT_TRUE(camera.ok());
  rig.camera = *camera;
  Eigen::Matrix3d sideways;  // the camera looks along the y axis of the body, which moves along x
  sideways << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  rig.T_BC = {sideways * so3::Exp(Eigen::Vector3d(0.1, -0.05, 0.08)), Eigen::Vector3d(0.05, -0.02, 0.03)};
  return rig;
}

inline Matrix15d StartCovariance(RandomStream* random) {
  Vector15d deviation;
  deviation << Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.05),
      Eigen::Vector3d::Constant(0.05), Eigen::Vector3d::Constant(0.002), Eigen::Vector3d::Constant(0.03);
  Matrix15d mixing = Matrix15d::Identity();
  for (double& entry : mixing.reshaped()) {
    entry += random->Uniform(-0.2, 0.2);
  }
  const Matrix15d root = deviation.asDiagonal() * mixing;
  return root * root.transpose();
}

/// States at the frames and the exact samples between them.
inline std::vector<NavState> MakeMotion(NavEstimate at, const ImuNoise& noise,
                                        std::vector<ImuSample>* samples) {
  std::vector<NavState> states = {at.nav};
  for (int frame = 0; frame < kFrames; ++frame) {
    const Eigen::Vector3d up_B = at.nav.R_WB.transpose() * Eigen::Vector3d(0, 0, kGravity);
    const size_t first = samples->empty() ? 0 : samples->size() - 1;
    for (int k = samples->empty() ? 0 : 1; k <= kSamplesPerFrame; ++k) {
      const double t = (frame * kSamplesPerFrame + k) / kImuRateHz;
      const Eigen::Vector3d gyro(0.3 + std::sin(9 * t), 0.4 * std::cos(7 * t), -0.3 + 0.5 * std::sin(5 * t));
      const Eigen::Vector3d force(2 * std::sin(6 * t), 2 * std::cos(8 * t), std::sin(11 * t));
      samples->push_back({SecondsToNs(t), gyro + at.bias.gyro, up_B + force + at.bias.accel});
    }
    SetCurvatures(*samples);
    const std::span<const ImuSample> interval(samples->begin() + static_cast<std::ptrdiff_t>(first),
                                              samples->end());
    EXPECT_TRUE(PropagateEstimate(interval, noise, GravityInWorld(kGravity), &at).ok());
    states.push_back(at.nav);
  }
  return states;
}

/// Tracks of kTracks landmarks without noise; some begin a frame late, some end early.
inline std::vector<TrackFrame> MakeTracks(const RigCalibration& rig, const std::vector<NavState>& states,
                                          RandomStream* random) {
  std::vector<TrackFrame> frames(states.size());
  for (size_t i = 0; i < frames.size(); ++i) {
    frames[i].stamp_ns = SecondsToNs(static_cast<double>(i) * kSamplesPerFrame / kImuRateHz);
  }
  for (std::int64_t id = 0; id < kTracks;) {
    const double depth = random->Uniform(3, 6);
    const Eigen::Vector3d p_C(random->Uniform(-0.6, 0.6) * depth, random->Uniform(-0.35, 0.35) * depth,
                              depth);
    const Eigen::Vector3d p_W = states[kFrames / 2].T_WB() * rig.T_BC * p_C;
    std::vector<TrackObservation> seen;
    for (size_t i = 0; i < kFrames; ++i) {
      Eigen::Vector2d pixel;
      if (rig.camera.Project((states[i].T_WB() * rig.T_BC).Inverse() * p_W, &pixel) &&
          rig.camera.InImage(pixel)) {
        seen.push_back({id, pixel});
      }
    }
    if (seen.size() < kFrames) {
      continue;
    }
    for (size_t i = id % 3 == 1 ? 1 : 0; i < kFrames - (id % 3 == 2 ? 2 : 0); ++i) {
      frames[i].observations.push_back(seen[i]);
    }
    ++id;
  }
  return frames;
}

/// What GNSS-like fixes of an antenna have measured at every second frame but the first and the last.
inline std::vector<PositionFix> MakeFixes(const std::vector<NavState>& states, const Eigen::Vector3d& p_BA,
                                          double scale) {
  RandomStream random(22, "fixes of one window");
  constexpr double kFixStdM = 0.02;
  std::vector<PositionFix> fixes;
  for (size_t i = 2; i + 1 < states.size(); i += 2) {
    PositionFix& fix = fixes.emplace_back();
    fix.stamp_ns = SecondsToNs(static_cast<double>(i) * kSamplesPerFrame / kImuRateHz);
    fix.p_A = states[i].p_WB + states[i].R_WB * p_BA + scale * kFixStdM * random.Normal3();
    fix.covariance = kFixStdM * kFixStdM * Eigen::Matrix3d::Identity();
  }
  return fixes;
}

/// Adds `scale` times the white noise of the rig's IMU to the samples.
inline void AddImuNoise(double scale, RandomStream* random, OneWindow* window) {
  const ImuNoise& noise = window->rig.imu_noise;
  const double root_rate = scale * std::sqrt(kImuRateHz);
  for (ImuSample& sample : window->samples) {
    sample.gyro += root_rate * noise.gyro_noise_density_radps_sqrthz * random->Normal3();
    sample.accel += root_rate * noise.accel_noise_density_mps2_sqrthz * random->Normal3();
  }
  SetCurvatures(window->samples);
}

/// The start off the truth by `scale` times a draw of its covariance, and carried to the last sample.
inline void DrawStart(const NavEstimate& truth, double scale, RandomStream* random, OneWindow* window) {
  Vector15d draw;
  for (double& entry : draw) {
    entry = random->Normal();
  }
  const Matrix15d root = window->start.covariance.llt().matrixL();
  const Vector15d error = scale * (root * draw);
  window->start.nav = Retract(ErrorConvention::kSo3xRn, truth.nav, Vector9d(error.head<9>()));
  window->start.bias = {truth.bias.gyro + error.segment<3>(9), truth.bias.accel + error.tail<3>()};
  window->carried = window->start;
  EXPECT_TRUE(
      PropagateEstimate(window->samples, window->rig.imu_noise, GravityInWorld(kGravity), &window->carried)
          .ok());
}

/// One window whose errors, of the start, the IMU and the pixels, are `scale` times draws from what the back
/// ends assume of them.
inline OneWindow MakeWindow(double scale, bool with_fixes = false) {
  RandomStream random(21, "one window");
  OneWindow window;
  window.rig = MakeRig();
  NavEstimate truth;
  truth.nav = {so3::Exp(Eigen::Vector3d(0.1, -0.2, 0.5)), Eigen::Vector3d(1, 2, -0.5),
               Eigen::Vector3d::Zero()};
  truth.nav.v_WB = truth.nav.R_WB * Eigen::Vector3d(1.5, 0.1, -0.2);
  truth.bias = {Eigen::Vector3d(0.01, -0.02, 0.005), Eigen::Vector3d(0.1, 0.05, -0.2)};
  const std::vector<NavState> states = MakeMotion(truth, window.rig.imu_noise, &window.samples);
  window.frames = MakeTracks(window.rig, states, &random);
  if (with_fixes) {
    window.rig.fixes = {{Eigen::Vector3d(0.3, -0.2, 0.4)}};
    window.fixes = MakeFixes(states, window.rig.fixes.front().p_BA, scale);
  }
  for (TrackFrame& frame : window.frames) {
    for (TrackObservation& observation : frame.observations) {
      observation.pixel += scale * Eigen::Vector2d(random.Normal(), random.Normal());
    }
  }
  AddImuNoise(scale, &random, &window);
  window.start.covariance = StartCovariance(&random);
  DrawStart(truth, scale, &random, &window);
  return window;
}

/// The same rig, standing still before landmarks.
inline OneWindow MakeWindowAtRest(double scale) {
  RandomStream random(23, "one window at rest");
  OneWindow window = MakeWindow(scale);
  NavEstimate truth;
  truth.nav.R_WB = so3::Exp(Eigen::Vector3d(0.1, -0.2, 0.5));
  truth.bias = {Eigen::Vector3d(0.01, -0.02, 0.005), Eigen::Vector3d(0.1, 0.05, -0.2)};
  const Eigen::Vector3d up_B = truth.nav.R_WB.transpose() * Eigen::Vector3d(0, 0, kGravity);
  for (ImuSample& sample : window.samples) {
    sample.gyro = truth.bias.gyro;
    sample.accel = truth.bias.accel + up_B;
  }
  AddImuNoise(scale, &random, &window);
  for (TrackFrame& frame : window.frames) {
    frame.observations = window.frames.front().observations;
  }
  DrawStart(truth, scale, &random, &window);
  return window;
}

}  // namespace alidade::test
