#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/dataset/digest.h"
#include "eval/simulation/simulator.h"
#include "tests/eval/simulation/sim_scene.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::MinuteConfig;
using test::SimScene;

/// Pixels by frame and landmark of the tracks that are right.
std::map<std::pair<TimeNs, int>, Eigen::Vector2d> RightPixels(const SimScene& scene) {
  std::map<std::pair<TimeNs, int>, Eigen::Vector2d> pixels;
  for (const TrackFrame& frame : scene.tracks.frames) {
    for (const TrackObservation& observation : frame.observations) {
      if (!scene.IsOutlier(observation.track_id)) {
        pixels[{frame.stamp_ns, scene.LandmarkOf(observation.track_id)}] = observation.pixel;
      }
    }
  }
  return pixels;
}

// GIVEN a scene WHEN any effect on tracks is switched on THEN what is still seen of it is seen at the same
// pixel, noise and all.
TEST(SimEffects, LeaveTheNoiseOfEveryOtherObservation) {
  const auto plain = RightPixels(SimScene(MinuteConfig()));
  std::map<std::string, SimulatorConfig> effects;
  effects.emplace("loss", MinuteConfig()).first->second.mean_track_loss = 0.1;
  effects.emplace("limit", MinuteConfig()).first->second.max_features = 60;
  effects.emplace("range", MinuteConfig()).first->second.max_range_m = 8;
  effects.emplace("stereo", MinuteConfig()).first->second.camera_count = 2;
  SimulatorConfig& mixed = effects.emplace("outliers", MinuteConfig()).first->second;
  mixed.outlier_rate = 0.3;
  mixed.outlier_kind = SimOutlierKind::kMixed;
  for (const auto& [name, config] : effects) {
    double common = 0, different = 0;
    for (const auto& [key, pixel] : RightPixels(SimScene(config))) {
      const auto found = plain.find(key);
      common += found != plain.end() ? 1 : 0;
      different += found != plain.end() && found->second != pixel ? 1 : 0;
    }
    EXPECT_GT(common, 10000) << name;
    EXPECT_EQ(different, 0) << name;
  }
}

TEST(SimEffects, TracksAreLostAtTheirRate) {
  SimulatorConfig config = MinuteConfig();
  config.mean_track_loss = 0.07;
  const SimScene scene(config);
  double lost = 0, count = 0;
  for (const auto& [track, observations] : scene.ByTrack()) {
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const std::size_t next = static_cast<std::size_t>(observations[i].first) + 1;
      if (next >= scene.tracks.frames.size()) {
        continue;
      }
      const TrackFrame& frame = scene.tracks.frames[next];
      const Eigen::Vector3d& p_W = scene.landmarks[static_cast<std::size_t>(scene.LandmarkOf(track))];
      const double t = SecondsBetween(0, frame.stamp_ns);
      const Eigen::Vector3d p_C = (scene.trajectory->At(t).nav.T_WB() * scene.rig.T_BC).Inverse() * p_W;
      Eigen::Vector2d pixel;
      if (!scene.rig.camera.Project(p_C, &pixel) || !scene.rig.camera.InImage(pixel, config.border_px)) {
        continue;  // it left the view, which is no loss
      }
      lost += i + 1 == observations.size() ? 1 : 0;
      count += 1;
    }
  }
  ASSERT_GT(count, 50000);
  EXPECT_NEAR(lost / count, 0.07, 4 * std::sqrt(0.07 * 0.93 / count));
}

TEST(SimEffects, ViewRangeAndNumberAreLimited) {
  SimulatorConfig config = MinuteConfig();
  config.pixel_noise_px = 0;
  config.max_range_m = 6;
  config.max_features = 30;
  config.border_px = 25;
  const SimScene scene(config);
  double farthest_m = 0;
  for (const TrackFrame& frame : scene.tracks.frames) {
    EXPECT_LE(frame.observations.size(), 30u);
    const Pose T_WC = scene.trajectory->At(SecondsBetween(0, frame.stamp_ns)).nav.T_WB() * scene.rig.T_BC;
    for (const TrackObservation& observation : frame.observations) {
      const int landmark = scene.LandmarkOf(observation.track_id);
      const double range_m = (scene.landmarks[static_cast<std::size_t>(landmark)] - T_WC.translation).norm();
      ASSERT_LE(range_m, 6);
      ASSERT_TRUE(scene.rig.camera.InImage(observation.pixel, 25));
      farthest_m = std::max(farthest_m, range_m);
    }
  }
  EXPECT_GT(farthest_m, 5.5) << "the limit was never met";
}

/// Mean square of cam1's errors [px^2] and their mean product with cam0's, over landmarks that both see.
struct StereoNoise {
  double square = 0, product = 0, count = 0, matched = 0, seen_by_first = 0;
};

StereoNoise MeasureStereo(const SimScene& scene) {
  StereoNoise noise;
  for (std::size_t k = 0; k < scene.tracks.frames.size(); ++k) {
    std::map<std::int64_t, Eigen::Vector2d> first;
    for (const TrackObservation& observation : scene.tracks.frames[k].observations) {
      first[observation.track_id] = scene.ErrorOf(scene.tracks.frames[k], observation);
    }
    noise.seen_by_first += static_cast<double>(first.size());
    for (const TrackObservation& observation : scene.tracks.extra_frames[0][k].observations) {
      if (observation.track_id >= kExtraCameraIds) {
        continue;
      }
      const auto match = first.find(observation.track_id);
      EXPECT_NE(match, first.end()) << "an id of the first camera that it does not see";
      const Eigen::Vector3d& p_W =
          scene.landmarks[static_cast<std::size_t>(scene.LandmarkOf(observation.track_id))];
      const Eigen::Vector2d error =
          observation.pixel - scene.PixelOf(scene.tracks.frames[k], p_W, scene.extra[0].T_BC);
      noise.square += error.squaredNorm() / 2;
      noise.product += error.dot(match->second) / 2;
      noise.count += 1;
      noise.matched += 1;
    }
  }
  noise.square /= noise.count;
  noise.product /= noise.count;
  return noise;
}

TEST(SimEffects, AStereoRigSeesTheSameLandmarksWithNoiseOfItsOwn) {
  SimulatorConfig config = MinuteConfig();
  config.camera_count = 2;
  config.pixel_noise_px = 1.5;
  const SimScene scene(config);
  ASSERT_EQ(scene.tracks.extra_frames.size(), 1u);
  const StereoNoise noise = MeasureStereo(scene);
  ASSERT_GT(noise.count, 20000);
  EXPECT_NEAR(noise.square, 2.25, 4 * 2.25 / std::sqrt(noise.count));
  EXPECT_NEAR(noise.product, 0, 4 * 2.25 / std::sqrt(2 * noise.count));
  EXPECT_GT(noise.matched / noise.seen_by_first, 0.9);
  const Pose T_C0C1 = scene.rig.T_BC.Inverse() * scene.extra[0].T_BC;
  EXPECT_LT((T_C0C1.translation - Eigen::Vector3d(0.11, 0, 0)).norm(), 1e-12);
}

TEST(SimEffects, CamerasThatLookAwayHaveTracksOfTheirOwn) {
  SimulatorConfig config = MinuteConfig();
  config.camera_count = 4;
  config.camera_turn_rad = 0.5 * 3.14159265358979;
  config.max_features = 40;
  const SimScene scene(config);
  ASSERT_EQ(scene.tracks.extra_frames.size(), 3u);
  const Pose back = scene.rig.T_BC.Inverse() * scene.extra[1].T_BC;
  EXPECT_LT((back.rotation.col(2) + Eigen::Vector3d::UnitZ()).norm(), 1e-9) << "two turns look back";
  for (std::size_t camera = 0; camera < 3; ++camera) {
    double own = 0;
    for (const TrackFrame& frame : scene.tracks.extra_frames[camera]) {
      EXPECT_LE(frame.observations.size(), 40u);
      for (std::size_t i = 0; i < frame.observations.size(); ++i) {
        const std::int64_t id = frame.observations[i].track_id;
        ASSERT_TRUE(i == 0 || id > frame.observations[i - 1].track_id);
        own += id / kExtraCameraIds == static_cast<std::int64_t>(camera) + 1 ? 1 : 0;
      }
    }
    EXPECT_GT(own, 10000);
  }
}

TEST(SimEffects, MoreCamerasAreWrittenReadAndPartOfTheDigest) {
  SimulatorConfig config;
  config.duration_s = 2;
  config.path_m = 2.6;
  const auto digest = [](const Dataset& dataset) {
    return DigestOf(MeasurementLog{dataset.rig, dataset.imu, dataset.frames, dataset.extra_cameras});
  };
  const std::string mono = digest(Simulate(config, 1).value());
  config.camera_count = 3;
  const Dataset written = Simulate(config, 1).value();
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteDataset(written, folder.path()).ok());
  const Result<Dataset> read = ReadDataset(folder.path());
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_EQ(read->extra_cameras.size(), 2u);
  EXPECT_EQ(digest(*read), digest(written));
  EXPECT_NE(digest(written), mono);
  EXPECT_EQ(read->extra_cameras[1].T_BC.translation, written.extra_cameras[1].T_BC.translation);
  Dataset without = *read;
  without.extra_cameras.clear();
  EXPECT_EQ(digest(without), mono) << "more cameras change nothing of the first";
}

TEST(SimEffects, ScaleAndMisalignmentLeaveTheNoise) {
  const auto trajectory = MakeSimTrajectory(SimulatorConfig());
  SimImuErrors errors;
  errors.noise = {3e-4, 1e-3, 3e-5, 2e-4};
  const std::vector<TimeNs> stamps = EvenStamps(0, 5, 100);
  const SimulatedImu plain = SimulateImu(*trajectory, stamps, 100, 9.81, errors, 4);
  errors.gyro_scale_std = 0.02;
  errors.misalignment_std_rad = 0.02;
  errors.gyro_bias_radps = 0.01;
  const SimulatedImu skewed = SimulateImu(*trajectory, stamps, 100, 9.81, errors, 4);
  EXPECT_GT((skewed.gyro_matrix - plain.gyro_matrix).norm(), 0.01);
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const Eigen::Vector3d w = trajectory->At(SecondsBetween(0, stamps[k])).angular_rate_B;
    const Eigen::Vector3d noise = plain.samples[k].gyro - plain.biases[k].gyro - w;
    const Eigen::Vector3d other = skewed.samples[k].gyro - skewed.biases[k].gyro - skewed.gyro_matrix * w;
    ASSERT_LT((noise - other).norm(), 1e-14);
  }
}

}  // namespace
}  // namespace alidade
