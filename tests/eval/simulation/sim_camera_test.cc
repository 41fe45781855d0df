#include "eval/simulation/sim_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <numbers>
#include <set>

#include "tests/eval/simulation/sim_scene.h"
#include "tests/support/steps.h"

namespace alidade {
namespace {

using Scene = test::SimScene;

void ExpectReprojectionStd(const Scene& scene, double expected_px) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0;
  double count = 0;
  for (const TrackFrame& frame : scene.tracks.frames) {
    for (const TrackObservation& observation : frame.observations) {
      const Eigen::Vector2d error = scene.ErrorOf(frame, observation);
      sum += error;
      squares += error.squaredNorm();
      count += 1;
    }
  }
  ASSERT_GT(count, 10000);
  EXPECT_NEAR(std::sqrt(squares / (2 * count)) / expected_px, 1, 3 / std::sqrt(4 * count));
  EXPECT_LT((sum / count).cwiseAbs().maxCoeff(), 4 * expected_px / std::sqrt(count));
}

TEST(SimCameraTest, LandmarksReprojectWithThePixelNoise) {
  SimulatorConfig config;
  config.duration_s = 60;
  config.path_m = 78;
  ExpectReprojectionStd(Scene(config), 1.0);
  config.pixel_noise_px = 2;
  config.camera_view = SimCameraView::kSideways;
  config.camera_time_offset_s = 0.02;
  config.distortion = DistortionModel::kRadialTangential;
  config.distortion_coefficients << -0.28, 0.07, 2e-4, 2e-5;
  ExpectReprojectionStd(Scene(config), 2.0);
}

TEST(SimCameraTest, AnObservationHasItsOwnNoiseRatio) {
  SimulatorConfig config;
  config.duration_s = 60;
  config.path_m = 78;
  config.noise_ratio_spread = 0.7;
  const Scene scene(config);
  double squares = 0, logs = 0, square_logs = 0, count = 0;
  for (const TrackFrame& frame : scene.tracks.frames) {
    for (const TrackObservation& observation : frame.observations) {
      squares += (scene.ErrorOf(frame, observation) / observation.noise_ratio).squaredNorm();
      logs += std::log(observation.noise_ratio);
      square_logs += std::pow(std::log(observation.noise_ratio), 2);
      count += 1;
    }
  }
  EXPECT_NEAR(std::sqrt(squares / (2 * count)) / config.pixel_noise_px, 1, 3 / std::sqrt(4 * count));
  EXPECT_NEAR(logs / count, 0, 4 * 0.7 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(square_logs / count), 0.7, 0.01);
}

TEST(SimCameraTest, TracksHaveTheLengthAndNumberTheBenchWasTunedFor) {
  const Scene scene{SimulatorConfig()};
  std::map<std::int64_t, int> lengths;
  double observations = 0;
  for (const TrackFrame& frame : scene.tracks.frames) {
    EXPECT_LE(frame.observations.size(), 150u);
    EXPECT_GE(frame.observations.size(), 40u);
    for (const TrackObservation& observation : frame.observations) {
      ++lengths[observation.track_id];
      observations += 1;
    }
  }
  const double mean_length = observations / static_cast<double>(lengths.size());
  const double mean_count = observations / static_cast<double>(scene.tracks.frames.size());
  EXPECT_GT(mean_length, 22);
  EXPECT_LT(mean_length, 27);
  EXPECT_GT(mean_count, 100);
}

TEST(SimCameraTest, MeanTrackLossShortensTracks) {
  SimulatorConfig config;
  config.duration_s = 60;
  config.path_m = 78;
  const std::size_t tracks = Scene(config).tracks.landmark_of_track.size();
  config.mean_track_loss = 0.1;
  EXPECT_GT(Scene(config).tracks.landmark_of_track.size(), 2 * tracks);
}

TEST(SimCameraTest, IdsAreSortedConsecutiveInTimeAndNeverReused) {
  SimulatorConfig config;
  config.mean_track_loss = 0.03;
  const Scene scene(config);
  std::set<std::int64_t> alive;
  std::set<std::int64_t> ended;
  std::set<int> landmarks_seen;
  for (const TrackFrame& frame : scene.tracks.frames) {
    std::set<std::int64_t> now;
    std::set<int> landmarks;
    for (const TrackObservation& observation : frame.observations) {
      EXPECT_TRUE(now.empty() || observation.track_id > *now.rbegin());
      EXPECT_EQ(ended.count(observation.track_id), 0u) << "track " << observation.track_id << " came back";
      now.insert(observation.track_id);
      landmarks.insert(scene.tracks.landmark_of_track[static_cast<std::size_t>(observation.track_id)]);
    }
    EXPECT_EQ(landmarks.size(), now.size()) << "a landmark is tracked twice in one frame";
    std::set_difference(alive.begin(), alive.end(), now.begin(), now.end(),
                        std::inserter(ended, ended.end()));
    alive = now;
  }
  // Landmarks do come back in later laps, under new ids.
  EXPECT_GT(scene.tracks.landmark_of_track.size(), 4 * scene.landmarks.size());
}

TEST(SimCameraTest, LandmarksKeepTheirDistanceToThePath) {
  const Scene scene{SimulatorConfig()};
  ASSERT_EQ(scene.landmarks.size(), static_cast<std::size_t>(scene.config.landmark_count));
  for (const Eigen::Vector3d& landmark : scene.landmarks) {
    double nearest_m = 1e9;
    for (const double t : test::Steps(0, 30, 0.05)) {
      nearest_m = std::min(nearest_m, (scene.trajectory->At(t).nav.p_WB - landmark).norm());
    }
    EXPECT_GT(nearest_m, 2 - 0.01);
    EXPECT_LT(nearest_m, 10 + 0.05);
  }
}

/// A spiral that covers a disc of 50 m radius, its turns 1 m apart.
class DiscTrajectory final : public ContinuousTrajectory {
 public:
  [[nodiscard]] double DurationSeconds() const override { return 100; }
  [[nodiscard]] Kinematics At(double time_s) const override {
    const double radius_m = 5 * std::sqrt(time_s);
    const double angle = 2 * std::numbers::pi * radius_m;
    Kinematics motion;
    motion.nav.p_WB << radius_m * std::cos(angle), radius_m * std::sin(angle), 0;
    return motion;
  }
};

TEST(SimCameraTest, NoRoomForLandmarksIsAConfigurationError) {
  SimulatorConfig config;
  config.landmark_count = 20;
  config.landmark_max_distance_m = 2.1;
  const Result<std::vector<Eigen::Vector3d>> landmarks = MakeLandmarks(config, DiscTrajectory(), 1);
  ASSERT_FALSE(landmarks.ok());
  EXPECT_EQ(landmarks.code(), StatusCode::kConfig);
  EXPECT_NE(landmarks.message().find("landmark_max_distance_m"), std::string::npos);
}

/// Fraction of observations farther than 6 sigma from the truth.
double WrongFraction(const Scene& scene) {
  double wrong = 0;
  double count = 0;
  for (const TrackFrame& frame : scene.tracks.frames) {
    for (const TrackObservation& observation : frame.observations) {
      EXPECT_TRUE(scene.rig.camera.InImage(observation.pixel));
      const bool is_wrong = scene.ErrorOf(frame, observation).norm() > 6;
      wrong += is_wrong ? 1 : 0;
      count += 1;
      EXPECT_TRUE(!is_wrong || scene.tracks.outlier_of_track[static_cast<std::size_t>(observation.track_id)]);
    }
  }
  return wrong / count;
}

TEST(SimCameraTest, OutliersComeAtTheirRate) {
  SimulatorConfig config;
  config.duration_s = 60;
  config.path_m = 78;
  EXPECT_EQ(WrongFraction(Scene(config)), 0);
  config.outlier_rate = 0.05;
  EXPECT_NEAR(WrongFraction(Scene(config)), 0.05, 0.005);
  config.outlier_kind = SimOutlierKind::kDrift;
  const Scene scene(config);
  const double tracks = static_cast<double>(scene.tracks.outlier_of_track.size());
  const double wrong = static_cast<double>(
      std::count(scene.tracks.outlier_of_track.begin(), scene.tracks.outlier_of_track.end(), true));
  EXPECT_NEAR(wrong / tracks, 0.05, 4 * std::sqrt(0.05 * 0.95 / tracks));
  EXPECT_GT(WrongFraction(scene), 0.02);
}

TEST(SimCameraTest, CameraLooksAlongItsView) {
  SimulatorConfig config;
  const Pose forward = MakeSimRig(config)->T_BC;
  config.camera_view = SimCameraView::kSideways;
  const Pose sideways = MakeSimRig(config)->T_BC;
  EXPECT_EQ(forward.rotation.col(2), Eigen::Vector3d::UnitX());
  EXPECT_EQ(sideways.rotation.col(2), Eigen::Vector3d::UnitY());
  for (const Pose& T_BC : {forward, sideways}) {
    EXPECT_EQ(T_BC.rotation.col(1), -Eigen::Vector3d::UnitZ()) << "image y is down";
    EXPECT_EQ((T_BC.rotation * T_BC.rotation.transpose()), Eigen::Matrix3d::Identity());
    const Eigen::Vector3d x = T_BC.rotation.col(0);
    const Eigen::Vector3d y = T_BC.rotation.col(1);
    EXPECT_EQ(Eigen::Vector3d(Skew(x) * y), Eigen::Vector3d(T_BC.rotation.col(2))) << "right-handed";
  }
}

// GIVEN a read-out of 20 ms THEN each observation is where the camera sees the point when it exposes that
// row.
TEST(SimCamera, ARollingShutterSeesEachRowAtItsOwnTime) {
  SimulatorConfig config = test::MinuteConfig();
  config.duration_s = 10;
  config.wobble_rad = 0.3;
  config.pixel_noise_px = 0;
  config.render.line_delay_s = 0.02 / config.height_px;
  const test::SimScene scene(config);
  double farthest_px = 0;
  int observations = 0;
  for (const TrackFrame& frame : scene.tracks.frames) {
    for (const TrackObservation& seen : frame.observations) {
      const double later_s = config.render.line_delay_s * (seen.pixel.y() - 0.5 * config.height_px);
      const double t_s = SecondsBetween(0, frame.stamp_ns) + config.camera_time_offset_s + later_s;
      const Pose T_WC = scene.trajectory->At(t_s).nav.T_WB() * scene.rig.T_BC;
      const int landmark = scene.LandmarkOf(seen.track_id);
      Eigen::Vector2d pixel;
      ASSERT_TRUE(scene.rig.camera.Project(
          T_WC.Inverse() * scene.landmarks[static_cast<std::size_t>(landmark)], &pixel));
      EXPECT_LT((pixel - seen.pixel).norm(), 1e-2);
      farthest_px = std::max(farthest_px, scene.ErrorOf(frame, seen).norm());
      ++observations;
    }
  }
  EXPECT_GT(observations, 5000);
  EXPECT_GT(farthest_px, 3) << "against all rows at once";
}

}  // namespace
}  // namespace alidade
