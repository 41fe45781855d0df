#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/body_motion.h"
#include "core/calibration.h"
#include "core/error_convention.h"
#include "core/estimator/measurement_log.h"
#include "core/imu_propagation.h"
#include "core/imu_step.h"
#include "core/position_fix.h"
#include "core/random.h"
#include "gnss/alignment/alignment.h"
#include "tests/support/fix_scenario.h"

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
  // At stamps of frames:
  std::vector<PositionFix> fixes;
  std::vector<GnssEpoch> epochs;
  std::optional<GnssAlignment> alignment;  ///< of the start, for what stands in another frame
  // The truth:
  std::vector<NavState> states;  ///< at the frames
  ImuBias bias;
};

struct WindowOptions {
  bool with_fixes = false;
  double start_position_std_m = 0.05;
  /// What of the camera is off by `scale` times a draw of these deviations.
  CalibrationConfig calibration;
  bool staggered = true;  ///< some tracks end early
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

inline Matrix15d StartCovariance(double position_std_m, RandomStream* random) {
  Vector15d deviation;
  deviation << Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(position_std_m),
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

/// The camera that has seen, off from the one given.
inline CameraCalibration TrueCamera(const RigCalibration& rig, const CalibrationConfig& config,
                                    double scale) {
  RandomStream random(24, "camera of one window");
  CalibrationEstimate camera = InitialCalibration(config, GivenCamera(rig, {}));
  Eigen::VectorXd error(camera.layout.size());
  for (Eigen::Index i = 0; i < error.size(); ++i) {
    error[i] = scale * camera.deviations[i] * random.Normal();
  }
  EXPECT_TRUE(Retract(camera.layout, error, &camera.mean));
  return camera.mean;
}

/// The pixel of a landmark in the camera of a body at a frame; `gyro_radps` without bias. False outside the
/// image.
inline bool See(const CameraCalibration& camera, const NavState& body, const Eigen::Vector3d& gyro_radps,
                const Eigen::Vector3d& p_W, Eigen::Vector2d* pixel) {
  const BodyMotion motion = MotionOf(MeasuredTurn{gyro_radps}, Eigen::Vector3d::Zero(), body.R_WB, body.v_WB);
  const Pose T_WC =
      BodyAfter(body.T_WB(), BodyRates(gyro_radps, body.v_WB), camera.time_offset_s) * camera.T_BC;
  double row_px = 0;
  for (int i = 0; i < 3; ++i) {  // the line delay is small
    const double later_s = camera.line_delay_s.value_or(0) * row_px;
    const Pose T_WR = T_WC * CameraAfter(motion, camera.T_BC, later_s);
    if (!camera.camera.Project(T_WR.Inverse() * p_W, pixel) || !camera.camera.InImage(*pixel)) {
      return false;
    }
    row_px = pixel->y() - 0.5 * camera.camera.height_px();
  }
  return true;
}

/// Tracks of kTracks landmarks without noise; some begin a frame late, some end early where they are
/// `staggered`.
inline std::vector<TrackFrame> MakeTracks(const CameraCalibration& camera, const OneWindow& window,
                                          bool staggered, RandomStream* random) {
  std::vector<TrackFrame> frames(window.states.size());
  for (size_t i = 0; i < frames.size(); ++i) {
    frames[i].stamp_ns = SecondsToNs(static_cast<double>(i) * kSamplesPerFrame / kImuRateHz);
  }
  for (std::int64_t id = 0; id < kTracks;) {
    const double depth = random->Uniform(3, 6);
    const Eigen::Vector3d p_C(random->Uniform(-0.6, 0.6) * depth, random->Uniform(-0.35, 0.35) * depth,
                              depth);
    const Eigen::Vector3d p_W = window.states[kFrames / 2].T_WB() * camera.T_BC * p_C;
    std::vector<TrackObservation> seen;
    for (size_t i = 0; i < kFrames; ++i) {
      Eigen::Vector2d pixel;
      const Eigen::Vector3d gyro_radps = window.samples[i * kSamplesPerFrame].gyro - window.bias.gyro;
      if (See(camera, window.states[i], gyro_radps, p_W, &pixel)) {
        seen.push_back({id, pixel});
      }
    }
    if (seen.size() < kFrames) {
      continue;
    }
    for (size_t i = id % 3 == 1 ? 1 : 0; i < kFrames - (staggered && id % 3 == 2 ? 2 : 0); ++i) {
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
inline OneWindow MakeWindow(double scale, const WindowOptions& options = {}) {
  RandomStream random(21, "one window");
  OneWindow window;
  window.rig = MakeRig();
  NavEstimate truth;
  truth.nav = {so3::Exp(Eigen::Vector3d(0.1, -0.2, 0.5)), Eigen::Vector3d(1, 2, -0.5),
               Eigen::Vector3d::Zero()};
  truth.nav.v_WB = truth.nav.R_WB * Eigen::Vector3d(1.5, 0.1, -0.2);
  truth.bias = {Eigen::Vector3d(0.01, -0.02, 0.005), Eigen::Vector3d(0.1, 0.05, -0.2)};
  window.bias = truth.bias;
  window.states = MakeMotion(truth, window.rig.imu_noise, &window.samples);
  window.frames =
      MakeTracks(TrueCamera(window.rig, options.calibration, scale), window, options.staggered, &random);
  if (options.with_fixes) {
    window.rig.fixes = {{Eigen::Vector3d(0.3, -0.2, 0.4)}};
    window.fixes = MakeFixes(window.states, window.rig.fixes.front().p_BA, scale);
    window.alignment = IdentityAlignment(window.start.stamp_ns);
  }
  for (TrackFrame& frame : window.frames) {
    for (TrackObservation& observation : frame.observations) {
      observation.pixel += scale * Eigen::Vector2d(random.Normal(), random.Normal());
    }
  }
  AddImuNoise(scale, &random, &window);
  window.start.covariance = StartCovariance(options.start_position_std_m, &random);
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
