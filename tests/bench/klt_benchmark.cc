#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "frontend/tracking/klt_tracker.h"
#include "tests/frontend/tracking/synthetic_scene.h"

namespace alidade {
namespace {

constexpr int kFrames = 20;
constexpr TimeNs kFrameNs = 50'000'000;

/// A camera swaying before a wall: up to 8 px of image motion a frame, as on a drone at 20 Hz. Closed, so
/// that playing it again has no jump.
std::vector<Pose> SwayingPoses() {
  std::vector<Pose> poses;
  for (int k = 0; k < kFrames; ++k) {
    const double phase = 2 * M_PI * k / kFrames;
    poses.push_back(
        {.rotation = so3::Exp({0.02 * std::sin(phase), 0.03 * std::cos(phase), 0.03 * std::sin(phase)}),
         .translation = {0.1 * std::sin(phase), 0.05 * std::cos(phase), 0.1 * std::cos(phase)}});
  }
  return poses;
}

/// One 752 x 480 frame; argument 0: features, 1: CLAHE on.
void BM_TrackFrame(benchmark::State& state) {
  const RigCalibration rig = test::TestRig();
  const test::Wall wall(rig.camera, 3.0);
  const std::vector<Pose> poses = SwayingPoses();
  std::vector<std::vector<unsigned char>> images;
  images.reserve(poses.size());
  for (const Pose& pose : poses) {
    images.push_back(wall.Image(pose));
  }
  FrontendConfig config;
  config.max_features = static_cast<int>(state.range(0));
  config.min_distance_px = config.max_features > 200 ? 12 : 20;
  config.equalize = state.range(1) != 0;
  KltTracker tracker(config, rig);
  TimeNs stamp_ns = 0;
  size_t k = 0;
  double features = 0;
  double length = 0;
  for ([[maybe_unused]] auto _ : state) {
    const Result<TrackFrame> frame =
        tracker.Track(stamp_ns, images[k].data(), rig.camera.width_px(), rig.camera.height_px());
    features += static_cast<double>(frame->observations.size());
    length += tracker.statistics().mean_track_length;
    const size_t next = (k + 1) % images.size();
    const Eigen::Matrix3d R_step = poses[k].rotation.transpose() * poses[next].rotation;
    const Eigen::Vector3d rate = rig.T_BC.rotation * so3::Log(R_step) / (kFrameNs * kNsToSeconds);
    for (int i = 0; i < 10; ++i) {
      tracker.AddImu(
          {.stamp_ns = stamp_ns + i * kFrameNs / 10, .gyro = rate, .accel = Eigen::Vector3d::Zero()});
    }
    stamp_ns += kFrameNs;
    k = next;
  }
  const auto frames = static_cast<double>(state.iterations());
  state.counters["features"] = features / frames;
  state.counters["track_length"] = length / frames;
}
BENCHMARK(BM_TrackFrame)
    ->ArgNames({"features", "clahe"})
    ->Args({150, 1})
    ->Args({150, 0})
    ->Args({300, 1})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace alidade
