#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/imu_propagation.h"
#include "smoother/factors/imu_factor.h"
#include "smoother/manifold/nav_state_manifold.h"
#include "smoother/window/frame_geometry.h"
#include "smoother/window/window.h"
#include "smoother/window/window_calibration.h"
#include "tests/support/random_states.h"

namespace alidade::test {

/// What the cameras of a fixture see: ahead of them, on the plane z = 1, or beside and behind them, on the
/// tangent planes of a lens of 250 degrees.
enum class FixtureView { kAhead, kBehind };

/// A window of frames on a random smooth motion, with consistent IMU data and tracks of landmarks ahead of
/// the cameras, or behind them.
struct WindowFixture {
  explicit WindowFixture(unsigned seed, int frames = 5, int landmarks = 12, double noise_sigma = 0.0,
                         FixtureView seen = FixtureView::kAhead)
      : random(seed), seen_view(seen) {
    T_BC = {random.Rotation(), random.Vector(0.2)};
    calibration.mean.T_BC = T_BC;
    const ImuBias bias = random.Bias();
    const Eigen::Vector3d omega = random.Vector(0.4);
    const Eigen::Vector3d force = Eigen::Vector3d(0, 0, 9.81) + random.Vector(1);
    NavState state{Eigen::Matrix3d::Identity(), random.Vector(1), random.Vector(1)};
    TimeNs stamp = 0;
    for (int i = 0; i < frames; ++i) {
      auto frame = std::make_unique<WindowFrame>();
      for (int k = 0; i > 0 && k <= 20; ++k) {
        const Eigen::Vector3d ripple =
            0.2 * Eigen::Vector3d(std::sin(0.3 * k), std::cos(0.2 * k), std::sin(0.5 * k + i));
        frame->imu.push_back(
            {stamp + k * 10'000'000LL, omega + ripple + bias.gyro, force + ripple + bias.accel});
      }
      if (i > 0) {
        stamp = frame->imu.back().stamp_ns;
        Preintegration preintegration(bias, noise);
        preintegration.Add(frame->imu);
        state = CarryState(preintegration, state, bias, gravity_W, nullptr);
      }
      frame->stamp_ns = stamp;
      PackNavState(state, frame->nav.data());
      PackBias(bias, frame->bias.data());
      if (i > 0) {
        UpdatePreintegration(window.newest(), noise, frame.get());
      }
      window.AddFrame(std::move(frame));
    }
    AddTracks(landmarks, noise_sigma);
  }

  [[nodiscard]] std::vector<const WindowTrack*> tracks() const {
    std::vector<const WindowTrack*> all;
    for (const auto& [id, track] : window.tracks()) {
      all.push_back(&track);
    }
    return all;
  }

  RandomStates random;
  FixtureView seen_view;
  Window window;
  Pose T_BC;
  WindowCalibration calibration;  ///< nothing of it is estimated
  ImuNoise noise;
  Eigen::Vector3d gravity_W = GravityInWorld(9.81);
  double sigma = 1.0 / 460;

 private:
  /// The camera's z axis to the middle of what it sees, 100 degrees off axis.
  [[nodiscard]] Eigen::Matrix3d TurnToView() const {
    return seen_view == FixtureView::kBehind ? so3::Exp(Eigen::Vector3d(1.6, 0.6, 0))
                                             : Eigen::Matrix3d::Identity();
  }
  void AddTracks(int landmarks, double noise_sigma) {
    const std::vector<FrameGeometry> geometry = MakeGeometry(window, T_BC);
    for (int id = 0; id < landmarks; ++id) {
      WindowTrack track;
      track.id = id;
      const Pose& base = geometry[static_cast<size_t>(id % 2)].T_WC;
      const double depth = random.Uniform(4, 8);
      const Eigen::Vector3d ray_ahead(random.Uniform(-0.3, 0.3), random.Uniform(-0.3, 0.3), 1);
      const Eigen::Vector3d p_W = base * (depth * (TurnToView() * ray_ahead));
      for (int i = id % 2; i < window.size(); ++i) {
        const Eigen::Vector3d p_C = geometry[static_cast<size_t>(i)].T_WC.Inverse() * p_W;
        if ((TurnToView().transpose() * p_C).z() < 0.5) {
          continue;
        }
        const Eigen::Vector3d error = noise_sigma * sigma * random.Vector(1.7);
        NormalizedObservation observation{Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity() / sigma};
        if (seen_view == FixtureView::kBehind) {
          observation.plane = BearingPlane::TangentAt(p_C.normalized() + error);
        } else {
          observation.z = p_C.hnormalized() + error.head<2>();
        }
        observation.sqrt_information(0, 1) = 0.1 / sigma;
        track.views.push_back({&window.frame(i), observation});
      }
      const Eigen::Vector3d p_base = track.views.front().observation.plane.InAxes(
          geometry[static_cast<size_t>(track.views.front().frame->index)].T_WC.Inverse() * p_W);
      track.landmark << p_base.hnormalized(), 1 / p_base.z();
      track.has_landmark = true;
      if (track.views.size() >= 2) {
        window.tracks()[id] = track;
      }
    }
  }
};

}  // namespace alidade::test
