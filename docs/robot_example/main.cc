#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "eval/run/session.h"

// A camera and an IMU on a circle of 3 m, streamed into a session as a robot's drivers would. Samples and
// tracks are computed here; on a robot they come from the sensors.
namespace {
using Eigen::Vector3d;
constexpr double kRadiusM = 3, kRateRadps = 0.6;

/// Body x along the path, z up, moving up and down by 0.2 m.
alidade::NavState TrueState(double t) {
  const double a = kRateRadps * t, speed = kRadiusM * kRateRadps;
  return {alidade::so3::Exp(Vector3d(0, 0, a)),
          {kRadiusM * std::sin(a), -kRadiusM * std::cos(a), 0.2 * std::sin(2 * t)},
          {speed * std::cos(a), speed * std::sin(a), 0.4 * std::cos(2 * t)}};
}

alidade::ImuSample SampleAt(alidade::TimeNs stamp_ns) {
  const double t = 1e-9 * static_cast<double>(stamp_ns), centripetal = kRadiusM * kRateRadps * kRateRadps;
  return {stamp_ns, Vector3d(0, 0, kRateRadps), Vector3d(0, centripetal, 9.81 - 0.8 * std::sin(2 * t))};
}

alidade::TrackFrame FrameAt(alidade::TimeNs stamp_ns, const alidade::RigCalibration& rig,
                            const std::vector<Vector3d>& landmarks, std::mt19937_64* random) {
  std::normal_distribution<double> noise_px(0, 0.5);
  const alidade::Pose T_CW = (TrueState(1e-9 * static_cast<double>(stamp_ns)).T_WB() * rig.T_BC).Inverse();
  alidade::TrackFrame frame{stamp_ns, {}};
  Eigen::Vector2d pixel;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (rig.camera.Project(T_CW * landmarks[i], &pixel) && rig.camera.InImage(pixel)) {
      pixel += Eigen::Vector2d(noise_px(*random), noise_px(*random));
      frame.observations.push_back({static_cast<std::int64_t>(i), pixel});
    }
  }
  return frame;
}
}  // namespace

int main() {
  alidade::RigCalibration rig;
  rig.camera =
      *alidade::CameraModel::Create(alidade::DistortionModel::kNone, {400, 400, 320, 240}, {}, 640, 480);
  rig.T_BC.rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // the camera looks along the body's x axis
  alidade::SessionOptions options;
  options.lateness.camera_s = 0.1;
  auto made = alidade::Session::Make(alidade::EstimatorConfig(), rig, options);
  if (!made.ok()) {
    std::fprintf(stderr, "%s\n", made.message().c_str());
    return 1;
  }
  alidade::Session& session = **made;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-15, 15);
  std::vector<Vector3d> landmarks;
  for (int i = 0; i < 600; ++i) {
    landmarks.emplace_back(place(random), place(random), 0.3 * place(random));
  }
  int states = 0;
  for (alidade::TimeNs now = 0; now <= 15'000'000'000; now += 5'000'000) {
    session.AddImu(SampleAt(now));
    if (now >= 60'000'000 && (now - 60'000'000) % 100'000'000 == 0) {  // a frame, 60 ms late
      session.AddFrame(FrameAt(now - 60'000'000, rig, landmarks, &random));
    }
    for (const alidade::SessionEvent& event : session.TakeEvents()) {
      if (std::holds_alternative<alidade::StateEvent>(event)) {
        ++states;
      } else if (!std::holds_alternative<alidade::WaitingEvent>(event)) {
        std::printf("%s\n", alidade::Describe(event).c_str());
      }
    }
  }
  const alidade::NewestState newest = *session.Newest();
  std::printf("%d states, newest at %s s, speed %.3f m/s\n", states,
              alidade::FormatSeconds(newest.estimate.stamp_ns).c_str(), newest.v_B.norm());
  return 0;
}
